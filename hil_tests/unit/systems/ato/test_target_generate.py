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
from hil_tests.support.target_curves import TRAIN, assert_curve_keeps_everything, lines
from railhil.scenarios.load import load, names
from railhil.scenarios.profiles import MeanGrade
from railhil.systems.ato.scenario import regenerate
from railhil.systems.ato.scenario.effort import force_limit_n, resistance_n
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.ato.scenario.generate import CurveLimits, fastest_time_s, generate
from railhil.systems.ato.scenario.model import Effort, Line
from railhil.systems.ato.scenario.perturb import perturb
from railhil.systems.ato.scenario.target import Target

YIZHUANG = [name for name in names() if re.match(r"yizhuang_\d", name)]
LIMITS = CurveLimits()


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


@pytest.mark.slow
@given(lines(), st.floats(1.0, 1.5))
@settings(max_examples=15, deadline=None)
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
