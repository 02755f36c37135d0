"""The bench without sockets: the same plant, controller and supervisor code in one process.

``local_run`` sends every telegram through the codec and the stores, as ``railhil run --bus local`` does
(:mod:`railhil.local_run`); ``direct_run`` couples plant and controller by their raw wire integers, for statistics over
hundreds of runs. Both give the notch sequence of the real bench.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from railhil.bus.codes import Event
from railhil.bus.errors import PeerSilent
from railhil.bus.frame import Frame
from railhil.bus.ident import Role, make_ident
from railhil.bus.layout import Telegram
from railhil.bus.local import LocalBus
from railhil.bus.reception import received_by
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import NotchCmd, SimTruth, TrnPos, TrnSpeed
from railhil.common.errors import InputError, Words
from railhil.controller_node.any_controller import AnyController
from railhil.controller_node.arithmetic.base import Counters
from railhil.controller_node.controller import Controller
from railhil.controller_node.faulty import controller_of, was_killed, write_fault_log
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.loop import NO_BALISE, limited_01mm
from railhil.controller_node.telemetry_file import telemetry_document
from railhil.dbc import Port
from railhil.plant_sim.cycle import TickLoop
from railhil.plant_sim.faults.plants import constant_mismatches
from railhil.plant_sim.milestones import Milestones
from railhil.plant_sim.node import PlantNode
from railhil.plant_sim.plant import Plant
from railhil.plant_sim.run_end import RunEnd
from railhil.plant_sim.telegrams import TrainTelegrams
from railhil.scenarios.model import AnyScenario, Scenario
from railhil.scenarios.perturb import perturbed
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named
from railhil.supervisor.fault_report import FaultOutcome, check_faults, fault_outcomes
from railhil.supervisor.framelog import FrameLog
from railhil.supervisor.judging import judging_of
from railhil.supervisor.log_trace import trace_of_log
from railhil.supervisor.score import Score, score
from railhil.supervisor.session import Session
from railhil.supervisor.trace import Told, Trace


@dataclass(slots=True)
class BenchRun:
    """Result of a run without sockets: trace and score, the log's hash, and the counters of each node."""

    trace: Trace
    score: Score
    log: Path | None = None
    frames_sha256: str = ""
    ended: Event | None = None
    counters: dict[str, dict[str, int]] = field(default_factory=dict)
    #: Content that the controller's process would write to ``telemetry.json``.
    telemetry: dict[str, Any] = field(default_factory=dict)
    #: Event counters of the law's arithmetic over the whole run; only for a direct run.
    arithmetic: Counters | None = None
    #: What became of the faults of the run, by number.
    faults: list[FaultOutcome] = field(default_factory=list)

    @property
    def notches(self) -> list[int]:
        """Notch command codes (1/256) in the order in which they were sent."""
        return [int(code) for code in self.trace.raw(NotchCmd.PORT, "NotchCmd")]

    @property
    def refused(self) -> dict[str, int]:
        """Everything that any node refused, except frames of ports without a mailbox: empty on a healthy bus."""
        found: dict[str, int] = {}
        for node, counters in self.counters.items():
            for cause, count in counters.items():
                if cause not in ("unknown_id", "no_mailbox", "accepted", "polls") and count:
                    found[f"{node}.{cause}"] = count
        return found


def local_run(
    scenario: AnyScenario,
    folder: Path,
    spec: RunSpec | None = None,
    *,
    fd: bool = False,
    wire: Callable[[Frame], list[Frame]] | None = None,
    controller: Any = None,
) -> BenchRun:
    """One run through codec and stores, for any system.

    :param spec: None: the system's default law in lockstep, seed 0.
    :param wire: applied to each frame on its way to the controller (faults); default: no change.
    :param controller: computes the commands instead of the run's law.
    """
    system = system_named(scenario.system)
    spec = spec or RunSpec(law=LawSpec(system.law))
    check_faults(scenario, ["local"], spec.pace)
    log = FrameLog(folder)
    session = Session(scenario, log.write, spec, fd=fd)
    node = controller_of(scenario, spec.law, spec.seed, controller, fd=fd, folder=folder)
    plant = plant_beside(scenario, spec, node, session, fd=fd, wire=wire, folder=folder)
    try:
        ended = plant.run()
    except PeerSilent:
        # As asked for by a fault: the train has stopped by itself.
        if not was_killed(node) or plant.ended is None:
            raise
        ended = plant.ended
    write_fault_logs(plant, node)
    sha256 = log.close()
    trace = trace_of_log(log.path, system.contract)
    if wire is None:
        trace.told = Told(exact=True, nodes=received_by({"controller": node, "plant": plant}))
    return BenchRun(
        trace,
        judging_of(scenario).score(scenario, trace),
        log.path,
        sha256,
        ended,
        {
            "plant": dict(plant.counters),
            "gate": dict(plant.plant.refused),
            "controller": dict(node.counters),
            "supervisor": session.counters,
        },
        telemetry_document(node),
        faults=fault_outcomes(folder, scenario, spec.seed),
    )


def plant_beside(
    scenario: AnyScenario,
    spec: RunSpec,
    node: AnyController,
    session: Session,
    *,
    fd: bool = False,
    wire: Callable[[Frame], list[Frame]] | None = None,
    folder: Path | None = None,
) -> PlantNode:
    """The plant of a run in this process: its :meth:`~railhil.plant_sim.node.PlantNode.run` is the run.

    :param wire: as in :func:`local_run`.
    :param folder: where the logs of its faults go (:func:`write_fault_logs`).
    """

    def over_wire(frame: Frame) -> list[Frame]:
        assert wire is not None
        return [answer for item in wire(frame) for answer in node.handle(item)]

    bus = LocalBus([over_wire if wire else node.handle, session.handle])
    return PlantNode(scenario, spec, bus, fd=fd, fault_log=folder)


def write_fault_logs(plant: PlantNode, node: AnyController) -> None:
    """Write the logs of what the injectors of a run did into its folder."""
    plant.write_fault_logs()
    write_fault_log(node)


def unrecorded_run(scenario: AnyScenario, spec: RunSpec | None = None, controller: Any = None) -> BenchRun:
    """:func:`local_run` without a run folder: only the hash of the record is kept."""
    with tempfile.TemporaryDirectory(prefix="railhil-") as folder:
        run = local_run(scenario, Path(folder), spec, controller=controller)
    run.log = None
    return run


def direct_run(scenario: Scenario, spec: RunSpec | None = None, controller: Any = None) -> BenchRun:
    """One run with plant and controller coupled by their wire integers, with telegrams only for the score.

    :param controller: computes the notch instead of the run's law.
    """
    spec = spec or RunSpec()
    law = controller or Controller(scenario, spec.law)
    run = coupled_run(scenario, lambda *given: law.step(*given).notch_code, spec)
    run.arithmetic = law.counters
    return run


def coupled_schedule(scenario: Scenario) -> Schedule:
    """Periods of the ports for a run without a bus.

    :raises InputError: the speed is sent less often than NOTCH_CMD is polled: the law would then see an old speed, and
        the controller's watch, which only the nodes have, would act. Or the scenario has a safe channel: it takes two
        telegrams to begin, which only the nodes exchange.
    """
    if scenario.safety.sdt:
        raise InputError(scenario.name, "safety.sdt", Words("true"), "false, or the run over a bus (railhil run)")
    schedule = Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns)
    speed, notch = schedule.ticks(TrnSpeed.PORT), schedule.ticks(NotchCmd.PORT)
    if speed > notch:
        found = Words(f"TRN_SPEED every {speed} ticks, NOTCH_CMD polled every {notch}")
        allowed = "TRN_SPEED at least as often as NOTCH_CMD, or the run over a bus (railhil run)"
        raise InputError(scenario.name, "timing.port_period_ms", found, allowed)
    return schedule


def coupled_run(
    scenario: Scenario,
    law: Callable[[int, int, int, BaliseReading[int]], int],
    spec: RunSpec | None = None,
) -> BenchRun:
    """One run of the plant under any law.

    As on the bus, the law is stepped at the first poll of NOTCH_CMD of a new control period, with the position of the
    last TRN_POS. There is no reaction ladder in the controller.

    :param law: control period k, speed in 0.1 mm/s, position in 0.1 mm, last balise -> notch code (1/256).
    :param spec: from its law only the kind of set-points is used, for the score.
    :raises InputError: like :func:`coupled_schedule`, or a fault that needs the nodes.
    """
    spec = spec or RunSpec()
    actual = perturbed(scenario, spec.seed) if spec.perturbed else scenario
    if scenario.faults:
        actual = constant_mismatches(scenario, [spec.seed])[0].applied(actual)
    plant = Plant(actual, spec.seed)
    coupled = _Coupled(scenario, plant, law)
    coupled.publish(make_ident(Role.CONTROLLER, scenario.sha256, **spec.identity))
    truth = TrainTelegrams(actual, plant, 0.0).makers[SimTruth.PORT]
    makers = {SimTruth.PORT: truth, TrnPos.PORT: coupled.read_position}
    schedule, ending = coupled_schedule(scenario), RunEnd(scenario, plant)
    TickLoop(plant, ending, schedule, coupled, makers, (NotchCmd.port(),), TrnSpeed.PORT).run()
    return BenchRun(coupled.trace, score(scenario, coupled.trace), ended=coupled.ended)


class _Coupled:
    """A law instead of the bus: it gets the readings directly, and telegrams go into the trace.

    See :class:`railhil.plant_sim.cycle.Surroundings`.
    """

    controller_lost = False

    def __init__(
        self, scenario: Scenario, plant: Plant, law: Callable[[int, int, int, BaliseReading[int]], int]
    ) -> None:
        self.trace = Trace()
        self.ended: Event | None = None
        self._plant = plant
        self._law = law
        self._tick_ns, self._control_ns = scenario.timing.base_tick_ns, scenario.timing.control_period_ns
        self._now_ns = 0
        self.milestones = Milestones(self.publish, self._tick_ns)
        # Control period of the last step, and its notch.
        self._k, self._code = -1, 0
        self._position_01mm = 0
        self._balise = NO_BALISE

    def begin(self) -> None:
        self._now_ns = self._plant.tick * self._tick_ns

    def publish(self, telegram: Telegram) -> None:
        self.trace.add(telegram.PORT, self._now_ns, telegram.encode())

    def read_position(self) -> None:
        """TRN_POS is due: read the position; the telegram itself is not needed."""
        self._position_01mm = limited_01mm(self._plant.odometer_mm)

    def report(self, event: Any) -> None:
        if event.kind == "watch":
            # There is no ladder here that could need it.
            return
        if event.balise is not None:
            surveyed_mm = round(event.balise.surveyed_m * 1000)
            reading = limited_01mm(surveyed_mm), limited_01mm(event.odometer_mm)
            self._balise = BaliseReading(event.balise.number, *reading)
        else:
            kind = Event[event.kind.upper()]
            self.milestones.reached(self._plant.tick, kind, event.instant_01ms, event.position_01mm)

    def poll(self, port: Port) -> None:
        """NOTCH_CMD: step the law at the first poll of a control period."""
        k = self._now_ns // self._control_ns
        if k > self._k:
            self._k, self._code = k, self._law(k, self._plant.speed_01mmps, self._position_01mm, self._balise)
        self._plant.command(self._code, False)
        self.publish(NotchCmd(self._code))

    def finish(self) -> None:
        """Nothing to send."""

    def end(self, event: Event) -> None:
        self.ended = event
        self.milestones.end(event, 0, 0)
