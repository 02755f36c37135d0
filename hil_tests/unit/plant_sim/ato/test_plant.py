"""The train as seen from the bus: commands, readings, events and interlocks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from railhil.plant_sim.ato.plant import Plant, PlantError, PlantEvent
from railhil.plant_sim.ato.plant_readings import TrainStatus
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Balise, Scenario
from railhil.systems.ato.scenario.perturb import perturb

NOMINAL = load("lvshun_tieshan")
QUIET = replace(NOMINAL, sensors=replace(NOMINAL.sensors, speed_noise_sigma_mps=0.0))


def with_delay(scenario: Scenario, delay_s: float) -> Scenario:
    return replace(scenario, timing=replace(scenario.timing, loop_delay_s=delay_s))


def driven(plant: Plant, code: int, ticks: int) -> list[PlantEvent]:
    """Advance with one notch, commanded at every tick; events of the train's watch are left out."""
    events = plant.drain_events()
    for _ in range(ticks):
        plant.command(code, False)
        plant.advance()
        events += plant.drain_events()
    return [event for event in events if event.kind != "watch"]


@pytest.mark.parametrize("delay_s", [0.0, 0.005, 0.0401, 0.0437, 0.1, 0.1999])
def test_a_command_acts_after_exactly_the_loop_delay(delay_s: float) -> None:
    departures = []
    for delay in (0.04, delay_s):
        plant = Plant(with_delay(NOMINAL, delay), 0)
        departures.append(next(event for event in driven(plant, 1792, 60) if event.kind == "departed").instant_01ms)
    assert departures[1] - departures[0] == pytest.approx((delay_s - 0.04) * 1e4, abs=1)


def test_the_acting_notch_changes_at_the_tick_of_its_instant() -> None:
    plant = Plant(NOMINAL, 0)
    seen = []
    for tick in range(14):
        seen.append(plant.notch_acting)
        plant.command(300 if tick < 5 else -200, False)
        plant.advance()
    assert seen == [0] * 4 + [300] * 5 + [-200] * 5


@pytest.mark.parametrize(("code", "acting"), [(1792, 1792), (1793, 1792), (32767, 1792), (-1793, -1792), (-1, -1)])
def test_commands_are_clamped_to_the_notch_range(code: int, acting: int) -> None:
    plant = Plant(NOMINAL, 0)
    driven(plant, code, 5)
    assert plant.notch_acting == acting


def test_a_repeated_command_is_not_staged_again() -> None:
    plant = Plant(with_delay(NOMINAL, 0.2), 0)
    codes = [100, 100, 100, 200, 200, 100, 100]
    acting = []
    for code in codes + [100] * 25:
        plant.command(code, False)
        plant.advance()
        acting.append(plant.notch_acting)
    assert acting[19:27] == [100, 100, 100, 200, 200, 100, 100, 100]


def test_speed_reading_is_quantised_noisy_and_scaled() -> None:
    sensors = replace(NOMINAL.sensors, speed_noise_sigma_mps=0.02, wheel_factor=1.005)
    plant = Plant(replace(NOMINAL, sensors=sensors), 5)
    errors, lsb_01mmps = [], sensors.speed_lsb_mps * 1e4
    for _ in range(6000):
        plant.command(500, False)
        plant.advance()
        reading, true = plant.speed_01mmps, plant.true_speed_01mmps
        assert abs(reading / lsb_01mmps - round(reading / lsb_01mmps)) < 0.5 / lsb_01mmps + 1e-9
        if true > 50_000:
            errors.append(reading - 1.005 * true)
    assert len(errors) > 4000
    assert np.mean(errors) == pytest.approx(0.0, abs=200 * 4 / len(errors) ** 0.5)
    assert np.std(errors) == pytest.approx(np.hypot(200, lsb_01mmps / 12**0.5), rel=0.05)


def test_a_standing_axle_reads_zero() -> None:
    sensors = replace(NOMINAL.sensors, speed_noise_sigma_mps=0.5)
    plant = Plant(replace(NOMINAL, sensors=sensors), 5)
    readings = []
    for _ in range(50):
        plant.command(-100, False)
        plant.advance()
        readings.append(plant.speed_01mmps)
    assert readings == [0] * 50
    # In motion the noise shows, and no reading is negative.
    readings = []
    for _ in range(200):
        plant.command(200, False)
        plant.advance()
        readings.append(plant.speed_01mmps)
    assert min(readings) == 0
    assert max(readings) > 5_000


def test_noise_does_not_depend_on_who_reads() -> None:
    often, rarely, other = Plant(NOMINAL, 9), Plant(NOMINAL, 9), Plant(NOMINAL, 10)
    differences = 0
    for tick in range(5000):
        for plant in (often, rarely, other):
            plant.command(400, False)
            plant.advance()
        first = often.speed_01mmps
        assert often.speed_01mmps == first
        if tick % 7 == 0:
            assert rarely.speed_01mmps == first
            differences += other.speed_01mmps != first
    assert differences > 100


def test_odometer_counts_with_the_wheel_factor() -> None:
    sensors = replace(NOMINAL.sensors, wheel_factor=0.995)
    plant = Plant(replace(NOMINAL, sensors=sensors), 0)
    driven(plant, 1500, 3000)
    assert plant.odometer_mm % 10 == 0
    assert plant.odometer_mm == pytest.approx(0.995 * plant.position_01mm / 10, abs=5.1)


def test_balises_report_where_and_when_the_front_passed_them() -> None:
    balises = (
        Balise(7, 0.0, -0.03),
        Balise(2, 30.0, 30.02),
        Balise(3, 30.0, 30.02),
        Balise(1, 90.0, 89.95),
        Balise(9, 5000.0, 5000.0),
    )
    sensors = replace(NOMINAL.sensors, wheel_factor=1.005)
    plant = Plant(replace(NOMINAL, sensors=sensors, line=replace(NOMINAL.line, balises=balises)), 0)
    track: list[tuple[float, float]] = []
    events = plant.drain_events()
    assert [(event.kind, event.instant_01ms, event.position_01mm) for event in events] == [("balise", 0, -300)]
    for _ in range(2500):
        track.append((plant.tick * 100.0, plant.position_01mm))
        events += driven(plant, 900, 1)
    passed = [event for event in events if event.kind == "balise"]
    assert [event.balise.number for event in passed if event.balise] == [7, 2, 3, 1]
    assert [event.odometer_mm for event in passed] == [-30, 30170, 30170, 90400]
    times, positions = np.array(track).T
    for event in passed[1:]:
        assert np.interp(event.position_01mm, positions, times) == pytest.approx(event.instant_01ms, abs=1)


def test_the_balise_at_the_start_is_read_before_the_train_moves() -> None:
    events = Plant(NOMINAL, 0).drain_events()
    assert [(event.balise and event.balise.number, event.instant_01ms, event.odometer_mm) for event in events] == [
        (1, 0, 0)
    ]


def test_a_short_creep_is_not_a_stop() -> None:
    plant = Plant(QUIET, 0)
    events = driven(plant, 200, 60)
    events += driven(plant, -1792, 300)
    assert plant.true_speed_01mmps == 0
    assert 0 < plant.position_01mm < 10_000
    assert [event.kind for event in events if event.kind != "balise"] == ["departed"]
    events = driven(plant, 600, 1000)
    events += driven(plant, -1792, 1000)
    assert [event.kind for event in events] == ["stopped"]
    assert events[0].position_01mm == plant.position_01mm
    assert events[0].instant_01ms < plant.tick * 100


def test_the_stop_is_found_inside_the_tick() -> None:
    plant = Plant(QUIET, 0)
    driven(plant, 900, 1000)
    braked = -1000
    while plant.true_speed_01mmps > 0:
        tick, speed_mps, accel_mps2 = plant.tick, plant.true_speed_01mmps / 1e4, plant.accel_mps2
        position_01mm = plant.position_01mm
        events = driven(plant, braked, 1)
        assert plant.tick < 3000
    assert [event.kind for event in events] == ["stopped"]
    stop_s = speed_mps / -accel_mps2
    assert 0.0 < stop_s < 0.01
    assert events[0].instant_01ms == pytest.approx((tick * 0.01 + stop_s) * 1e4, abs=2)
    assert events[0].position_01mm == pytest.approx(position_01mm + speed_mps * stop_s / 2 * 1e4, abs=2)
    # The next stop is one only when the train has moved again by 1 m.
    first_01mm = plant.position_01mm
    events = driven(plant, 200, 620)
    events += driven(plant, -1792, 300)
    assert 0 < plant.position_01mm - first_01mm < 10_000
    assert events == []
    events = driven(plant, 600, 1200)
    events += driven(plant, -1792, 1000)
    assert [event.kind for event in events] == ["stopped"]


def test_departure_is_reported_at_the_start_position() -> None:
    events = driven(Plant(QUIET, 0), 1000, 300)
    departed = [event for event in events if event.kind == "departed"]
    assert [event.position_01mm for event in departed] == [0]
    # When the loop delay is over and then the actuator, on its way to K u, passes the 2 N/kN of a standing train.
    share = 2.0 * 211 * 9.81 / (1000 / 256 * QUIET.train.force_per_notch_n)
    assert departed[0].instant_01ms == round((0.04 - np.log(1 - share) / 0.34) * 1e4)


def test_forces_and_effort_have_the_sign_of_the_notch() -> None:
    plant = Plant(QUIET, 0)
    driven(plant, 1000, 1000)
    assert plant.traction_n > 100e3
    assert plant.brake_n == 0.0
    assert plant.effort_fraction == pytest.approx(plant.traction_n / 215e3)
    assert plant.accel_mps2 > 0.4
    driven(plant, -1000, 800)
    assert plant.traction_n == 0.0
    assert plant.brake_n > 100e3
    assert plant.effort_fraction == pytest.approx(-plant.brake_n / 270e3)
    assert plant.accel_mps2 < -0.4


def test_acceleration_is_the_derivative_of_the_speed() -> None:
    plant = Plant(QUIET, 0)
    driven(plant, 1700, 1500)
    before, acceleration = plant.true_speed_01mmps, []
    for _ in range(100):
        acceleration.append(plant.accel_mps2)
        driven(plant, 1700, 1)
    assert (plant.true_speed_01mmps - before) / 1e4 == pytest.approx(np.mean(acceleration), abs=2e-3)


def test_same_seed_same_run() -> None:
    def trace(seed: int) -> list[tuple[int, int, int]]:
        plant = Plant(perturb(NOMINAL, seed), seed)
        rows = []
        for tick in range(1500):
            plant.command(700 if tick < 900 else -700, False)
            plant.advance()
            rows.append((plant.speed_01mmps, plant.odometer_mm, plant.position_01mm))
        return rows

    assert trace(4) == trace(4)
    assert trace(4) != trace(5)


def test_a_state_that_is_no_number_is_a_plant_error() -> None:
    broken = replace(NOMINAL, train=replace(NOMINAL.train, davis_a_n_per_kn=float("nan")))
    plant = Plant(broken, 0)
    with pytest.raises(PlantError, match=r"not finite at tick \d+: position"):
        driven(plant, 1000, 100)


def _running(scenario: Scenario = QUIET) -> Plant:
    plant = Plant(scenario, 0)
    driven(plant, 1200, 1000)
    assert plant.traction_n > 100e3
    return plant


@pytest.mark.parametrize(
    ("field", "value", "blocks"),
    [
        ("power_on", False, True),
        ("pantograph_up", False, True),
        ("main_breaker_closed", False, True),
        ("doors_closed_locked", False, True),
        ("parking_brake_released", False, True),
        ("safety_loop_closed", False, True),
        ("brake_available", False, True),
        ("line_voltage_percent", 66.6, True),
        ("line_voltage_percent", 66.7, False),
        ("fault", 3, False),
    ],
)
def test_interlocks_take_the_traction_away_at_once(field: str, value: float, blocks: bool) -> None:
    plant = _running()
    setattr(plant.status, field, value)
    assert plant.status.traction_enabled is not blocks
    driven(plant, 1200, 1)
    assert (plant.traction_n == 0.0) is blocks
    assert (plant.notch_acting == 0) is blocks
    if field != "safety_loop_closed":
        plant.status = TrainStatus()
        driven(plant, 1200, 5)
        # Traction comes back, through the lag of the actuator.
        assert plant.traction_n > 0.0
        assert (plant.traction_n < 20e3) is blocks


def test_an_open_safety_loop_is_an_emergency_for_good() -> None:
    plant = _running()
    plant.status.safety_loop_closed = False
    events = driven(plant, 1200, 1)
    assert [event.kind for event in events] == ["emergency"]
    assert plant.brake_n == 270e3
    plant.status.safety_loop_closed = True
    driven(plant, 1200, 2000)
    assert plant.true_speed_01mmps == 0
    assert plant.brake_n == 270e3


@pytest.mark.parametrize(("grade", "holds"), [(-39.0, True), (-45.0, False)])
def test_the_parking_brake_holds_on_its_grade(grade: float, holds: bool) -> None:
    plant = Plant(replace(QUIET, line=replace(QUIET.line, grade_permil=((0.0, grade),))), 0)
    plant.status.parking_brake_released = False
    driven(plant, 1000, 200)
    assert (plant.true_speed_01mmps == 0) is holds
    plant.status.parking_brake_released = True
    driven(plant, 0, 100)
    assert plant.true_speed_01mmps > 0
