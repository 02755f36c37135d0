"""Generated target curves with coasting: the same place and time with less work, within the same limits."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.paths import TEST_DATA
from hil_tests.support.return_run import return_section
from hil_tests.support.target_curves import TRAIN, assert_curve_keeps_everything, lines
from railhil.scenarios.load import load
from railhil.scenarios.profiles import MeanGrade
from railhil.systems.ato.energy.programme import energy_bound
from railhil.systems.ato.scenario.effort import resistance_n
from railhil.systems.ato.scenario.generate import CurveLimits, fastest_time_s, generate
from railhil.systems.ato.scenario.model import Line, Scenario, TargetCurve, Train
from railhil.systems.ato.scenario.target import Target

PLAIN, COAST = CurveLimits(), CurveLimits(coast=True)
GOLDEN = json.loads((TEST_DATA / "line" / "line_bounds.json").read_text())


def work_kj(curve: TargetCurve, line: Line, train: Train) -> float:
    """Traction work of a train that follows the curve exactly."""
    target = Target(curve)
    time_s = np.linspace(0.0, target.stop_time_s, 4001)
    speed, accel = np.maximum(target.speed_mps(time_s), 0.0), target.accel_mps2(time_s)
    grade = MeanGrade(line.grade_permil, train.length_m)(target.position_m(time_s))
    force_n = train.inertial_mass_kg * accel + resistance_n(train, speed, grade)
    power_w = np.maximum(force_n, 0.0) * speed
    return float(((power_w[1:] + power_w[:-1]) / 2 * np.diff(time_s)).sum()) / 1000


def coasted(scenario: Scenario) -> TargetCurve:
    return generate(scenario.line, scenario.train, scenario.plan.distance_m, scenario.plan.running_time_s, COAST)


@pytest.mark.long
@pytest.mark.slow
def test_coasting_saves_work_on_every_section_of_yizhuang() -> None:
    """112 % of the comfortable bound over the line, 125 % on each section (bar 10), at the times of the timetable."""
    total_kj = 0.0
    for number, golden in enumerate(GOLDEN["sections"], start=1):
        scenario = load(f"yizhuang_{number:02d}")
        found_kj = work_kj(coasted(scenario), scenario.line, scenario.train)
        assert golden["ideal_kJ"] * 0.995 <= found_kj <= 1.25 * golden["comfort_kJ"]
        assert found_kj < work_kj(scenario.target, scenario.line, scenario.train)
        total_kj += found_kj
    assert total_kj <= 1.08 * GOLDEN["total"]["comfort_kJ"]


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("number", [3, 5, 11, 12])
def test_coasting_saves_work_in_the_return_direction(number: int) -> None:
    scenario = return_section(number)
    comfort_kj = energy_bound(scenario, scenario.plan.running_time_s, "comfort").bound_kj
    assert work_kj(coasted(scenario), scenario.line, scenario.train) <= 1.25 * comfort_kj


@pytest.mark.parametrize("number", [3, 5])
def test_a_curve_with_coasting_keeps_every_limit(number: int) -> None:
    scenario = load(f"yizhuang_{number:02d}")
    curve = coasted(scenario)
    target = Target(curve)
    assert target.stop_position_m == pytest.approx(scenario.plan.distance_m, abs=1e-5)
    assert target.stop_time_s == pytest.approx(scenario.plan.running_time_s, abs=1e-6)
    assert_curve_keeps_everything(curve, scenario.line, scenario.train, COAST)


@pytest.mark.slow
@given(lines(), st.floats(1.0, 1.6))
@settings(max_examples=8, deadline=None)
def test_any_line_with_grades_and_limits(drawn: tuple[Line, float], reserve: float) -> None:
    line, distance_m = drawn
    running_time_s = fastest_time_s(line, TRAIN, distance_m, COAST) * reserve
    curve = generate(line, TRAIN, distance_m, running_time_s, COAST)
    target = Target(curve)
    assert target.stop_position_m == pytest.approx(distance_m, abs=1e-3)
    assert target.stop_time_s == pytest.approx(running_time_s, abs=1e-3)
    assert_curve_keeps_everything(curve, line, TRAIN, COAST)


@pytest.mark.slow
@given(lines(), st.floats(1.03, 1.5))
@settings(max_examples=8, deadline=None)
def test_coasting_costs_hardly_more_than_the_plain_curve_on_any_line(drawn: tuple[Line, float], reserve: float) -> None:
    line, distance_m = drawn
    running_time_s = fastest_time_s(line, TRAIN, distance_m, COAST) * reserve
    plain, coasting = (
        work_kj(generate(line, TRAIN, distance_m, running_time_s, limits), line, TRAIN) for limits in (PLAIN, COAST)
    )
    assert coasting <= 1.01 * plain + 50.0


def test_more_time_needs_less_work() -> None:
    scenario = load("yizhuang_05")
    works = [
        work_kj(generate(scenario.line, scenario.train, 993.0, time_s, COAST), scenario.line, scenario.train)
        for time_s in (91.0, 94.0, 100.0, 120.0)
    ]
    assert works == sorted(works, reverse=True)


def test_without_a_reserve_the_time_of_the_fastest_curve_is_met_too() -> None:
    scenario = load("yizhuang_05")
    fastest_s = fastest_time_s(scenario.line, scenario.train, 993.0, COAST)
    plain, coasting = (generate(scenario.line, scenario.train, 993.0, fastest_s, limits) for limits in (PLAIN, COAST))
    assert Target(coasting).stop_time_s == pytest.approx(fastest_s, abs=1e-6)
    assert work_kj(coasting, scenario.line, scenario.train) <= work_kj(plain, scenario.line, scenario.train)


def test_a_train_without_speed_dependent_resistance_coasts_too() -> None:
    """No speed is best to hold, so it pulls up to the limit; coasting is what remains to choose."""
    plain = replace(TRAIN, davis_b_n_per_kn_kmh=0.0, davis_c_n_per_kn_kmh2=0.0)
    line = Line("level", ((-80.0, 0.0),), ((-80.0, 20.0),))
    curve = generate(line, plain, 1500.0, 130.0, COAST)
    assert Target(curve).stop_time_s == pytest.approx(130.0, abs=1e-6)
    assert_curve_keeps_everything(curve, line, plain, COAST)


def test_the_key_of_a_scenario_file_makes_the_curve(tmp_path: Path) -> None:
    path = tmp_path / "economy.toml"
    path.write_text(
        'extends = "yizhuang_05"\nname = "economy"\ntitle = "t"\nwithout = ["target"]\n'
        "[target.generate]\ncoast = true\n"
    )
    economy = load(str(path))
    assert economy.target == coasted(load("yizhuang_05"))
