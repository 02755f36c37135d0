"""One step of the dynamics against closed forms, at each of its branches.

Trains here have a resistance that does not depend on the speed, or only a great part that does: then the step is exact.
"""

from __future__ import annotations

from dataclasses import replace
from math import exp, inf, log
from typing import Any

import numpy as np
import pytest

from railhil.plant_sim.ato import dynamics, force_tables, forces
from railhil.plant_sim.ato.dynamics import FREE, Motion, Step, Window
from railhil.plant_sim.ato.forces import EffortLimit, GradeTable, TrainConstants
from railhil.scenarios.load import load
from railhil.scenarios.profiles import grade_rows
from railhil.systems.ato.scenario.model import Effort

LEVEL = GradeTable((0.0,), (0.0,), (0.0,))
WIDE = EffortLimit(1e9, inf, (), ())
#: 1 t, 50 N of resistance, a pole of 2 per s.
TRAIN = TrainConstants(1000.0, 50.0, 0.0, 0.0, 9.81, 2.0, WIDE, WIDE)
#: Resistance that grows by 1 kN per m/s.
VISCOUS = TRAIN._replace(resistance_b_n_per_mps=1000.0)
STEP_S = 0.1
LAG = dynamics.lag(2.0, STEP_S)


def stepped(motion: Motion, steady_n: float, train: TrainConstants = TRAIN, window: Window = FREE) -> Step:
    return dynamics.step(train, LEVEL, window, motion, steady_n, LAG)


def actuator(first_n: float, steady_n: float, seconds: float) -> tuple[float, float]:
    """Force after a time, and its mean: from the integral of the exponential."""
    last_n = steady_n + (first_n - steady_n) * exp(-2.0 * seconds)
    return last_n, steady_n + (first_n - last_n) / (2.0 * seconds)


# -- tables -----------------------------------------------------------------------------------------------------------


def test_grade_before_between_and_after_its_rows() -> None:
    table = GradeTable((10.0, 20.0, 30.0), (1.0, 3.0, -5.0), (0.2, -0.8, 0.5))
    for front_m, permil in ((0.0, 1.0), (9.99, 1.0), (10.0, 1.0), (15.0, 2.0), (20.0, 3.0), (25.0, -1.0), (40.0, 0.0)):
        assert forces.mean_grade_permil(table, front_m) == pytest.approx(permil)


def test_limit_where_force_and_power_meet_and_at_the_rows_of_a_curve() -> None:
    limit = EffortLimit(100.0, 500.0, (2.0, 4.0), (90.0, 50.0))
    for speed_mps, force_n in ((0.0, 90.0), (2.0, 90.0), (3.0, 70.0), (4.0, 50.0), (10.0, 50.0), (12.5, 40.0)):
        assert forces.effort_limit_n(limit, speed_mps) == pytest.approx(force_n)
    assert forces.effort_limit_n(limit._replace(curve_mps=(), curve_n=()), 5.0) == 100.0
    assert forces.effort_limit_n(WIDE, 50.0) == 1e9


def test_constants_of_a_train() -> None:
    train = replace(
        load("lvshun_tieshan").train, mass_kg=200_000.0, gravity_mps2=10.0, davis_a_n_per_kn=2.0,
        davis_b_n_per_kn_kmh=0.01, davis_c_n_per_kn_kmh2=0.001, actuator_pole_per_s=2.5,
        traction=Effort(300e3, None, ()), brake=Effort(200e3, 2e6, ((1.0, 5e3), (2.0, 4e3))),
    )  # fmt: skip
    found = force_tables.train_constants(train)
    assert found.mass_kg == train.inertial_mass_kg
    assert found[1:5] == pytest.approx((4000.0, 2000 * 0.036, 2000 * 0.01296, 2000.0))
    assert (found.pole_per_s, found.traction) == (2.5, EffortLimit(300e3, inf, (), ()))
    assert found.brake == EffortLimit(200e3, 2e6, (1.0, 2.0), (5e3, 4e3))


def test_grade_tables_of_many_runs() -> None:
    """The arrays of two runs are those of each."""
    both = (0.0, np.array([1.0, 2.0])), (100.0, np.array([-3.0, 4.0]))
    from_m, permil, slope = grade_rows(both, 40.0)
    for run in (0, 1):
        table = force_tables.grade_table(tuple((at, float(values[run])) for at, values in both), 40.0)
        assert (tuple(from_m), tuple(permil[run]), tuple(slope[run])) == tuple(table)
        assert table.permil_per_m[-1] == 0.0
        reached = permil[run, :-1] + slope[run, :-1] * np.diff(from_m)
        assert reached.tolist() == pytest.approx(permil[run, 1:].tolist())
        assert len(table.from_m) == len(table.permil) == len(table.permil_per_m)


# -- forces -----------------------------------------------------------------------------------------------------------


def test_bounds_of_the_force() -> None:
    train = TRAIN._replace(traction=EffortLimit(500.0, 1000.0, (), ()), brake=EffortLimit(700.0, 2100.0, (), ()))
    assert dynamics.force_bounds_n(train, FREE, 1.0) == (-700.0, 500.0)
    assert dynamics.force_bounds_n(train, FREE, 5.0) == (-420.0, 200.0)
    assert dynamics.force_bounds_n(train, Window(False, 0.0), 1.0) == (-700.0, 0.0)
    for traction in (False, True):
        assert dynamics.force_bounds_n(train, Window(traction, 0.25), 1.0) == (-700.0, -0.25)
        assert dynamics.force_bounds_n(train, Window(traction, inf), 1.0) == (-700.0, -700.0)


@pytest.mark.parametrize("force_n", [-6.0, 6.0])
def test_a_force_that_begins_or_ends_at_its_bound_is_not_clipped(force_n: float) -> None:
    """The mean of the exponential, not that of a line."""
    assert dynamics.clipped_mean_n(force_n, 2.0, 1.25, -6.0, 6.0) == 1.25
    assert dynamics.clipped_mean_n(2.0, force_n, 1.25, -6.0, 6.0) == 1.25


def test_acceleration_at_an_instant() -> None:
    def found(speed_mps: float, force_n: float) -> float:
        return dynamics.acceleration_mps2(TRAIN, LEVEL, FREE, Motion(3.0, speed_mps, force_n, 9.0))

    assert found(0.3, -150.0) == pytest.approx(-0.2)
    assert found(0.3, 50.0) == 0.0
    assert [found(0.0, force_n) for force_n in (-150.0, 0.0, 50.0)] == [0.0, 0.0, 0.0]
    assert found(0.0, 50.25) == pytest.approx(0.00025)
    assert Motion(0.0, 0.0, 0.0, 0.0) == dynamics.AT_REST
    assert Window(True, 0.0) == FREE


# -- a moving train ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("speed_mps", "first_n", "steady_n"), [(3.0, 400.0, -900.0), (0.5, -200.0, 800.0)])
def test_a_step_under_way(speed_mps: float, first_n: float, steady_n: float) -> None:
    last_n, mean_n = actuator(first_n, steady_n, STEP_S)
    accel = (mean_n - 50.0) / 1000
    after_mps = speed_mps + accel * STEP_S
    found = stepped(Motion(7.0, speed_mps, first_n, 5.0), steady_n)
    assert found.motion == pytest.approx((7.0 + (speed_mps + after_mps) / 2 * STEP_S, after_mps, last_n, accel))
    assert (found.moving_from_s, found.moving_to_s) == (0.0, STEP_S)


def test_resistance_and_grade_at_the_midpoint() -> None:
    grades = GradeTable((0.0,), (0.0,), (2.0,))
    found = dynamics.step(VISCOUS, grades, FREE, Motion(1.0, 2.0, 300.0, -4.0), 300.0, LAG)
    middle_mps, middle_m = 2.0 - 4.0 * 0.05, 1.0 + 2.0 * 0.05
    accel = (300.0 - 50.0 - 1000.0 * middle_mps - 9.81 * 2.0 * middle_m) / 1000
    assert found.motion.accel_mps2 == pytest.approx(accel)


def test_a_predicted_midpoint_is_never_backwards() -> None:
    """From 10 mm/s with 3 m/s2 predicted the midpoint lies at rest: no resistance from the speed."""
    found = stepped(Motion(0.0, 0.01, 600.0, -3.0), 600.0, VISCOUS)
    assert found.motion.accel_mps2 == pytest.approx(0.55)


@pytest.mark.parametrize(
    ("first_n", "steady_n"), [(150.0, 900.0), (320.0, -900.0), (-150.0, -900.0), (-320.0, 900.0), (900.0, 900.0)]
)
def test_a_force_that_crosses_its_limit(first_n: float, steady_n: float) -> None:
    """The mean of the clipped force, taken as linear in time; that of the unclipped force is far from it."""
    limit = EffortLimit(250.0, inf, (), ())
    train = TRAIN._replace(traction=limit, brake=limit)
    last_n, plain_n = actuator(first_n, steady_n, STEP_S)
    shares = (np.arange(100_000) + 0.5) / 100_000
    expected_n = float(np.clip(first_n + (last_n - first_n) * shares, -250.0, 250.0).mean())
    found = stepped(Motion(0.0, 5.0, first_n, 0.0), steady_n, train)
    assert found.motion.accel_mps2 * 1000 + 50 == pytest.approx(expected_n, abs=0.01)
    assert abs(plain_n - expected_n) > 0.5


# -- to rest ----------------------------------------------------------------------------------------------------------


def stop_s(speed_mps: float, first_n: float, steady_n: float) -> float:
    """Instant of the stop by bisection on the exact speed."""
    low, high = 0.0, STEP_S
    for _ in range(60):
        middle = (low + high) / 2
        _, mean_n = actuator(first_n, steady_n, middle)
        low, high = (middle, high) if speed_mps + (mean_n - 50.0) / 1000 * middle > 0 else (low, middle)
    return low


@pytest.mark.parametrize("speed_mps", [0.001, 0.02, 0.05])
def test_stop_while_the_brake_builds_up(speed_mps: float) -> None:
    due_s = stop_s(speed_mps, -300.0, -2000.0)
    found = stepped(Motion(7.0, speed_mps, -300.0, 0.0), -2000.0)
    last_n, _ = actuator(-300.0, -2000.0, STEP_S)
    assert found.moving_from_s == 0.0
    assert found.moving_to_s == pytest.approx(due_s, rel=0.03)
    assert found.motion == pytest.approx((7.0 + speed_mps * found.moving_to_s / 2, 0.0, last_n, 0.0), rel=1e-12)


def test_a_stop_is_inside_the_step_though_the_force_is_still_positive_at_its_first_estimate() -> None:
    found = stepped(Motion(7.0, 1e-6, 300.0, 0.0), -60_000.0)
    assert 0.0 < found.moving_to_s <= STEP_S
    assert found.motion.position_m == pytest.approx(7.0)
    assert (found.motion.speed_mps, found.motion.accel_mps2) == (0.0, 0.0)


def test_a_stop_at_the_very_end_of_a_step() -> None:
    found = stepped(Motion(7.0, 0.125, -1200.0, 0.0), -1200.0)
    assert found == Step(Motion(7.0 + 0.125 * 0.5 * STEP_S, 0.0, -1200.0, 0.0), 0.0, STEP_S)


def test_a_limit_that_the_force_reaches_after_the_stop() -> None:
    train = TRAIN._replace(brake=EffortLimit(450.0, inf, (), ()))
    found = stepped(Motion(7.0, 0.008, -300.0, 0.0), -2000.0, train)
    assert found.moving_to_s == pytest.approx(stop_s(0.008, -300.0, -2000.0), rel=0.03)


def test_a_standing_train_whose_force_falls_again_at_once() -> None:
    found = stepped(Motion(7.0, 0.0, 60.0, 0.0), -2000.0)
    last_n, _ = actuator(60.0, -2000.0, STEP_S)
    assert found == Step(Motion(7.0, 0.0, pytest.approx(last_n), 0.0), 0.0, STEP_S)  # type: ignore[arg-type]


# -- from rest --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("first_n", [-300.0, 0.0, 40.0])
@pytest.mark.parametrize("train", [TRAIN, VISCOUS])
def test_departure(first_n: float, train: TrainConstants) -> None:
    steady_n = 2000.0
    waiting_s = log((first_n - steady_n) / (50.0 - steady_n)) / 2.0
    moving_s = STEP_S - waiting_s
    last_n, mean_n = actuator(50.0, steady_n, moving_s)
    # The midpoint is predicted at rest: the resistance there is that of a standing train.
    accel = (mean_n - 50.0) / 1000
    found = stepped(Motion(7.0, 0.0, first_n, 0.0), steady_n, train)
    expected = (7.0 + accel * moving_s**2 / 2, accel * moving_s, last_n, accel)
    assert found.motion == pytest.approx(expected, rel=1e-9)
    assert found.motion.position_m - 7.0 == pytest.approx(accel * moving_s**2 / 2, rel=1e-6)
    assert (found.moving_from_s, found.moving_to_s) == (pytest.approx(waiting_s), STEP_S)


@pytest.mark.parametrize(
    ("first_n", "steady_n", "window"),
    [
        # Braked; without a notch; a notch below the resistance, with what it builds up, and exactly at it.
        (-900.0, -900.0, FREE), (0.0, 0.0, FREE), (0.0, 30.0, FREE), (10.0, 40.0, FREE), (50.0, 50.0, FREE),
        (0.0, 51.0, FREE), (900.0, 900.0, Window(False, 0.0)), (900.0, 900.0, Window(True, 10.0)),
    ],
)  # fmt: skip
def test_a_train_that_stays(first_n: float, steady_n: float, window: Window) -> None:
    found = stepped(Motion(7.0, 0.0, first_n, 0.0), steady_n, window=window)
    last_n, _ = actuator(first_n, steady_n, STEP_S)
    assert found == Step(Motion(7.0, 0.0, pytest.approx(last_n), 0.0), STEP_S, STEP_S)  # type: ignore[arg-type]


def test_departure_under_the_limit_at_rest() -> None:
    """A traction curve that begins at 30 N holds the train, whatever it allows a little faster."""
    curve: Any = EffortLimit(1e9, inf, (0.0, 0.5), (30.0, 1e6))
    assert stepped(Motion(7.0, 0.0, 0.0, 0.0), 2000.0, TRAIN._replace(traction=curve)).moving_from_s == STEP_S


def test_a_train_already_beyond_its_resistance_departs_at_once() -> None:
    last_n, mean_n = actuator(80.0, 400.0, STEP_S)
    found = stepped(Motion(7.0, 0.0, 80.0, 0.0), 400.0)
    accel = (mean_n - 50.0) / 1000
    assert found.motion == pytest.approx((7.0 + accel * STEP_S**2 / 2, accel * STEP_S, last_n, accel))
    assert (found.moving_from_s, found.moving_to_s) == (0.0, STEP_S)
