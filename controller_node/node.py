"""The common part of the controller's nodes of all systems."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, ClassVar

from railhil.bus.codes import Event, ends_run
from railhil.bus.ident import CtlIdent, Ident, Role, make_ident
from railhil.bus.layout import Telegram
from railhil.bus.responder import CanModule, Reading, Responder
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent
from railhil.common.mypyc import mypyc_attr
from railhil.dbc import Port
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec


@mypyc_attr(allow_interpreted_subclasses=True)
class LawNode:
    """Handles frames; it has no socket, so it runs in a process of its own or in memory. Base of the nodes, see also
    :class:`railhil.controller_node.controller.AnyController`.

    :param law_type: class of the law.
    :param controller: computes the commands; None: one is made for ``law``.
    :raises InputError: the law cannot be made.
    """

    #: Class of the object that computes the commands, a :class:`~railhil.controller_node.law_controller.LawController`.
    computes: ClassVar[type[Any]]
    #: Whether the polls of its fastest port begin its time if nothing else does. A controller that reacts to the age of
    #: what it hears must see after a restart that it hears nothing. Before a run only CTL_IDENT and device status are
    #: polled.
    polls_begin: ClassVar[bool] = False

    def __init__(self, scenario: AnyScenario, law: LawSpec, law_type: type[Any], controller: Any) -> None:
        self.controller: Any = controller or type(self).computes(scenario, law)
        #: Ends what computes for it outside of this process; None: nothing does.
        self.ends: Callable[[], None] | None = None
        self.law = law
        self.law_type: Any = law_type
        self.ended: Event | None = None
        self._contract = contract = scenario.installed_system.contract
        self._schedule = Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns, contract)
        self._ident = make_ident(Role.CONTROLLER, scenario.sha256, **law.identity, contract=contract)
        self._control_ns = scenario.timing.control_period_ns
        # Control period of the law's last step, and number of its steps.
        self._last_k = -1
        self._steps = 0

    def attach(
        self,
        received: Iterable[Port],
        answers: Mapping[str, Callable[[], Telegram]],
        *,
        fd: bool,
        module: CanModule | None = None,
    ) -> Responder:
        """Take frames, the time and the end of the run from a responder, which is returned.

        :param received: ports with a mailbox.
        :param answers: for each port of which this node is the source, besides CTL_IDENT, what makes its telegram.
        :param module: the CAN module; None: each frame is read at once.
        """
        self.responder = responder = Responder(
            Role.CONTROLLER,
            self._schedule,
            received,
            {**answers, CtlIdent.PORT: self._own_ident},
            fd=fd,
            module=module,
            contract=self._contract,
            begins=self.polls_begin,
        )
        self._clock = responder.clock
        #: Takes one frame in bus order; returns the answer to a poll of the controller.
        self.handle = responder.handle
        responder.on(RunEvent, self._event)
        return responder

    @property
    def lockstep(self) -> bool:
        """True unless the pace is known to follow the wall clock."""
        return not self._clock.rate

    def figures(self) -> None:
        """It has no board."""

    def close(self) -> None:
        """End what computes for it outside of this process."""
        if self.ends is not None:
            self.ends()

    def was_out(self, wall_ns: int) -> None:
        """Note that the interface was down for ``wall_ns``: what was read is older by that time."""
        self._clock.silence(wall_ns)

    def was_stopped(self, sim_ns: int) -> None:
        """Note that it was stopped for ``sim_ns`` of simulation time: what was read is older by that time."""
        self._clock.elapsed(sim_ns)

    def _event(self, reading: Reading[RunEvent]) -> None:
        code = reading.telegram.event
        if ends_run(code):
            self.ended = Event(code)

    def _own_ident(self) -> Ident:
        return self._ident
