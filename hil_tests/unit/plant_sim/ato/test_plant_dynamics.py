"""Longitudinal dynamics: forces, grade under the train, one step, and a whole run against an independent solver."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import exp, inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.plant_sim.ato import dynamics, force_tables, forces
from railhil.plant_sim.ato.dynamics import FREE, Motion, Window
from railhil.scenarios.load import load
from railhil.scenarios.profiles import Profile
from railhil.systems.ato.scenario.model import Effort, Train

TICK_S = 0.01
TRAIN = load("lvshun_tieshan").train
#: No resistance, and an actuator fast enough to count as immediate.
FRICTIONLESS = replace(
    TRAIN, davis_a_n_per_kn=0.0, davis_b_n_per_kn_kmh=0.0, davis_c_n_per_kn_kmh2=0.0, actuator_pole_per_s=1e9
)
LEVEL: Profile = ((0.0, 0.0),)


def stepped(
    train: Train,
    motion: Motion,
    steady_n: float,
    *,
    grade: Profile = LEVEL,
    window: Window = FREE,
    step_s: float = TICK_S,
) -> dynamics.Step:
    constants = force_tables.train_constants(train)
    grades = force_tables.grade_table(grade, train.length_m)
    return dynamics.step(constants, grades, window, motion, steady_n, dynamics.lag(train.actuator_pole_per_s, step_s))


def overlap_mean(profile: Profile, low: float, high: float) -> float:
    """Mean of a step profile by adding up the overlap with each of its rows."""
    ends = [row[0] for row in profile[1:]] + [inf]
    starts = [-inf] + [row[0] for row in profile[1:]]
    total = sum(
        value * max(0.0, min(high, end) - max(low, start))
        for (_, value), start, end in zip(profile, starts, ends, strict=True)
    )
    return total / (high - low)


profiles = st.lists(
    st.tuples(st.floats(-300, 3000), st.floats(-40, 40)), min_size=1, max_size=8, unique_by=lambda row: round(row[0], 2)
).map(lambda rows: tuple(sorted(rows)))


@given(profile=profiles, length_m=st.floats(1, 400), front_m=st.floats(-500, 4000))
def test_grade_is_the_mean_over_the_train(profile: Profile, length_m: float, front_m: float) -> None:
    table = force_tables.grade_table(profile, length_m)
    expected = overlap_mean(profile, front_m - length_m, front_m)
    assert forces.mean_grade_permil(table, front_m) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(
    ("speed_mps", "force_n"),
    [(0.0, 215e3), (11.86, 215e3), (2550e3 / 215e3, 215e3), (12.0, 2550e3 / 12), (20.0, 127.5e3)],
)
def test_traction_limit_is_force_then_power(speed_mps: float, force_n: float) -> None:
    assert forces.effort_limit_n(force_tables.effort_table(TRAIN.traction), speed_mps) == pytest.approx(force_n)


@pytest.mark.parametrize(
    ("speed_mps", "force_n"),
    [(0.0, 90.0), (5.0, 90.0), (7.5, 80.0), (10.0, 70.0), (12.5, 55.0), (15.0, 40.0), (99.0, 2000 / 99)],
)
def test_curve_is_interpolated_held_and_below_the_other_limits(speed_mps: float, force_n: float) -> None:
    effort = Effort(force_max_n=90.0, power_max_w=2000.0, curve=((5.0, 90.0), (10.0, 70.0), (15.0, 40.0)))
    assert forces.effort_limit_n(force_tables.effort_table(effort), speed_mps) == pytest.approx(force_n)


def test_resistance_in_newton() -> None:
    # 211 t * 9.81 = 2069.91 kN; at 72 km/h 2 + 0.576 + 2.3328 = 4.9088 N/kN, and 5 permil of grade.
    assert forces.resistance_n(force_tables.train_constants(TRAIN), 20.0, 5.0) == pytest.approx(2069.91 * 9.9088)


@given(
    first=st.floats(-3e5, 3e5),
    steady=st.floats(-3e5, 3e5),
    pole=st.floats(0.05, 20),
    share=st.floats(0.05, 0.95),
)
def test_actuator_is_exact_for_any_division_of_the_step(first: float, steady: float, pole: float, share: float) -> None:
    whole, left, right = (dynamics.lag(pole, TICK_S * part) for part in (1.0, share, 1.0 - share))
    between = steady + (first - steady) * left.decay
    last = steady + (between - steady) * right.decay
    mean = share * (steady + (first - steady) * left.mean) + (1 - share) * (steady + (between - steady) * right.mean)
    assert last == pytest.approx(steady + (first - steady) * exp(-pole * TICK_S), rel=1e-9, abs=1e-6)
    assert mean == pytest.approx(steady + (first - steady) * whole.mean, rel=1e-9, abs=1e-6)


@pytest.mark.slow
@given(first=st.floats(-10, 10), last=st.floats(-10, 10), low=st.floats(-6, 0), high=st.floats(0, 6))
def test_mean_of_a_clipped_force(first: float, last: float, low: float, high: float) -> None:
    expected = float(np.clip(np.linspace(first, last, 20001), low, high).mean())
    found = dynamics.clipped_mean_n(first, last, (first + last) / 2, low, high)
    assert found == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("grade", [-30.0, -1.9, 0.0, 30.0])
@pytest.mark.parametrize("braking_n", [90e3, 270e3])
def test_a_brake_holds_and_does_not_push(grade: float, braking_n: float) -> None:
    motion = stepped(TRAIN, Motion(5.0, 0.0, -braking_n, 0.0), -braking_n, grade=((0.0, grade),)).motion
    assert (motion.position_m, motion.speed_mps) == (5.0, 0.0)


@pytest.mark.parametrize(("grade", "rolls"), [(-1.99, False), (-2.01, True), (0.0, False), (8.0, False)])
def test_without_forces_the_train_rolls_where_the_grade_beats_the_resistance(grade: float, rolls: bool) -> None:
    # Davis a = 2.0 N/kN: the train stands on anything flatter than 2 permil downhill.
    motion = stepped(TRAIN, Motion(0.0, 0.0, 0.0, 0.0), 0.0, grade=((0.0, grade),)).motion
    assert (motion.speed_mps > 0.0) is rolls
    assert motion.speed_mps >= 0.0


def test_departure_is_when_the_force_overcomes_the_resistance() -> None:
    steady_n = 7 * TRAIN.force_per_notch_n
    against_n = 211 * 9.81 * 2.0
    # F(t) = steady (1 - e^-pt) reaches the resistance inside the step that starts 5 ms before.
    due_s = -np.log(1 - against_n / steady_n) / TRAIN.actuator_pole_per_s
    at_start_n = steady_n * (1 - exp(-TRAIN.actuator_pole_per_s * (due_s - 0.005)))
    step = stepped(TRAIN, Motion(0.0, 0.0, at_start_n, 0.0), steady_n)
    assert step.moving_from_s == pytest.approx(0.005, abs=1e-12)
    # From there the force grows by p (steady - against) per second: v = slope t^2 / 2M.
    slope = TRAIN.actuator_pole_per_s * (steady_n - against_n) / TRAIN.inertial_mass_kg
    assert step.motion.speed_mps == pytest.approx(slope * 0.005**2 / 2, rel=2e-3)


@given(speed=st.floats(1e-5, 0.0099), braking_mps2=st.floats(1.0, 1.2))
def test_stop_inside_a_step(speed: float, braking_mps2: float) -> None:
    force_n = -braking_mps2 * FRICTIONLESS.inertial_mass_kg
    motion = Motion(100.0, speed, force_n, -braking_mps2)
    step = stepped(FRICTIONLESS, motion, force_n)
    assert step.motion.speed_mps == 0.0
    assert step.moving_to_s == pytest.approx(speed / braking_mps2, rel=1e-9)
    assert step.motion.position_m - 100.0 == pytest.approx(speed**2 / (2 * braking_mps2), abs=1e-12)


@pytest.mark.parametrize("window", [Window(False, 0.0), Window(False, 50e3), Window(True, 50e3), Window(False, inf)])
def test_no_traction_gets_through_a_closed_window(window: Window) -> None:
    motion = Motion(0.0, 10.0, 150e3, 0.0)
    applied_n = dynamics.applied_n(force_tables.train_constants(TRAIN), window, motion)
    assert applied_n == -min(window.brake_min_n, 270e3)


@settings(max_examples=40)
@given(speed=st.floats(0.5, 21), actuator=st.floats(-300e3, 300e3), notch=st.floats(-7, 7))
def test_a_step_agrees_with_its_hundred_parts(speed: float, actuator: float, notch: float) -> None:
    steady_n = notch * TRAIN.force_per_notch_n
    grade: Profile = ((0.0, 4.0), (200.0, -6.0))
    fine = Motion(210.0, speed, actuator, 0.0)
    for _ in range(100):
        fine = stepped(TRAIN, fine, steady_n, grade=grade, step_s=TICK_S / 100).motion
    start = Motion(210.0, speed, actuator, (fine.speed_mps - speed) / TICK_S)
    whole = stepped(TRAIN, start, steady_n, grade=grade).motion
    assert whole.speed_mps == pytest.approx(fine.speed_mps, abs=2e-8)
    assert whole.position_m == pytest.approx(fine.position_m, abs=2e-7)
    assert whole.actuator_n == pytest.approx(fine.actuator_n, rel=1e-9, abs=1e-3)


def _solved(train: Train, grade: Profile, notches: list[tuple[float, float]]) -> tuple[float, float]:
    """Instant and position of the stop by scipy's solver on the equations as they stand in the design."""
    # Every process that collects the tests would load it.
    from scipy.integrate import solve_ivp

    def force_n(speed: float, actuator: float) -> float:
        high = min(215e3, 2550e3 / max(speed, 1e-9))
        return min(max(actuator, -270e3), high)

    def derivative(_: float, state: np.ndarray, notch: float) -> list[float]:
        position, speed, actuator = state
        kmh = 3.6 * speed
        davis = 2.0 + 0.008 * kmh + 0.00045 * kmh**2 + overlap_mean(grade, position - 80.0, position)
        net_n = force_n(speed, actuator) - 211e3 * 9.81 / 1000 * davis
        pole, gain = train.actuator_pole_per_s, train.force_per_notch_n
        return [speed, net_n / train.inertial_mass_kg, pole * (gain * notch - actuator)]

    def stands(_: float, state: np.ndarray, notch: float) -> float:
        return float(state[1])

    stands.terminal = True  # type: ignore[attr-defined]
    stands.direction = -1  # type: ignore[attr-defined]
    state = np.array([0.0, 1e-9, 2.0 * 2069.91])
    for (from_s, notch), (to_s, _) in pairwise(notches):
        solution = solve_ivp(
            derivative, (from_s, to_s), state, args=(notch,), events=stands, rtol=1e-9, atol=1e-9, max_step=0.25
        )
        state = solution.y[:, -1]
        if solution.t_events[0].size:
            return float(solution.t_events[0][0]), float(state[0])
    raise AssertionError("the reference run does not stop")


def test_a_run_agrees_with_an_independent_solver() -> None:
    """Pull into both traction limits, coast over the grades, brake into the brake limit; 1 mm and 0.1 ms."""
    scenario = load("lvshun_tieshan")
    grade = scenario.line.grade_permil
    notches = [(0.0, 6.5), (30.0, 1.0), (70.0, 0.0), (90.0, -6.5), (200.0, 0.0)]
    train = scenario.train
    stop_s, stop_m = _solved(train, grade, notches)

    constants = force_tables.train_constants(train)
    grades = force_tables.grade_table(grade, train.length_m)
    tick_lag = dynamics.lag(train.actuator_pole_per_s, TICK_S)
    # Start where the reference starts: force just at the resistance.
    motion = Motion(0.0, 0.0, 2.0 * 2069.91, 0.0)
    tick = 0
    step = dynamics.Step(motion, 0.0, TICK_S)
    while tick < 20_000 and (tick == 0 or motion.speed_mps > 0.0):
        notch = max(row for row in notches if row[0] <= tick * TICK_S + 1e-9)[1]
        step = dynamics.step(constants, grades, FREE, motion, notch * train.force_per_notch_n, tick_lag)
        motion = step.motion
        tick += 1
    assert motion.speed_mps == 0.0
    assert motion.position_m == pytest.approx(stop_m, abs=1e-3)
    assert (tick - 1) * TICK_S + step.moving_to_s == pytest.approx(stop_s, abs=1e-4)
