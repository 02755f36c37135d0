"""Runs without a bus: the plant and a law, coupled by the raw integers that telegrams carry.

The law computes the same commands as on a healthy bus, at the same instants; telegrams are only made for the score. It
is several times faster than a run through the nodes. There is no reaction ladder in the controller.
:func:`direct_run` is the part ``direct`` of a system, its part ``coupling`` says how plant and law are coupled:
:func:`couple_over_interface`, if it has none.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

from railhil.bus.codes import Event
from railhil.bus.ident import Role, make_ident
from railhil.bus.layout import Telegram
from railhil.bus.schedule import Schedule
from railhil.common.errors import InputError, Words
from railhil.controller_node.law_controller import maker_of
from railhil.controller_node.vector.controller import VectorOutput
from railhil.controller_node.vector.law import Interface
from railhil.controller_node.vector.node import status_telegram
from railhil.dbc import Port
from railhil.faults.language import parse
from railhil.judge.judging import judging_of
from railhil.judge.result import Result
from railhil.plant_sim.any_plant import AnyPlant, FaultTooLarge, PlantError
from railhil.plant_sim.cycle import Milestones, TickLoop
from railhil.plant_sim.faults.plant_faults import PlantFaults
from railhil.plant_sim.faults.plants import LEVELS, make_plant
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec

_LIFE_MASK = 0xF


def direct_run(
    scenario: Any, spec: RunSpec | None = None, controller: Any = None, ports: Collection[str] | None = None
) -> Result:
    """One run of a law without a bus.

    :param scenario: of its system, interpreted by the system's own parts.
    :param spec: None: the system's default law in lockstep, seed 0.
    :param controller: computes the commands instead of the run's law.
    :param ports: as for :func:`coupled_run`.
    :raises InputError: like :func:`coupled_run`, or the law cannot be made.
    """
    system = scenario.installed_system
    spec = spec or RunSpec(law=LawSpec(system.law))
    law = controller or maker_of(system, scenario)(scenario, spec.law)
    result = coupled_run(scenario, law.step, spec, ports)
    result.arithmetic = law.counters
    return result


def coupled_run(
    scenario: Any,
    law: Callable[..., Any],
    spec: RunSpec | None = None,
    ports: Collection[str] | None = None,
) -> Result:
    """One run of the plant under any law.

    :param law: called once per control period, as the system's coupling says. In a system whose laws have an
        ``Interface``: one raw integer for each of its readings ->
        :class:`~railhil.controller_node.vector.controller.VectorOutput`. In ``ato``: control period k, speed in
        0.1 mm/s, position in 0.1 mm, last balise -> notch code (1/256).
    :param spec: from its law only name and kind of set-points are used, for the record.
    :param ports: the plant publishes and records only these, besides the readings and commands, which the law needs;
        None: all. A plant whose telegrams draw random numbers for other ports must not be restricted.
    :raises InputError: the system's coupling refuses the scenario, such as a fault outside the plant.
    """
    system = scenario.installed_system
    spec = spec or RunSpec(law=LawSpec(system.law))
    couple = system.optional_part("coupling") or couple_over_interface
    coupled: Coupling = couple(scenario, law, spec, ports)
    score = judging_of(scenario).score(scenario, coupled.trace)
    return Result(scenario, spec, coupled.trace, score, ended=coupled.ended, counters={"gate": coupled.refused})


class Coupling:
    """A law instead of the bus: telegrams go into the trace (:class:`railhil.plant_sim.cycle.Surroundings`).

    A subclass says what is asked of the law in a control period (:meth:`compute`), and what it answers to a poll.

    :param law: called by :meth:`compute`.
    """

    controller_lost = False

    def __init__(self, scenario: AnyScenario, plant: Any, law: Callable[..., Any]) -> None:
        system = scenario.installed_system
        self.plant = plant
        self.law = law
        self.trace = Trace(system.contract)
        self.ended: Event | None = None
        #: Telegrams that the plant refused, by cause.
        self.refused: dict[str, int] = {}
        self.milestones = Milestones(self.publish, scenario.timing.base_tick_ns)
        #: Control periods in which the law was called.
        self.steps = 0
        self._scenario = scenario
        self._own_events = system.events
        self._tick_ns, self._control_ns = scenario.timing.base_tick_ns, scenario.timing.control_period_ns
        self._now_ns = 0
        self._period = -1
        self._output: Any = None

    def identify(self, identity: Mapping[str, Any]) -> None:
        """Record the controller's identity."""
        contract = self._scenario.installed_system.contract
        self.publish(make_ident(Role.CONTROLLER, self._scenario.sha256, **identity, contract=contract))

    def run(
        self, ending: Any, schedule: Schedule, makers: Mapping[str, Any], polled: Sequence[Port], clock_port: str
    ) -> None:
        """Run the plant to its end.

        :raises FaultTooLarge: a fault drives it beyond what telegrams carry; :raises PlantError: it fails without one.
        """
        try:
            TickLoop(self.plant, ending, schedule, self, makers, polled, clock_port).run()
        except PlantError as error:
            if self._scenario.faults and isinstance(error.__cause__, OverflowError):
                raise FaultTooLarge(f"{'; '.join(self._scenario.faults)}: {FaultTooLarge.SAID}: {error}") from error
            raise

    def output(self) -> Any:
        """The law's output of this control period; the law is called at the first poll of the period."""
        period = self._now_ns // self._control_ns
        if period != self._period:
            self._period, self._output = period, self.compute(period)
            self.steps += 1
        return self._output

    def compute(self, period: int) -> Any:
        """Call the law for a control period."""
        raise NotImplementedError

    def poll(self, port: Port) -> None:
        """Answer a poll."""
        raise NotImplementedError

    def begin(self) -> None:
        self._now_ns = self.plant.tick * self._tick_ns

    def publish(self, telegram: Telegram) -> None:
        self.trace.add(telegram.PORT, self._now_ns, telegram.encode())

    def report(self, event: Any) -> None:
        number = self._own_events.get(event.kind) or Event[event.kind.upper()]
        self.milestones.reached(self.plant.tick, number, event.instant_01ms, event.position_01mm)

    def finish(self) -> None:
        """Nothing to send."""

    def end(self, event: Event) -> None:
        self.ended = event
        self.milestones.end(event, 0, 0)


def couple_over_interface(
    scenario: AnyScenario,
    law: Callable[[Sequence[int]], VectorOutput],
    spec: RunSpec,
    ports: Collection[str] | None,
) -> Coupling:
    """A run of a system whose laws have an ``Interface``; the plant takes the commands through its own acceptance.

    :raises InputError: a fault that is not one of the plant's own; the system has no part ``interface``.
    """
    if others := [text for text in scenario.faults if parse(text).place.level not in LEVELS]:
        allowed = f"faults of {', '.join(LEVELS)}: others need the nodes of the bench"
        raise InputError(scenario.name, "fault", Words("; ".join(others)), allowed)
    system = scenario.installed_system
    interface = system.part("interface")
    plant, inside = make_plant(scenario, spec)
    coupled = InterfaceCoupling(scenario, plant, law, interface, ports)
    if system.truth is not None:
        limited = PlantFaults(None, inside, None).limited(coupled.publish, system.truth.port)
        coupled.publish = limited  # type: ignore[assignment, method-assign]
    coupled.identify(spec.law.identity)
    contract = system.contract
    schedule = Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns, contract)
    makers = {port: make for port, make in plant.makers.items() if coupled.needs(port)}
    polled = [contract.port(name) for name in (*plant.commands, *plant.statuses)]
    coupled.run(plant.ending, schedule, makers, polled, contract.clock_port.name)
    coupled.refused = dict(plant.refused)
    return coupled


class InterfaceCoupling(Coupling):
    """The law gets the newest readings of its interface; the plant gets telegrams with the commands."""

    def __init__(
        self,
        scenario: AnyScenario,
        plant: AnyPlant,
        law: Callable[[Sequence[int]], VectorOutput],
        interface: Interface,
        ports: Collection[str] | None,
    ) -> None:
        super().__init__(scenario, plant, law)
        self._interface = interface
        self._statuses = {kind.PORT: kind for kind in interface.statuses}
        self._ports = ports
        self._read = {reading.telegram.PORT for reading in interface.readings}
        self._newest: dict[str, Telegram] = {}
        self._life: dict[str, int] = {}
        self._status_ticks: dict[str, int] = {}

    def needs(self, port: str) -> bool:
        """Whether the plant publishes a port in this run."""
        return self._ports is None or port in self._ports or port in self._read

    def publish(self, telegram: Telegram) -> None:
        port = telegram.PORT
        if port in self._read:
            self._newest[port] = telegram
        if self._ports is None or port in self._ports or port not in self.plant.makers:
            super().publish(telegram)

    def report(self, event: Any) -> None:
        if self.plant.telegram_of(event) is None:
            super().report(event)

    def compute(self, period: int) -> VectorOutput:
        raws = [getattr(self._newest[item.telegram.PORT], item.field) for item in self._interface.readings]
        found: VectorOutput = self.law(raws)
        return found

    def poll(self, port: Port) -> None:
        """A command, or the status."""
        interface = self._interface
        self._life[port.name] = life = (self._life.get(port.name, -1) + 1) & _LIFE_MASK
        kind: Any = self.plant.commands.get(port.name)
        if kind is not None:
            values = zip(interface.commands, self.output().commands, strict=True)
            fields = {item.field: raw for item, raw in values if item.telegram is kind}
            telegram = kind(**fields, life=life)
            self.plant.take(telegram)
            self.publish(telegram)
        elif self.steps and port.name in self._statuses:
            self._status_ticks[port.name] = self.plant.tick
            self.publish(status_telegram(interface, self._statuses[port.name], self._output, self.steps, life))

    def end(self, event: Event) -> None:
        # Like the plant's node: the record has the status of the last tick.
        for name in self.plant.statuses:
            if self._status_ticks.get(name) != self.plant.tick:
                self.poll(self.trace.contract.port(name))
        super().end(event)
