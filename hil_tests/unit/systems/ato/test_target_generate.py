"""Generated target speed curves meet distance, time, speed limits, force limits and jerk on any line."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support import shipped
from railhil.scenarios.load import load, names
from railhil.scenarios.profiles import MeanGrade, profile_value
from railhil.systems.ato.scenario import regenerate
from railhil.systems.ato.scenario.effort import force_limit_n, resistance_n
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.ato.scenario.generate import CurveLimits, fastest_time_s, generate
from railhil.systems.ato.scenario.model import Effort, Line, TargetCurve, Train
from railhil.systems.ato.scenario.perturb import perturb
from railhil.systems.ato.scenario.target import Target

YIZHUANG = [name for name in names() if re.match(r"yizhuang_\d", name)]
LIMITS = CurveLimits()
TRAIN = Train(
    name="test train",
    mass_kg=200_000.0,
    inertial_mass_kg=212_000.0,
    length_m=80.0,
    davis_a_n_per_kn=2.0,
    davis_b_n_per_kn_kmh=0.01,
    davis_c_n_per_kn_kmh2=0.0005,
    traction=Effort(220_000.0, 2_600_000.0),
    brake=Effort(260_000.0),
    actuator_pole_per_s=0.34,
    force_per_notch_n=45_000.0,
)


def felt_limit_mps(line: Line, train: Train, front_m: float) -> float:
    """Least limit under the whole train, by looking at every metre: slow, but plainly right."""
    under = np.arange(front_m - train.length_m + 1e-6, front_m, 1.0)
    return min(profile_value(line.speed_limit_mps, float(x)) for x in (*under, front_m))


def mean_grade_permil(line: Line, train: Train, front_m: float) -> float:
    under = front_m - train.length_m + (np.arange(80) + 0.5) * train.length_m / 80
    return float(np.mean([profile_value(line.grade_permil, float(x)) for x in under]))


def assert_curve_keeps_everything(curve: TargetCurve, line: Line, train: Train, limits: CurveLimits) -> None:
    """Speed, acceleration, jerk and force limits by brute force over samples of the run."""
    target = Target(curve)
    nodes = np.array(curve.nodes)
    jerk = np.diff(nodes[:, 1]) / np.diff(nodes[:, 0])
    assert np.abs(jerk).max() <= limits.jerk_max_mps3 + 1e-6
    assert nodes[:, 1].max() <= limits.accel_max_mps2 + 1e-9
    assert nodes[:, 1].min() >= -limits.braking_max_mps2 - 1e-9
    assert nodes[0] == pytest.approx((0.0, 0.0))
    assert -limits.end_braking_mps2 - 1e-9 <= nodes[-1, 1] < 0
    weight_kn = train.mass_kg * train.gravity_mps2 / 1000
    for t in np.linspace(0.0, target.stop_time_s, 120)[:-1].tolist():
        v, x, a = target.speed_mps(t), target.position_m(t), target.accel_mps2(t)
        assert -1e-9 <= v <= felt_limit_mps(line, train, x) + 1e-6
        kmh = 3.6 * v
        davis = train.davis_a_n_per_kn + train.davis_b_n_per_kn_kmh * kmh + train.davis_c_n_per_kn_kmh2 * kmh**2
        force_n = train.inertial_mass_kg * a + weight_kn * (davis + mean_grade_permil(line, train, x))
        effort = train.traction
        limit_n = min(effort.force_max_n, effort.power_max_w / v if effort.power_max_w and v > 0 else np.inf)
        if effort.curve:
            limit_n = min(limit_n, float(np.interp(v, *np.array(effort.curve).T)))
        assert force_n <= limit_n * (limits.traction_utilisation + 0.03)
        assert -force_n <= train.brake.force_max_n * (limits.brake_utilisation + 0.03)


@pytest.mark.parametrize("name", YIZHUANG)
def test_yizhuang_runs_meet_distance_limits_and_jerk(name: str) -> None:
    scenario = load(name)
    target = Target(scenario.target)
    assert target.stop_position_m == pytest.approx(scenario.plan.distance_m, abs=1e-3)
    assert target.stop_time_s == pytest.approx(scenario.plan.running_time_s, abs=1e-3)
    assert_curve_keeps_everything(scenario.target, scenario.line, scenario.train, LIMITS)


@pytest.mark.parametrize("name", shipped.ATO)
def test_perturbed_trains_have_the_force_to_follow(name: str) -> None:
    """Tracking error must be the controller's, not the curve's: heavy, stiff trains stay below their limits."""
    scenario = load(name)
    target = Target(scenario.target)
    times = np.arange(0.0, target.stop_time_s, 0.5)
    v, x, a = target.speed_mps(times), target.position_m(times), target.accel_mps2(times)
    for seed in range(20):
        run = perturb(scenario, seed)
        grade = MeanGrade(run.line.grade_permil, run.train.length_m)(x)
        force = run.train.inertial_mass_kg * a + resistance_n(run.train, v, grade)
        assert float((force / force_limit_n(run.train.traction, v)).max()) < 0.98
        assert float((-force / force_limit_n(run.train.brake, v)).max()) < 0.9


def test_all_thirteen_yizhuang_runs_are_shipped() -> None:
    assert [name.split("_")[1] for name in YIZHUANG] == [f"{number:02d}" for number in range(1, 14)]


def test_a_lower_limit_holds_from_the_front_a_higher_one_from_the_rear() -> None:
    line = Line("slow stretch", ((-80.0, 0.0),), ((-80.0, 20.0), (800.0, 8.0), (900.0, 20.0)))
    curve = generate(line, TRAIN, 2000.0, fastest_time_s(line, TRAIN, 2000.0, LIMITS), LIMITS)
    target = Target(curve)
    for x in (800.0, 850.0, 900.0, 979.0):
        assert target.speed_mps(float(target.time_s(x))) <= 8.0
    for x in (700.0, 1080.0):
        assert target.speed_mps(float(target.time_s(x))) > 9.0


def test_the_running_time_is_met_exactly_between_the_fastest_and_twice_that() -> None:
    line = Line("level", ((-80.0, 0.0),), ((-80.0, 20.0),))
    fastest = fastest_time_s(line, TRAIN, 1500.0, LIMITS)
    for running_time_s in (fastest, fastest * 1.03, fastest * 1.3, fastest * 2):
        target = Target(generate(line, TRAIN, 1500.0, running_time_s, LIMITS))
        assert target.stop_time_s == pytest.approx(running_time_s, abs=1e-6)
        assert target.stop_position_m == pytest.approx(1500.0, abs=1e-5)


def test_the_fastest_time_is_near_the_plain_trapezoid() -> None:
    """Level, no resistance, no margin: the trapezoid a = b = 0.5 to 20 m/s over 2000 m takes 140 s."""
    plain = replace(
        TRAIN, davis_a_n_per_kn=0.0, davis_b_n_per_kn_kmh=0.0, davis_c_n_per_kn_kmh2=0.0, traction=Effort(1e6)
    )
    line = Line("level", ((-80.0, 0.0),), ((-80.0, 20.0),))
    limits = CurveLimits(accel_max_mps2=0.5, braking_max_mps2=0.5, jerk_max_mps3=1.0, speed_margin_mps=0.0)
    assert fastest_time_s(line, plain, 2000.0, limits) == pytest.approx(140.0, abs=1.5)


@pytest.mark.parametrize(
    ("line", "distance_m", "running_time_s", "words"),
    [
        (Line("l", ((0.0, 0.0),), ((0.0, 20.0),)), 1500.0, 60.0, "shorter than the fastest"),
        (Line("l", ((0.0, 90.0),), ((0.0, 20.0),)), 1500.0, 600.0, "cannot climb 90.0 permil"),
        (Line("l", ((0.0, -190.0),), ((0.0, 20.0),)), 1500.0, 600.0, "brake cannot stop"),
        (Line("l", ((0.0, 0.0),), ((0.0, 20.0),)), 1.0, 600.0, "too short"),
        (Line("l", ((0.0, 0.0),), ((0.0, 0.5),)), 1500.0, 600.0, "speed margin"),
    ],
)
def test_what_cannot_be_met_is_said(line: Line, distance_m: float, running_time_s: float, words: str) -> None:
    with pytest.raises(CurveError, match=words):
        generate(line, TRAIN, distance_m, running_time_s, LIMITS)


@st.composite
def lines(draw: st.DrawFn) -> tuple[Line, float]:
    edges = sorted(draw(st.sets(st.integers(-70, 3000), min_size=0, max_size=8)))
    limits = ((-80.0, draw(st.integers(30, 90)) / 3.6), *((float(x), draw(st.integers(30, 90)) / 3.6) for x in edges))
    grades = ((-80.0, 0.0), *((float(x) + 35.0, float(draw(st.integers(-30, 30)))) for x in edges))
    return Line("drawn", grades, limits), float(draw(st.integers(400, 3000)))


@pytest.mark.slow
@given(lines(), st.floats(1.0, 1.5))
@settings(max_examples=40, deadline=None)
def test_any_line_with_grades_and_limits(drawn: tuple[Line, float], reserve: float) -> None:
    line, distance_m = drawn
    running_time_s = fastest_time_s(line, TRAIN, distance_m, LIMITS) * reserve
    curve = generate(line, TRAIN, distance_m, running_time_s, LIMITS)
    target = Target(curve)
    assert target.stop_position_m == pytest.approx(distance_m, abs=1e-3)
    assert target.stop_time_s == pytest.approx(running_time_s, abs=1e-3)
    assert_curve_keeps_everything(curve, line, TRAIN, LIMITS)


def test_a_shipped_curve_is_what_the_command_makes(capsys: pytest.CaptureFixture[str]) -> None:
    name = YIZHUANG[3]
    assert regenerate.main([name]) == 0
    printed = capsys.readouterr().out
    rows = [line.strip(" [],") for line in printed.splitlines() if line.startswith("    [")]
    again = np.array([[float(part) for part in row.split(",")] for row in rows])
    assert again == pytest.approx(np.array(load(name).target.nodes), abs=1e-6)


def test_the_command_refuses_what_it_cannot_make(capsys: pytest.CaptureFixture[str]) -> None:
    assert regenerate.main(["lvshun_tieshan"]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "[target.generate]" in error


def test_the_command_writes_shipped_curves_only(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(f'extends = "{YIZHUANG[4]}"\nname = "mine"\ntitle = "t"\n', encoding="utf-8")
    assert regenerate.main([str(path)]) == 0
    capsys.readouterr()
    assert regenerate.main([str(path), "--write"]) == 2
    assert "redirect the output" in capsys.readouterr().err


def test_end_of_the_curve_is_straight_for_a_second() -> None:
    for name in YIZHUANG[:2]:
        (t0, a0), (t1, a1) = list(pairwise(load(name).target.nodes))[-1]
        assert a0 == a1 == pytest.approx(-0.35, abs=1e-3)
        assert t1 - t0 >= 1.0
