"""The order of events in a tick, and the end of a run."""

from __future__ import annotations

from dataclasses import replace

import pytest

from railhil.bus.codes import Event
from railhil.bus.layout import CHECK_CORRECT, CHECK_ERRONEOUS, Telegram
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import SupCmd, TimeSync
from railhil.dbc import Port, wire_contract
from railhil.plant_sim.any_plant import BRAKING_MAX_NS, PlantError
from railhil.plant_sim.ato.plant import Plant, PlantEvent
from railhil.plant_sim.ato.telegrams import TrainTelegrams
from railhil.plant_sim.ato.train import RunEnd
from railhil.plant_sim.cycle import Milestones, TickLoop
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Balise, Scenario
from railhil.wire.ato import CtlStat, NotchCmd, SimTruth, TrnPos, TrnSpeed


def scenario_of(running_time_s: float) -> Scenario:
    """A balise under the waiting train; the timetable is over after so long."""
    scenario = load("lvshun_tieshan")
    plan = replace(scenario.plan, running_time_s=running_time_s, overtime_max_s=0.0)
    return replace(scenario, plan=plan, line=replace(scenario.line, balises=(Balise(9, 0.0, 0.0),)))


class Noting:
    """Notes what it is told."""

    def __init__(self, plant: Plant, notch_code: int = 0, ends_at: tuple[int, str] | None = None) -> None:
        self.ended: Event | None = None
        self.controller_lost = False
        self.notes: list[str] = []
        self.milestones = Milestones(self.publish, 10_000_000)
        self._plant = plant
        self._notch_code = notch_code
        self._ends_at = ends_at

    def note(self, text: str) -> None:
        self.notes.append(f"{self._plant.tick} {text}")

    def begin(self) -> None:
        self.note("begin")

    def publish(self, telegram: Telegram) -> None:
        self.note(telegram.PORT)

    def report(self, event: PlantEvent) -> None:
        self.note(event.kind)

    def poll(self, port: Port) -> None:
        self.note(f"{port.name}?")
        if port.name == NotchCmd.PORT:
            self._plant.command(self._notch_code, False)
        if self._ends_at == (self._plant.tick, port.name):
            self.end(Event.ENDED_BY_SUPERVISOR)

    def finish(self) -> None:
        self.note("finish")

    def end(self, event: Event) -> None:
        self.note(event.name)
        self.ended = event


def cycle_of(scenario: Scenario, plant: Plant, noting: Noting, *ports: str) -> TickLoop:
    makers = TrainTelegrams(scenario, plant, 0.0).makers
    schedule = Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns, wire_contract())
    asked = [telegram.port() for telegram in (SupCmd, NotchCmd, CtlStat)]
    published = {port: makers[port] for port in ports}
    return TickLoop(plant, RunEnd(scenario, plant), schedule, noting, published, asked, TrnSpeed.PORT)


def test_order_of_a_tick() -> None:
    scenario = scenario_of(0.01)
    plant = Plant(scenario, 0)
    noting = Noting(plant, 1792)
    cycle_of(scenario, plant, noting, TimeSync.PORT, TrnSpeed.PORT, SimTruth.PORT).run()
    assert noting.notes == [
        *("0 begin", "0 TRN_SPEED", "0 TIME_SYNC", "0 SIM_TRUTH", "0 balise"),
        *("0 SUP_CMD?", "0 NOTCH_CMD?", "0 CTL_STAT?", "0 finish"),
        *("1 begin", "1 TRN_SPEED", "1 watch", "1 finish"),
        *("2 begin", "2 TRN_SPEED", "2 SIM_TRUTH", "2 NOTCH_CMD?", "2 finish", "2 ENDED_NOT_STOPPED"),
    ]
    assert plant.tick == 2, "time goes on only while the run does"


@pytest.mark.parametrize(("port", "polls"), [(SupCmd.PORT, 1), (NotchCmd.PORT, 2), (CtlStat.PORT, 3)])
def test_who_has_just_been_told_the_end_is_not_polled_any_more(port: str, polls: int) -> None:
    scenario = scenario_of(10.0)
    plant = Plant(scenario, 0)
    noting = Noting(plant, ends_at=(16, port))
    cycle_of(scenario, plant, noting).run()
    assert plant.tick == 16
    assert sum(note.startswith("16 ") and note.endswith("?") for note in noting.notes) == polls
    assert noting.notes[-2:] == ["16 ENDED_BY_SUPERVISOR", "16 finish"]


def test_a_run_goes_on_for_a_second_after_the_stop() -> None:
    """Also when the timetable is over meanwhile; what the train does after its stop changes nothing."""
    scenario = scenario_of(300.0)
    plant = Plant(scenario, 0)
    noting = Noting(plant, 1792)
    cycle = cycle_of(scenario, plant, noting)
    begin = noting.begin

    def braking() -> None:
        begin()
        if plant.tick == 500:
            noting._notch_code = -1792

    noting.begin = braking  # type: ignore[method-assign]
    cycle.run()
    stop = next(note for note in noting.notes if note.endswith("stopped"))
    assert noting.notes[-1] == f"{int(stop.split()[0]) + 100} ENDED_COMPLETE"


def test_the_first_stop_counts() -> None:
    scenario = scenario_of(0.5)
    run_end = RunEnd(scenario, Plant(scenario, 0))
    run_end.happened("departed", 10)
    run_end.happened("stopped", 20)
    run_end.happened("stopped", 90)
    found = [run_end.reached(tick, False) for tick in (51, 119, 120)]
    assert found == [None, None, Event.ENDED_COMPLETE]


def test_a_train_without_its_controller_may_brake_after_the_timetable() -> None:
    scenario = scenario_of(0.5)
    plant = Plant(scenario, 0)
    run_end = RunEnd(scenario, plant)
    assert run_end.reached(50, False) is None
    assert run_end.reached(51, False) is Event.ENDED_NOT_STOPPED
    assert run_end.reached(3, True) is Event.ENDED_NOT_STOPPED, "nobody will ever move it"
    for _ in range(200):
        plant.command(1792, False)
        plant.advance()
    assert plant.true_speed_01mmps > 0
    last = 50 + BRAKING_MAX_NS // scenario.timing.base_tick_ns
    assert [run_end.reached(tick, True) for tick in (3, 51, last)] == [None] * 3
    assert run_end.reached(last + 1, True) is Event.ENDED_NOT_STOPPED


def test_what_the_wire_cannot_carry_ends_the_run_as_an_error_of_the_plant() -> None:
    scenario = scenario_of(10.0)
    plant = Plant(scenario, 0)
    noting = Noting(plant)
    noting.publish = lambda telegram: telegram.encode() and None  # type: ignore[method-assign]
    plant._motion = plant._motion._replace(position_m=1e9)
    with pytest.raises(PlantError, match=r"^tick 0: TRN_POS\.odometer_mm: found 1000000000000, allowed"):
        cycle_of(scenario, plant, noting, TrnPos.PORT).run()


def test_a_speed_beyond_its_signal_says_that_it_is_none() -> None:
    scenario = scenario_of(10.0)
    plant = Plant(scenario, 0)
    makers = TrainTelegrams(scenario, plant, 0.0).makers
    for speed_mps, raw, check in ((838.0, 8_380_000, CHECK_CORRECT), (900.0, 2**23 - 1, CHECK_ERRONEOUS)):
        plant._motion = plant._motion._replace(speed_mps=speed_mps)
        telegram = makers[TrnSpeed.PORT]()
        assert isinstance(telegram, TrnSpeed)
        assert (round(telegram.speed_01mmps, -3) // 1000, telegram.check) == (round(raw, -3) // 1000, check)
        assert TrnSpeed.decode(telegram.encode()) == telegram
