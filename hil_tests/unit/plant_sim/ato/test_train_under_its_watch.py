"""The train under its own watch: its behaviour when commands stop, and when it is too fast."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest

from railhil.plant_sim.ato.plant import Plant, PlantEvent
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Line
from railhil.wire.ato import WatchCause, WatchLevel

TICK_S = 0.01
SCENARIO = load("lvshun_tieshan")


def commanded(plant: Plant, code: int, ticks: int, *, emergency: bool = False) -> list[PlantEvent]:
    """Advance with commands polled every 20 ms."""
    events = plant.drain_events()
    for _ in range(ticks):
        if plant.tick % 2 == 0:
            plant.command(code, emergency)
        plant.advance()
        events += plant.drain_events()
    return events


def running(code: int = 1500, ticks: int = 1500, line: Line | None = None) -> Plant:
    plant = Plant(replace(SCENARIO, line=line or SCENARIO.line), 0)
    commanded(plant, code, ticks)
    assert plant.true_speed_01mmps > 50_000
    return plant


def test_reactions_to_a_silent_controller_come_in_time() -> None:
    """Traction cut within 70 ms of the last command, service brake within 270 ms, emergency within 1.02 s."""
    plant = running()
    plant.command(1500, False)
    last_s = plant.tick * TICK_S
    seen: dict[str, float] = {}
    for _ in range(110):
        plant.advance()
        # The reading after a tick shows the forces at its end: they were cut at its start.
        acted_s = (plant.tick - 1) * TICK_S - last_s
        if plant.traction_n == 0.0:
            seen.setdefault("traction cut", acted_s)
        if plant.brake_n > 0.0:
            seen.setdefault("service brake", acted_s)
        if plant.brake_n == 270e3:
            seen.setdefault("emergency", acted_s)
    assert seen == pytest.approx({"traction cut": 0.07, "service brake": 0.26, "emergency": 1.01})


def test_a_silent_controller_stops_the_train_for_good() -> None:
    plant = running()
    events = []
    for _ in range(2500):
        plant.advance()
        events += plant.drain_events()
    kinds = [event.kind for event in events]
    assert kinds == ["watch", "watch", "watch", "watch", "emergency", "stopped"], "each level on the way, then the stop"
    assert plant.watch_cause is WatchCause.COMMAND_AGE
    assert plant.true_speed_01mmps == 0
    commanded(plant, 1500, 500)
    assert plant.watch_level is WatchLevel.EMERGENCY
    assert plant.true_speed_01mmps == 0


def test_service_brake_builds_up_and_goes_with_limited_jerk() -> None:
    mass_kg = SCENARIO.train.inertial_mass_kg
    service_n = SCENARIO.train.service_braking_mps2 * mass_kg
    # A long emergency limit shows the whole ramp.
    scenario = replace(SCENARIO, watch=replace(SCENARIO.watch, emergency_ms=60_000))
    plant = Plant(scenario, 0)
    commanded(plant, 1500, 2000)
    forces = []
    for _ in range(400):
        plant.advance()
        forces.append(plant.brake_n)
    commanded(plant, 0, 21)
    assert plant.watch_level is WatchLevel.NORMAL
    for _ in range(150):
        commanded(plant, 0, 1)
        forces.append(plant.brake_n)
    largest_n = 0.75 * TICK_S * mass_kg
    rises = [later - earlier for earlier, later in pairwise(forces[:400])]
    assert max(rises) == pytest.approx(largest_n)
    assert forces[398] == forces[399] == pytest.approx(service_n)
    falls = [earlier - later for earlier, later in pairwise(forces[401:])]
    assert max(falls) == pytest.approx(largest_n)
    assert min(falls) >= 0.0
    assert forces[-1] == 0.0


def test_service_brake_builds_on_the_braking_already_there() -> None:
    plant = running(ticks=2200)
    commanded(plant, -400, 1000)
    before_n = plant.brake_n
    assert before_n > 40e3
    lowest_n = before_n
    for _ in range(60):
        plant.advance()
        lowest_n = min(lowest_n, plant.brake_n)
    assert plant.watch_level is WatchLevel.SERVICE_BRAKE
    assert lowest_n >= before_n
    assert plant.brake_n > before_n + 30e3


def test_traction_after_a_cut_builds_up_from_nothing() -> None:
    plant = running()
    traction_n = plant.traction_n
    for _ in range(12):
        plant.advance()
    assert plant.watch_level is WatchLevel.TRACTION_CUT
    assert plant.traction_n == 0.0
    counted = 0
    while plant.watch_level is WatchLevel.TRACTION_CUT and counted < 20:
        plant.command(1500, False)
        plant.advance()
        counted += 1
    assert counted == 5
    commanded(plant, 1500, 10)
    assert 0.0 < plant.traction_n < 0.1 * traction_n


@pytest.mark.parametrize("grade", [0.0, -20.0])
def test_the_brake_holds_until_the_first_command(grade: float) -> None:
    scenario = replace(SCENARIO, line=replace(SCENARIO.line, grade_permil=((0.0, grade),)))
    plant = Plant(scenario, 0)
    service_n = SCENARIO.train.service_braking_mps2 * SCENARIO.train.inertial_mass_kg
    assert plant.brake_n == service_n
    for _ in range(500):
        plant.advance()
    assert plant.position_01mm == 0
    assert plant.brake_n == service_n
    assert plant.watch_level is WatchLevel.SERVICE_BRAKE
    commanded(plant, 0, 100)
    assert plant.watch_level is WatchLevel.NORMAL
    assert (plant.true_speed_01mmps > 0) is (grade < -2.0)


def test_an_emergency_command_acts_at_once_and_is_latched() -> None:
    plant = running()
    instant_01ms = plant.tick * 100
    plant.command(1500, True)
    plant.advance()
    assert plant.brake_n == 270e3
    events = commanded(plant, 1500, 2500)
    assert [(event.kind, event.instant_01ms) for event in events[:2]] == [
        ("watch", instant_01ms),
        ("emergency", instant_01ms),
    ]
    assert [event.kind for event in events] == ["watch", "emergency", "stopped"]
    assert plant.watch_cause is WatchCause.EMERGENCY_COMMAND
    assert plant.true_speed_01mmps == 0


def limited(*rows: tuple[float, float]) -> Line:
    return replace(SCENARIO.line, speed_limit_mps=rows)


def emergency_position_m(line: Line, code: int) -> tuple[float, float]:
    """Front position and speed at which the emergency brake comes."""
    plant = Plant(replace(SCENARIO, line=line), 0)
    for _ in range(6000):
        before = plant.true_speed_01mmps / 1e4
        events = commanded(plant, code, 1)
        found = [event for event in events if event.kind == "emergency"]
        if found:
            return found[0].position_01mm / 1e4, before
    raise AssertionError("no emergency brake")


def test_overspeed_is_an_emergency_above_the_margin() -> None:
    margin_mps = SCENARIO.watch.overspeed_margin_mps
    _, speed_mps = emergency_position_m(limited((0.0, 10.0)), 1500)
    assert 10.0 + margin_mps < speed_mps < 10.0 + margin_mps + 0.02


def test_a_lower_limit_holds_from_the_front_a_higher_one_from_the_rear() -> None:
    # Down at 300 m: the train is far too fast there and is braked when its front arrives.
    position_m, _ = emergency_position_m(limited((0.0, 21.0), (300.0, 3.0)), 1500)
    assert 300.0 <= position_m < 300.2
    # Up at 60 m, while the 80 m long train is under 3 m/s + 5 km/h: the rear frees it at 140 m, not the front at 60 m.
    position_m, speed_mps = emergency_position_m(limited((0.0, 3.0), (60.0, 21.0)), 220)
    assert speed_mps > 3.0 + SCENARIO.watch.overspeed_margin_mps
    assert 60.0 < position_m < 140.0


def test_the_limit_is_higher_again_behind_the_train() -> None:
    plant = Plant(replace(SCENARIO, line=limited((0.0, 5.0), (20.0, 21.0))), 0)
    # Creep until the rear has left the slow part at 100 m, then pull.
    while plant.position_01mm < 100e4:
        commanded(plant, 120 if plant.true_speed_01mmps < 40_000 else 0, 1)
        assert plant.tick < 20_000
    commanded(plant, 1500, 1000)
    assert plant.true_speed_01mmps > 80_000
    assert plant.watch_level is WatchLevel.NORMAL
