"""The controller of a run: its interface, for any system, and its making, under the faults of its node."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Protocol, cast

from railhil.bus.codes import Event
from railhil.bus.frame import Frame
from railhil.bus.schedule import Schedule
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec


class AnyController(Protocol):
    """Handles frames; it has no socket, so it runs in a process of its own or in memory."""

    ended: Event | None

    def handle(self, frame: Frame, /) -> list[Frame]:
        """Take one frame in bus order; returns the answer to a poll of the controller."""

    def was_out(self, wall_ns: int, /) -> None:
        """Note that the interface was down for ``wall_ns`` and now delivers frames again."""

    def was_stopped(self, sim_ns: int, /) -> None:
        """Note that it was stopped for ``sim_ns`` of simulation time and got none of the frames (a fault)."""

    def close(self) -> None:
        """End what computes for it outside of this process."""

    def figures(self) -> dict[str, Any] | None:
        """What was measured on its board; None: nothing, or it has none."""

    @property
    def lockstep(self) -> bool:
        """True unless the pace is known to follow the wall clock."""

    @property
    def counters(self) -> Mapping[str, int]:
        """Counters of refused and lost frames, by cause."""

    @property
    def lost_messages(self) -> int:
        """Frames overwritten in their mailbox before they were read."""

    @property
    def lost_by_mailbox(self) -> Mapping[str, int]:
        """The same by mailbox."""

    @property
    def law(self) -> LawSpec:
        """Names of law, arithmetic and indexing."""

    @property
    def law_type(self) -> Any:
        """Class of its law, for the declarations in it."""

    @property
    def controller(self) -> Any:
        """The object that computes, with ``counters``, ``cost`` and ``telemetry``; ``kept()``: the law's memory."""


def make_controller_node(
    scenario: AnyScenario,
    run: RunSpec,
    controller: Any = None,
    *,
    fd: bool = False,
    bit_rate: int | None = None,
    folder: Path | None = None,
    kill: Callable[[], None] | None = None,
    pause: Callable[[float], None] | None = None,
    branches: bool = False,
) -> AnyController:
    """The controller of a run.

    :param controller: computes the commands instead of the law; None: the law.
    :param folder: the run folder, for the log of the faults; None: no log is written.
    :param kill, pause: see :class:`railhil.bus.injector.controller_side.FaultyController`.
    :param branches: the run may be given other faults (:func:`adopt_faults`).
    :raises InputError: the law cannot be made.
    """
    contract = scenario.installed_system.contract
    make = _maker(scenario, run, controller, fd, bit_rate)
    if not scenario.faults and not branches:
        return cast(AnyController, make())
    # A controller without faults does not load the injection, which takes a tenth of its start.
    from railhil.bus.injector.controller_side import FaultyController
    from railhil.bus.injector.node_faults import NodeFaults
    from railhil.scenarios.fault_list import make_injection

    schedule = Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns, contract)
    faults = NodeFaults(make_injection(scenario, run.seed), contract, schedule, "controller", folder)
    if branches:
        faults.activities.remember()
    elif not faults.activities.all:
        # All faults of the run are at other nodes.
        return cast(AnyController, make())
    return cast(AnyController, FaultyController(make, faults, contract, kill, pause))


def _maker(scenario: AnyScenario, run: RunSpec, controller: Any, fd: bool, bit_rate: int | None) -> Callable[[], Any]:
    """Makes the controller of a run, again after a restart."""
    part = scenario.installed_system.part("controller")
    made: list[AnyController] = []

    def make() -> Any:
        # A fault starts it anew.
        for one in made:
            one.close()
        given = run.law.given
        if given is None:
            return part(scenario, run.law, controller, fd=fd, bit_rate=bit_rate)
        made[:] = [given.make_node(scenario, run, fd=fd, bit_rate=bit_rate)]
        return made[0]

    return make


def adopt_faults(node: AnyController, scenario: AnyScenario, run: RunSpec, folder: Path | None, *, fd: bool) -> None:
    """Make a controller with ``branches`` that of another run, which differs only in its faults, from now on.

    :param folder: the run folder of that run.
    :raises InputError: a fault has begun that is not in both runs.
    """
    from railhil.bus.injector.controller_side import FaultyController
    from railhil.scenarios.fault_list import make_injection

    assert isinstance(node, FaultyController), "this run has no branches"
    node.adopt(_maker(scenario, run, None, fd, None), make_injection(scenario, run.seed), folder)


def write_fault_log(node: AnyController) -> None:
    """Write the log of the controller's faults, if it is under any."""
    from railhil.bus.injector.controller_side import FaultyController

    if isinstance(node, FaultyController):
        node.faults.write()


def was_killed(node: AnyController) -> bool:
    """Whether a fault has killed the controller."""
    from railhil.bus.injector.controller_side import FaultyController

    return isinstance(node, FaultyController) and node.is_gone
