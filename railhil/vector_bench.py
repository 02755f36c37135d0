"""Runs without a bus for systems whose laws use an ``Interface``: the plant and a controller coupled by raw integers.

The controller computes the same commands as on a healthy bus, at the same instants, and the plant takes them through
its own acceptance: telegrams and scores are those of the nodes, several times faster. There is no ladder in the
controller. The part ``direct`` of such a system.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import Any

from railhil.bench import BenchRun
from railhil.bus.codes import Event
from railhil.bus.ident import Role, make_ident
from railhil.bus.layout import Telegram
from railhil.bus.schedule import Schedule
from railhil.common.errors import InputError, Words
from railhil.controller_node.vector.controller import VectorController, VectorOutput
from railhil.controller_node.vector.law import Interface
from railhil.controller_node.vector.status import status_telegram
from railhil.dbc import Port
from railhil.faults.language import parse
from railhil.plant_sim.any_plant import AnyPlant
from railhil.plant_sim.cycle import TickLoop
from railhil.plant_sim.faults.plants import LEVELS, make_plant
from railhil.plant_sim.milestones import Milestones
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import system_named
from railhil.supervisor.judging import judging_of
from railhil.supervisor.trace import Trace

_LIFE_MASK = 0xF


def direct_run(scenario: AnyScenario, spec: RunSpec | None = None, controller: Any = None) -> BenchRun:
    """One run without a bus.

    :param spec: None: the system's default law in lockstep, seed 0.
    :param controller: computes the commands instead of the run's law.
    :raises InputError: the law cannot be made, or a fault is not one of the plant's own.
    """
    spec = spec or RunSpec(law=LawSpec(system_named(scenario.system).law))
    law = controller or VectorController(scenario, spec.law)
    run = coupled_run(scenario, law.step, spec)
    run.arithmetic = law.counters
    return run


def coupled_run(
    scenario: AnyScenario,
    law: Callable[[Sequence[int]], VectorOutput],
    spec: RunSpec,
    ports: Collection[str] | None = None,
) -> BenchRun:
    """One run of the plant under any law.

    :param law: called once per control period with one raw integer for each reading of the interface.
    :param spec: from its law only the name is used, for the record.
    :param ports: only these are published by the plant and recorded, besides the readings and commands, which the law
        needs; None: all. A plant whose telegrams draw random numbers for other ports must not be restricted.
    :raises InputError: a fault is not one of the plant's own.
    """
    if others := [text for text in scenario.faults if parse(text).place.level not in LEVELS]:
        allowed = f"faults of {', '.join(LEVELS)}: others need the nodes of the bench"
        raise InputError(scenario.name, "fault", Words("; ".join(others)), allowed)
    system = system_named(scenario.system)
    plant, _ = make_plant(scenario, spec)
    coupled = _Coupled(scenario, plant, law, system.part("interface"), ports)
    coupled.publish(make_ident(Role.CONTROLLER, scenario.sha256, **spec.law.identity, contract=system.contract))
    schedule = Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns, system.contract)
    makers = {port: make for port, make in plant.makers.items() if coupled.needs(port)}
    polled = [system.contract.port(name) for name in (*plant.commands, *plant.statuses)]
    TickLoop(plant, plant.ending, schedule, coupled, makers, polled, system.contract.clock_port.name).run()
    score = judging_of(scenario).score(scenario, coupled.trace)
    return BenchRun(coupled.trace, score, ended=coupled.ended, counters={"gate": dict(plant.refused)})


class _Coupled:
    """A law instead of the bus, see :class:`railhil.plant_sim.cycle.Surroundings`."""

    controller_lost = False

    def __init__(
        self,
        scenario: AnyScenario,
        plant: AnyPlant,
        law: Callable[[Sequence[int]], VectorOutput],
        interface: Interface,
        ports: Collection[str] | None,
    ) -> None:
        system = system_named(scenario.system)
        self._contract = system.contract
        self.trace = Trace(system.contract)
        self.ended: Event | None = None
        self.milestones = Milestones(self.publish, scenario.timing.base_tick_ns)
        self._plant = plant
        self._law = law
        self._interface = interface
        self._statuses = {kind.PORT: kind for kind in interface.statuses}
        self._ports = ports
        self._own_events = system.events
        self._read = {reading.telegram.PORT for reading in interface.readings}
        self._newest: dict[str, Telegram] = {}
        self._tick_ns, self._control_ns = scenario.timing.base_tick_ns, scenario.timing.control_period_ns
        self._now_ns = 0
        self._output: VectorOutput | None = None
        self._last_k = -1
        self._steps = 0
        self._life: dict[str, int] = {}
        self._status_ticks: dict[str, int] = {}

    def needs(self, port: str) -> bool:
        """Whether the plant publishes a port in this run."""
        return self._ports is None or port in self._ports or port in self._read

    def begin(self) -> None:
        self._now_ns = self._plant.tick * self._tick_ns

    def publish(self, telegram: Telegram) -> None:
        port = telegram.PORT
        if port in self._read:
            self._newest[port] = telegram
        if self._ports is None or port in self._ports or port not in self._plant.makers:
            self.trace.add(port, self._now_ns, telegram.encode())

    def report(self, event: Any) -> None:
        if self._plant.telegram_of(event) is None:
            number = self._own_events.get(event.kind) or Event[event.kind.upper()]
            self.milestones.reached(self._plant.tick, number, event.instant_01ms, event.position_01mm)

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

    def finish(self) -> None:
        """Nothing to send."""

    def end(self, event: Event) -> None:
        # Like the plant's node: the record has the status of the last tick.
        for name in self._plant.statuses:
            if self._status_ticks.get(name) != self._plant.tick:
                self.poll(self._contract.port(name))
        self.ended = event
        self.milestones.end(event, 0, 0)
