"""The high-speed train without a bus: dynamics, surroundings, wayside, faults."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest

from railhil.faults.language import parse
from railhil.faults.words import CLEAR, words_at
from railhil.plant_sim.high_speed import train as train_module
from railhil.plant_sim.high_speed.dynamics import (
    Coupler,
    Grades,
    UnitLimits,
    UnitMotion,
    coupler_n,
    drive,
    moved,
    resistance_of,
)
from railhil.plant_sim.high_speed.faults import FaultyHighSpeedPlant
from railhil.plant_sim.high_speed.plant import HighSpeedPlant
from railhil.plant_sim.high_speed.surroundings import Wind, drawn_grades
from railhil.plant_sim.high_speed.train import HighSpeedTrain, PowerUnit, UnitData, Wayside
from railhil.plant_sim.high_speed.watch import UnitWatch
from railhil.scenarios.load import load_any
from railhil.scenarios.system import system_named
from railhil.systems.high_speed import HST1
from railhil.systems.high_speed.target import emergency_curve, journey_curve
from railhil.systems.high_speed.task import CouplerTable
from railhil.wire.high_speed import UnitCause, UnitLevel
from railhil.wire.power_units import SAFE

SCENARIO: Any = load_any("hst_short")
TASK = SCENARIO.task
TICK_S = 0.04
FLAT = Grades((0.0,), (0.0,), (0.0,))
STANDING = UnitMotion(0.0, 0.0, 0.0, 0.0)


def still_air(**changed: Any) -> Any:
    """The task without grades, wind and noise."""
    return TASK.model_copy(update={"gradient_permil": 0.0, "wind_sigma_mps2": 0.0, "noise_sigma_mps": 0.0, **changed})


def faulty(*texts: str, task: Any = None) -> FaultyHighSpeedPlant:
    scenario = replace(SCENARIO, task=task or still_air())
    return FaultyHighSpeedPlant(scenario, 0, False, 0.0, [(n, parse(text)) for n, text in enumerate(texts, 1)])


def driven(plant: HighSpeedPlant, command_mps2: float, seconds: float) -> float:
    """The speed after some time under a command that is sent at each tick."""
    kind: Any = plant._wire.commands[0]
    for _ in range(round(seconds / TICK_S)):
        plant.take(kind(round(command_mps2 * 1000), life=plant.next_life("command")))
        plant.advance()
    return plant.train.speed_mps


# -- dynamics ---------------------------------------------------------------------------------------------------------


def test_half_the_step_moves_the_speed_by_less_than_a_hundredth_of_a_millimetre_per_second() -> None:
    limits = UnitLimits(0.55, 1.3, 21.16, 0.0052, 0.000137, 0.0000145)
    grades = drawn_grades(3, 4.0, (1000.0, 4000.0), 286_000.0, 203.0)
    found = []
    for step_s in (0.01, 0.005):
        now = UnitMotion(0.0, 40.0, 0.0, 0.0)
        side = drive(0.9, 0.4, step_s)
        for step in range(round(240.0 / step_s)):
            command = 0.5 if step * step_s < 120.0 else -0.3
            now = moved(limits, side, grades, now, command, 0.0, step_s)
        found.append(now.speed_mps)
    assert found[0] == pytest.approx(found[1], abs=1e-5)


def test_the_lag_is_that_of_the_equation() -> None:
    """Free of resistance: v = u (t - tau (1 - exp(-t / tau)))."""
    limits = UnitLimits(0.55, 1.3, 1e9, 0.0, 0.0, 0.0)
    now, side = STANDING, drive(1.0, 0.4, 0.01)
    for _ in range(100):
        now = moved(limits, side, FLAT, now, 0.5, 0.0, 0.01)
    assert now.speed_mps == pytest.approx(0.5 * (1.0 - 0.4 * (1.0 - 2.718281828459045**-2.5)), abs=1e-9)


def test_power_limits_the_traction_and_nothing_more_than_all_the_braking() -> None:
    limits = UnitLimits(0.55, 1.3, 21.16, 0.0, 0.0, 0.0)
    side = drive(1.0, 0.4, 0.01)
    for command, steady in ((2.0, 21.16 / 80.0), (-2.0, -1.3)):
        now = UnitMotion(0.0, 80.0, 0.0, 0.0)
        for _ in range(300):
            now = moved(limits, side, FLAT, now, command, 0.0, 0.01)._replace(speed_mps=80.0, accel_mps2=0.0)
        assert now.drive_mps2 == pytest.approx(steady, rel=1e-3)


def test_a_standing_train_is_held_and_never_rolls_back() -> None:
    limits = UnitLimits(0.55, 1.3, 21.16, 0.0052, 0.0, 0.0)
    side, hill = drive(1.0, 0.4, 0.01), Grades((0.0,), (20.0,), (0.0,))
    now = moved(limits, side, hill, STANDING, 0.0, -0.1, 0.01)
    assert (now.speed_mps, now.position_m) == (0.0, 0.0)
    rolling = UnitMotion(5.0, 0.001, 0.0, 0.0)
    assert moved(limits, side, hill, rolling, 0.0, 0.0, 0.01).speed_mps == 0.0


def test_traction_and_braking_have_delays_of_their_own_and_add() -> None:
    unit = PowerUnit(UnitData(1.0, 0.4, 0.5, 1.0), STANDING, 0.0)
    sent = [0.3] * 200 + [-0.2] * 200
    acting = [unit.acting_mps2(step, command) for step, command in enumerate(sent)]
    assert acting[49:51] == [0.0, 0.3]
    # The traction ends half a second after the change, the braking begins a second after it: a gap.
    assert acting[249:251] == [0.3, 0.0]
    assert acting[299:301] == [0.0, -0.2]
    back = [unit.acting_mps2(400 + step, 0.3) for step in range(200)]
    assert back[60] == pytest.approx(0.3 - 0.2)


def test_an_emergency_profile_is_told_for_the_instant_at_which_it_is_read() -> None:
    """A trigger can be at any tick; from then on the instants of the telegrams are not those of the curve's grid."""
    task: Any = load_any("jinan_xuzhou_emergency").task
    wayside = Wayside(task, TICK_S)
    assert wayside.look(1934, 210_000.0)
    for tick in (1935, 1940, 1945, 3000, 4335):
        told = wayside.preview_raw(tick)
        assert len(told) == 15
        for j, raw in enumerate(told):
            at_s = (tick - 1934) * TICK_S + 0.25 * j
            assert abs(raw / 360 - wayside._curve.speed_mps(at_s)) <= 0.5001 / 360, (tick, j)


def test_a_run_under_way_begins_in_balance() -> None:
    task = still_air(start_s=1500.0)
    train = HighSpeedTrain(task, 0, TICK_S)
    before = train.speed_mps
    for _ in range(25):
        train.advance()
    assert before == pytest.approx(journey_curve(task).speed_mps(1500.0))
    assert train.speed_mps == pytest.approx(before, abs=1e-3)
    assert train.commands_mps2[0] == pytest.approx(resistance_of(train.limits, before), abs=1e-6)


def test_surroundings_are_those_of_the_seed() -> None:
    assert drawn_grades(1, 4.0, (1000.0, 4000.0), 286_000.0, 203.0) == drawn_grades(
        1, 4.0, (1000.0, 4000.0), 286_000.0, 203.0
    )
    permil = drawn_grades(2, 4.0, (1000.0, 4000.0), 286_000.0, 203.0).permil
    assert 3.0 < max(permil) <= 4.0
    assert -4.0 <= min(permil) < -3.0
    wind = Wind(1, 0.01, 20.0, TICK_S)
    values = []
    for _ in range(200_000):
        wind.step()
        values.append(wind.accel_mps2)
    mean_square = sum(value * value for value in values) / len(values)
    assert mean_square**0.5 == pytest.approx(0.01, rel=0.1)


# -- target curve and wayside -----------------------------------------------------------------------------------------


def test_the_curve_is_that_of_the_papers() -> None:
    """286 km in 3757 s, the restriction, coasting down to 270 km/h, jerk of at most 0.075 m/s3."""
    curve = journey_curve(load_any("jinan_xuzhou").task)  # type: ignore[union-attr]
    assert curve.length_m == pytest.approx(286_000.0, abs=0.01)
    assert curve.duration_s == pytest.approx(3757.0, abs=1.0)
    kmh = [speed * 3.6 for speed in curve.speeds_mps]
    assert max(kmh) == pytest.approx(300.0)
    at = {km: curve.speeds_mps[bisect_left(curve.positions_m, km * 1000.0)] * 3.6 for km in (90, 120, 170, 200)}
    assert at == pytest.approx({90: 250.0, 120: 300.0, 170: 270.0, 200: 300.0})
    accel = [(after - before) / 0.05 for before, after in pairwise(curve.speeds_mps)]
    jerk = [(after - before) / 0.05 for before, after in pairwise(accel)]
    assert max(map(abs, jerk)) < 0.0752
    assert min(accel) > -0.401


def test_the_emergency_profile_has_the_distance_of_the_specification() -> None:
    emergency = load_any("jinan_xuzhou_emergency").task.emergency  # type: ignore[union-attr]
    assert emergency_curve(emergency, 300.0 / 3.6).length_m == pytest.approx(4390.9, abs=0.5)


def test_the_wayside_shows_the_normal_future_until_the_trigger() -> None:
    task = still_air(emergency=load_any("jinan_xuzhou_emergency").task.emergency, start_s=2700.0)  # type: ignore[union-attr]
    wayside = Wayside(task, TICK_S)
    assert set(wayside.preview_raw(0)) == {30_000}
    assert not wayside.look(10, 209_999.0)
    assert wayside.look(11, 210_000.0)
    assert not wayside.look(12, 210_003.0)
    now, *ahead = wayside.preview_raw(11)
    assert now == 30_000
    # 0.31 m/s lower after the second in which the deceleration builds up.
    assert ahead[3] == pytest.approx(30_000 - 0.31 * 360, abs=2)
    assert all(later < sooner for sooner, later in pairwise(ahead))


# -- mutations and other faults ---------------------------------------------------------------------------------------


def test_a_plant_whose_faults_are_not_active_is_the_plant_without_faults() -> None:
    texts = []
    for place in HST1.injects:
        for word in words_at(*place.split("."), ""):
            if word.name != CLEAR:
                values = " ".join("2" if one.usual is None else "" for one in word.parameters)
                texts.append(f"{place} {word.name} {values} @9000s combine")
    plant = HighSpeedPlant(SCENARIO, 3, False, 0.0)
    other = FaultyHighSpeedPlant(SCENARIO, 3, False, 0.0, [(n, parse(text)) for n, text in enumerate(texts, 1)])
    assert driven(plant, 0.4, 10.0) == driven(other, 0.4, 10.0)
    assert plant._feedback(0) == other._feedback(0)


@pytest.mark.parametrize(
    ("text", "data"),
    [
        ("train.gain scale 0.7 @1s for 2s", UnitData(0.7, 0.4, 0.5, 1.0)),
        ("train.lag scale 2 @1s for 2s", UnitData(1.0, 0.8, 0.5, 1.0)),
        ("train.delay longer 500ms @1s for 2s", UnitData(1.0, 0.4, 1.0, 1.5)),
    ],
)
def test_a_mutation_lasts_its_time_and_is_told_to_the_record_only(text: str, data: UnitData) -> None:
    plant = faulty(text)
    normal = plant.train.units[0].data
    driven(plant, 0.3, 2.0)
    assert plant.train.units[0].data == pytest.approx(data)
    told: Any = plant._mutation()
    assert [told.gain, told.lag, told.traction_delay, told.braking_delay] == [round(x * 1000) for x in data]
    driven(plant, 0.3, 2.0)
    assert plant.train.units[0].data == normal
    assert [hit.fault for hit in plant.injections.log.hits] == [1]


@pytest.mark.parametrize(
    ("text", "command_mps2", "steady_mps2"),
    [
        ("train.gain scale 0.7 @0s", 0.2, 0.14),
        ("actuator.traction weak 50% @0s", 0.3, 0.15),
        ("actuator.traction off @0s", 0.3, 0.0),
        ("actuator.traction full @0s", 0.0, 21.16 / 80.0),
        ("actuator.brake scale 0.5 @0s", -0.4, -0.2),
        ("actuator.brake off @0s", -0.4, 0.0),
        ("actuator.brake full @0s", 0.0, -1.3),
        ("actuator.brake stuck @6s", 0.2, 0.2),
    ],
)
def test_what_a_fault_makes_of_the_drive(text: str, command_mps2: float, steady_mps2: float) -> None:
    plant = faulty(text, task=still_air(start_s=1500.0))
    driven(plant, command_mps2, 8.0)
    assert plant.train.drive_mps2 == pytest.approx(steady_mps2, rel=0.06, abs=1e-3)


def test_a_slow_brake_and_one_with_a_dead_time_act_later() -> None:
    task = still_air(start_s=1500.0)
    faults = ((), ("actuator.brake slow 0.2 @0s",), ("actuator.brake dead_time 1s @0s",))
    speeds = [driven(faulty(*texts, task=task), -0.5, 4.0) for texts in faults]
    assert speeds[1] > speeds[0] + 0.3
    assert speeds[2] == pytest.approx(speeds[0] + 0.5, abs=0.02)


@pytest.mark.parametrize(
    "texts",
    [
        ("actuator.traction dead_time 12s @0s",),
        ("actuator.traction dead_time 7s @0s", "train.delay longer 5s @0s combine"),
    ],
)
def test_commands_may_be_delayed_by_more_than_ten_seconds(texts: tuple[str, ...]) -> None:
    plant = faulty(*texts)
    assert driven(plant, 0.3, 12.4) == 0.0
    assert driven(plant, 0.3, 3.0) == pytest.approx(driven(faulty(), 0.3, 3.4), abs=0.02)


def test_an_open_safety_loop_keeps_a_brake_that_does_not_answer_applied() -> None:
    plant = faulty("train.safety_loop off @1s", "actuator.brake weak 30% @1s", task=still_air(start_s=1500.0))
    driven(plant, 0.1, 10.0)
    assert (plant.watches[0].level, plant.watches[0].cause) == (
        UnitLevel.TRACTION_CUT, UnitCause.BRAKE_NOT_ANSWERING,
    )  # fmt: skip
    assert plant.train.drive_mps2 == pytest.approx(-0.3 * 1.3, rel=0.01)


def test_an_open_safety_loop_brakes_all_units_for_good() -> None:
    plant = faulty("train.safety_loop off @2s for 1s")
    assert driven(plant, 0.5, 2.0) > 0.5
    driven(plant, 0.5, 10.0)
    assert plant.train.speed_mps == 0.0
    assert plant.train.commands_mps2 == [-plant.train.limits.braking_mps2]
    assert (plant.watches[0].level, plant.watches[0].cause) == (UnitLevel.SERVICE_BRAKE, UnitCause.NONE)


def test_a_sensor_that_is_off_says_so() -> None:
    plant = faulty("sensor.speed off @1s")
    driven(plant, 0.3, 2.0)
    told: Any = plant._feedback(0)
    assert (told.speed, told.check) == (0, 0)


def test_places_of_the_system_are_in_the_language() -> None:
    assert all(words_at(*place.split("."), "") for place in system_named("hst1").injects)
    assert train_module.STEP_S == 0.01


# -- three units ------------------------------------------------------------------------------------------------------


def three(**coupler: float) -> HighSpeedTrain:
    """Three units in still air at 300 km/h, with or without couplers, the leading one under traction for 10 s."""
    table = CouplerTable(**coupler) if coupler else None
    changed = {"gradient_permil": 0.0, "wind_sigma_mps2": 0.0, "coupler": table, "start_s": 1500.0}
    task: Any = load_any("emu3_short").task.model_copy(update=changed)  # type: ignore[union-attr]
    train = HighSpeedTrain(task, 0, TICK_S)
    for _ in range(250):
        train.commands_mps2 = [0.2, 0.0, 0.0]
        train.advance()
    return train


def test_free_units_know_nothing_of_each_other() -> None:
    train = three()
    speeds = [unit.motion.speed_mps for unit in train.units]
    assert speeds[0] - speeds[2] > 0.5
    assert speeds[1] < speeds[2]
    assert train.couplers_n == [0.0, 0.0]


def test_couplers_share_the_force_by_mass() -> None:
    """The leading unit has 3/8 of the mass: it hands on 5/8 of its force, and the last one needs 3/8 of it."""
    train = three(stiffness_kn_per_m=5000.0, damping_kn_per_mps=200.0)
    force_n = 160_500 * 1.06 * 0.2
    assert train.couplers_n == pytest.approx([force_n * 5 / 8, force_n * 3 / 8], rel=0.01)
    speeds = [unit.motion.speed_mps for unit in train.units]
    assert max(speeds) - min(speeds) < 0.001


def test_a_coupler_has_no_force_within_its_slack() -> None:
    coupler = Coupler(5e6, 2e5, 0.01)
    rear = UnitMotion(0.0, 10.0, 0.0, 0.0)
    assert coupler_n(coupler, rear._replace(position_m=0.009), rear, 0.01) == 0.0
    assert coupler_n(coupler, rear._replace(position_m=0.012), rear, 0.01) == pytest.approx(1e4)
    assert coupler_n(coupler, rear._replace(position_m=-0.012), rear, 0.01) == pytest.approx(-1e4)


# -- the watch of a unit ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("policy", "level", "accel_mps2"),
    [("coast", UnitLevel.TRACTION_CUT, 0.0), ("brake", UnitLevel.SERVICE_BRAKE, -0.5)],
)
def test_a_unit_without_commands_acts_by_itself(policy: str, level: UnitLevel, accel_mps2: float) -> None:
    plant = HighSpeedPlant(replace(SCENARIO, task=still_air(stale_command=policy)), 0, False, 0.0)
    driven(plant, 0.3, 2.0)
    (watch,) = plant.watches
    plant.advance()
    plant.advance()
    assert watch.level is UnitLevel.NORMAL
    plant.advance()
    assert (watch.level, watch.cause) == (level, UnitCause.COMMAND_AGE)
    assert plant.train.commands_mps2 == [accel_mps2]
    driven(plant, 0.3, TICK_S)
    assert (watch.level, watch.cause) == (UnitLevel.NORMAL, UnitCause.NONE)
    assert plant.train.commands_mps2 == [0.3]


def test_a_controller_without_readings_has_the_same_reaction() -> None:
    watch = UnitWatch(3, (UnitLevel.SERVICE_BRAKE, -0.5), TICK_S, 0.4)
    assert watch.command(0, 0.3, 0) == 0.3
    assert watch.command(1, 0.0, SAFE) == -0.5
    assert (watch.level, watch.cause) == (UnitLevel.SERVICE_BRAKE, UnitCause.CONTROLLER_SAFE)
    assert watch.command(2, 0.2, 0) == 0.2


def test_a_brake_that_does_not_answer_is_given_up() -> None:
    watch = UnitWatch(3, (UnitLevel.TRACTION_CUT, 0.0), TICK_S, 0.4)
    given = []
    for tick in range(100):
        watch.command(tick, -0.5, 2)
        given.append(watch.look(tick, -0.5, -0.05))
    assert given.count(0.0) == 1
    assert 2.0 <= given.index(0.0) * TICK_S < 2.4
    assert watch.cause is UnitCause.BRAKE_NOT_ANSWERING
    assert watch.command(100, 0.3, 0) is None


def test_a_brake_with_a_gain_of_seven_tenths_answers() -> None:
    plant = faulty("train.gain scale 0.7 @0s", "train.lag scale 2 @0s", task=still_air(start_s=1500.0))
    driven(plant, -0.8, 20.0)
    assert plant.watches[0].level is UnitLevel.NORMAL
