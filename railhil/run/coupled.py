"""Runs without a bus: the plant and a law, coupled by the raw integers that telegrams carry.

The law computes the same commands as on a healthy bus, at the same instants; telegrams are only made for the score. It
is several times faster than a run through the nodes. There is no reaction ladder in the controller. It is the part
``direct`` of a system.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import Any

from railhil.bus.codes import Event
from railhil.bus.ident import Role, make_ident
from railhil.bus.layout import Telegram
from railhil.bus.schedule import Schedule
from railhil.common.errors import InputError, Words
from railhil.controller_node.ato.control_loop import NO_BALISE, limited_01mm
from railhil.controller_node.ato.controller import Controller
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.vector.controller import VectorController, VectorOutput
from railhil.controller_node.vector.law import Interface
from railhil.controller_node.vector.node import status_telegram
from railhil.dbc import Port
from railhil.faults.language import parse
from railhil.judge.judging import judging_of
from railhil.judge.result import Result
from railhil.plant_sim.any_plant import AnyPlant
from railhil.plant_sim.ato.plant import Plant
from railhil.plant_sim.ato.telegrams import TrainTelegrams
from railhil.plant_sim.ato.train import RunEnd
from railhil.plant_sim.cycle import Milestones, TickLoop
from railhil.plant_sim.faults.plants import LEVELS, constant_mismatches, make_plant
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import System
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.perturb import perturbed
from railhil.wire.ato import NotchCmd, SimTruth, TrnPos, TrnSpeed

_LIFE_MASK = 0xF


def direct_run(scenario: Any, spec: RunSpec | None = None, controller: Any = None) -> Result:
    """One run without a bus.

    :param scenario: of its system, interpreted by the system's own parts.
    :param spec: None: the system's default law in lockstep, seed 0.
    :param controller: computes the commands instead of the run's law.
    :raises InputError: like :func:`coupled_run`, or the law cannot be made.
    """
    system = scenario.installed_system
    spec = spec or RunSpec(law=LawSpec(system.law))
    if system.interface is not None:
        law = controller or VectorController(scenario, spec.law)
        result = coupled_run(scenario, law.step, spec)
    else:
        law = controller or Controller(scenario, spec.law)
        result = coupled_run(scenario, lambda *given: law.step(*given).notch_code, spec)
    result.arithmetic = law.counters
    return result


def coupled_run(
    scenario: Any,
    law: Callable[..., Any],
    spec: RunSpec | None = None,
    ports: Collection[str] | None = None,
) -> Result:
    """One run of the plant under any law.

    :param law: called once per control period. In a system whose laws have an ``Interface``: one raw integer for each
        of its readings -> :class:`~railhil.controller_node.vector.controller.VectorOutput`. Else: control period k,
        speed in 0.1 mm/s, position in 0.1 mm, last balise -> notch code (1/256).
    :param spec: from its law only name and kind of set-points are used, for the record.
    :param ports: only these are published by the plant and recorded, besides the readings and commands, which the law
        needs; None: all. A plant whose telegrams draw random numbers for other ports must not be restricted.
    :raises InputError: like :func:`coupled_schedule`, or a fault that is not one of the plant's own.
    """
    system = scenario.installed_system
    spec = spec or RunSpec(law=LawSpec(system.law))
    if system.interface is not None:
        coupled = _over_interface(scenario, system, law, spec, ports)
    else:
        coupled = _by_notch(scenario, law, spec)
    score = judging_of(scenario).score(scenario, coupled.trace)
    return Result(scenario, spec, coupled.trace, score, ended=coupled.ended, counters={"gate": coupled.refused})


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


class _Coupled:
    """A law instead of the bus: telegrams go into the trace (:class:`railhil.plant_sim.cycle.Surroundings`)."""

    controller_lost = False

    def __init__(self, scenario: AnyScenario, plant: Any) -> None:
        system = scenario.installed_system
        self.trace = Trace(system.contract)
        self.ended: Event | None = None
        #: What the plant refused, by cause.
        self.refused: dict[str, int] = {}
        self.milestones = Milestones(self.publish, scenario.timing.base_tick_ns)
        self._plant = plant
        self._own_events = system.events
        self._tick_ns, self._control_ns = scenario.timing.base_tick_ns, scenario.timing.control_period_ns
        self._now_ns = 0

    def begin(self) -> None:
        self._now_ns = self._plant.tick * self._tick_ns

    def publish(self, telegram: Telegram) -> None:
        self.trace.add(telegram.PORT, self._now_ns, telegram.encode())

    def report(self, event: Any) -> None:
        number = self._own_events.get(event.kind) or Event[event.kind.upper()]
        self.milestones.reached(self._plant.tick, number, event.instant_01ms, event.position_01mm)

    def finish(self) -> None:
        """Nothing to send."""

    def end(self, event: Event) -> None:
        self.ended = event
        self.milestones.end(event, 0, 0)


def _by_notch(scenario: Scenario, law: Callable[[int, int, int, BaliseReading[int]], int], spec: RunSpec) -> _Coupled:
    """A run of the system ``ato``: as on the bus, the law has the position of the last TRN_POS."""
    actual = perturbed(scenario, spec.seed) if spec.perturbed else scenario
    if scenario.faults:
        actual = constant_mismatches(scenario, [spec.seed])[0].applied(actual)
    plant = Plant(actual, spec.seed)
    coupled = _CoupledByNotch(scenario, plant, law)
    coupled.publish(make_ident(Role.CONTROLLER, scenario.sha256, **spec.identity))
    truth = TrainTelegrams(actual, plant, 0.0).makers[SimTruth.PORT]
    makers = {SimTruth.PORT: truth, TrnPos.PORT: coupled.read_position}
    schedule, ending = coupled_schedule(scenario), RunEnd(scenario, plant)
    TickLoop(plant, ending, schedule, coupled, makers, (NotchCmd.port(),), TrnSpeed.PORT).run()
    return coupled


class _CoupledByNotch(_Coupled):
    def __init__(
        self, scenario: Scenario, plant: Plant, law: Callable[[int, int, int, BaliseReading[int]], int]
    ) -> None:
        super().__init__(scenario, plant)
        self._law = law
        # Control period of the last step, and its notch.
        self._k, self._code = -1, 0
        self._position_01mm = 0
        self._balise = NO_BALISE

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
            super().report(event)

    def poll(self, port: Port) -> None:
        """NOTCH_CMD: step the law at the first poll of a control period."""
        k = self._now_ns // self._control_ns
        if k > self._k:
            self._k, self._code = k, self._law(k, self._plant.speed_01mmps, self._position_01mm, self._balise)
        self._plant.command(self._code, False)
        self.publish(NotchCmd(self._code))


def _over_interface(
    scenario: AnyScenario,
    system: System,
    law: Callable[[Sequence[int]], VectorOutput],
    spec: RunSpec,
    ports: Collection[str] | None,
) -> _Coupled:
    """A run of a system whose laws have an ``Interface``; the plant takes the commands through its own acceptance."""
    if others := [text for text in scenario.faults if parse(text).place.level not in LEVELS]:
        allowed = f"faults of {', '.join(LEVELS)}: others need the nodes of the bench"
        raise InputError(scenario.name, "fault", Words("; ".join(others)), allowed)
    plant, _ = make_plant(scenario, spec)
    coupled = _CoupledOverInterface(scenario, plant, law, system.part("interface"), ports)
    coupled.publish(make_ident(Role.CONTROLLER, scenario.sha256, **spec.law.identity, contract=system.contract))
    schedule = Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns, system.contract)
    makers = {port: make for port, make in plant.makers.items() if coupled.needs(port)}
    polled = [system.contract.port(name) for name in (*plant.commands, *plant.statuses)]
    TickLoop(plant, plant.ending, schedule, coupled, makers, polled, system.contract.clock_port.name).run()
    coupled.refused = dict(plant.refused)
    return coupled


class _CoupledOverInterface(_Coupled):
    def __init__(
        self,
        scenario: AnyScenario,
        plant: AnyPlant,
        law: Callable[[Sequence[int]], VectorOutput],
        interface: Interface,
        ports: Collection[str] | None,
    ) -> None:
        super().__init__(scenario, plant)
        self._law = law
        self._interface = interface
        self._statuses = {kind.PORT: kind for kind in interface.statuses}
        self._ports = ports
        self._read = {reading.telegram.PORT for reading in interface.readings}
        self._newest: dict[str, Telegram] = {}
        self._output: VectorOutput | None = None
        self._last_k = -1
        self._steps = 0
        self._life: dict[str, int] = {}
        self._status_ticks: dict[str, int] = {}

    def needs(self, port: str) -> bool:
        """Whether the plant publishes a port in this run."""
        return self._ports is None or port in self._ports or port in self._read

    def publish(self, telegram: Telegram) -> None:
        port = telegram.PORT
        if port in self._read:
            self._newest[port] = telegram
        if self._ports is None or port in self._ports or port not in self._plant.makers:
            super().publish(telegram)

    def report(self, event: Any) -> None:
        if self._plant.telegram_of(event) is None:
            super().report(event)

    def poll(self, port: Port) -> None:
        """A command: step the law at the first poll of a control period. Or the status."""
        interface = self._interface
        self._life[port.name] = life = (self._life.get(port.name, -1) + 1) & _LIFE_MASK
        kind: Any = self._plant.commands.get(port.name)
        if kind is not None:
            values = zip(interface.commands, self._stepped().commands, strict=True)
            fields = {item.field: raw for item, raw in values if item.telegram is kind}
            telegram = kind(**fields, life=life)
            self._plant.take(telegram)
            self.publish(telegram)
        elif self._output is not None and port.name in self._statuses:
            self._status_ticks[port.name] = self._plant.tick
            self.publish(status_telegram(interface, self._statuses[port.name], self._output, self._steps, life))

    def _stepped(self) -> VectorOutput:
        k = self._now_ns // self._control_ns
        if k != self._last_k or self._output is None:
            raws = [getattr(self._newest[item.telegram.PORT], item.field) for item in self._interface.readings]
            self._output, self._last_k = self._law(raws), k
            self._steps += 1
        return self._output

    def end(self, event: Event) -> None:
        # Like the plant's node: the record has the status of the last tick.
        for name in self._plant.statuses:
            if self._status_ticks.get(name) != self._plant.tick:
                self.poll(self.trace.contract.port(name))
        super().end(event)
