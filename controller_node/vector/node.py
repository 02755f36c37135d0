"""The controller's node for a law for several units: takes readings, answers the bus administrator's polls."""

from __future__ import annotations

from functools import partial
from typing import Any, ClassVar

from railhil.bus.ident import CtlIdent, Role
from railhil.bus.layout import Telegram
from railhil.bus.responder import Responder
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.common.errors import InputError
from railhil.controller_node.laws import find
from railhil.controller_node.node import LawNode
from railhil.controller_node.vector.controller import VectorController, VectorOutput
from railhil.controller_node.vector.law import Interface, VectorLaw
from railhil.controller_node.vector.readings import Readings
from railhil.controller_node.vector.status import status_telegram
from railhil.dbc import Contract, Port
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import System


def ports_of(contract: Contract, interface: Interface) -> tuple[list[Port], list[Port]]:
    """Ports that a controller of this interface receives (the clock port first), and ports that it sends."""
    read = [*(item.telegram.PORT for item in interface.readings), TimeSync.PORT, RunEvent.PORT]
    answered = [kind.PORT for kind in (*(item.telegram for item in interface.commands), *interface.statuses)]
    sides = ([contract.clock_port.name, *read], [*answered, CtlIdent.PORT])
    received, sent = ([contract.port(name) for name in dict.fromkeys(side)] for side in sides)
    return received, sent


def refuse_indexing(system: System, law: LawSpec) -> None:
    """Refuse set-points by distance: laws for several units have set-points by time.

    :raises InputError: ``law`` has another indexing.
    """
    if law.indexing != "time":
        raise InputError("command line", "--indexing", law.indexing, f"time with system {system.name}")


class VectorNode(LawNode):
    """See :class:`railhil.controller_node.any_controller.AnyController`; the system has a part ``interface``.

    :param controller: computes the commands; None: one is made for ``law``.
    :param bit_rate: of the bus in bit/s; ignored here, since no time stamps are counted in bit times.
    :raises InputError: an option that this controller does not support.
    """

    #: Class of the object that computes the commands.
    computes: ClassVar[type[Any]] = VectorController

    def __init__(
        self,
        scenario: AnyScenario,
        law: LawSpec,
        controller: VectorController | None = None,
        *,
        fd: bool = False,
        bit_rate: int | None = None,
    ) -> None:
        system = scenario.installed_system
        contract = system.contract
        if law.task_period_ms:
            raise InputError("command line", "--task-period-ms", law.task_period_ms, f"0 with system {system.name}")
        refuse_indexing(system, law)
        super().__init__(scenario, law, find(law.controller, system.laws, VectorLaw), controller)
        self.lost_messages = 0
        self.lost_by_mailbox: dict[str, int] = {}
        self._interface: Interface = system.part("interface")
        self._output: VectorOutput | None = None
        self._stale = 0
        self._life: dict[str, int] = {}
        sent = dict.fromkeys(item.telegram for item in self._interface.commands)
        answers: dict[str, Any] = {kind.PORT: partial(self._command, kind) for kind in sent}
        answers |= {kind.PORT: partial(self._status, kind) for kind in self._interface.statuses}
        received, _ = ports_of(contract, self._interface)
        responder = Responder(
            Role.CONTROLLER,
            Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns, contract),
            received,
            {**answers, CtlIdent.PORT: self._own_ident},
            fd=fd,
            contract=contract,
        )
        self.attach(responder)
        self._readings = Readings(self._interface, responder)

    @property
    def counters(self) -> dict[str, int]:
        """Counters of refused telegrams, by cause; ``stale``: safe commands sent because a reading was too old."""
        counted = self.responder.store.counters + self._readings.counters
        return {**counted, **({"stale": self._stale} if self._stale else {})}

    def _control(self) -> bool:
        """Run the law if a control period has begun since its last step; returns whether its commands may be sent."""
        fresh = self._readings.fresh()
        k = self._clock.now_ns // self._control_ns
        if fresh and self._clock.running and k != self._last_k:
            self._output, self._last_k = self.controller.step(self._readings.raws()), k
            self._steps += 1
        return fresh and self._output is not None

    def _next_life(self, port: str) -> int:
        self._life[port] = life = (self._life.get(port, -1) + 1) & 0xF
        return life

    def _command(self, kind: type[Telegram]) -> Telegram:
        may_be_sent = self._control()
        output, commands = self._output, self._interface.commands
        values = tuple(item.safe for item in commands)
        if output is not None and may_be_sent:
            values = output.commands
        elif output is not None:
            self._stale += 1
            self.controller.sent(*values)
        fields = {item.field: raw for item, raw in zip(commands, values, strict=True) if item.telegram is kind}
        fields["life"] = self._next_life(kind.PORT)
        return kind(**fields)

    def _status(self, kind: type[Telegram]) -> Telegram:
        return status_telegram(self._interface, kind, self._output, self._steps, self._next_life(kind.PORT))
