"""Shortest time and least work of a section: golden values of an independent program, and what holds on any line."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.paths import TEST_DATA
from hil_tests.support.return_run import return_section
from railhil.scenarios.load import load_any
from railhil.scenarios.profiles import MeanGrade
from railhil.systems.ato.energy.ideal_train import Kind, shortest_time_s
from railhil.systems.ato.energy.programme import EnergyBound, energy_bound
from railhil.systems.ato.scenario.effort import force_limit_n, resistance_n
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.ato.scenario.model import Line, Scenario

GOLDEN: list[dict[str, Any]] = json.loads((TEST_DATA / "line" / "line_bounds.json").read_text())["sections"]
NUMBERS = range(1, len(GOLDEN) + 1)
#: Uncertainty of the golden values, and of ours.
ALLOWED = 0.005


def section(number: int) -> Scenario:
    scenario = load_any(f"yizhuang_{number:02d}")
    assert isinstance(scenario, Scenario)
    return scenario


@pytest.mark.parametrize("number", NUMBERS)
def test_the_shortest_time_of_each_section_is_the_golden_one(number: int) -> None:
    assert shortest_time_s(section(number)) == pytest.approx(GOLDEN[number - 1]["shortest_s"], abs=1e-3)


@pytest.mark.slow
@pytest.mark.long_after(6)
@pytest.mark.parametrize("kind", ["ideal", "comfort"])
@pytest.mark.parametrize("number", NUMBERS)
def test_the_bound_of_each_section_is_the_golden_one(number: int, kind: Kind) -> None:
    golden = GOLDEN[number - 1]
    found = energy_bound(section(number), golden["timetable_s"], kind)
    for value_kj in (found.dual_kj, found.feasible_kj, found.bound_kj):
        assert value_kj == pytest.approx(golden[f"{kind}_kJ"], rel=ALLOWED)


@pytest.mark.long_after(3)
@pytest.mark.slow
@pytest.mark.parametrize("number", NUMBERS)
def test_dual_and_feasible_value_agree_in_the_return_direction(number: int) -> None:
    scenario = return_section(number)
    found = energy_bound(scenario, scenario.plan.running_time_s, "comfort")
    assert found.feasible_kj == pytest.approx(found.dual_kj, rel=0.003)
    assert found.shortest_s < scenario.plan.running_time_s


def three_phases(scenario: Scenario, traction_to_mps: float, braking_mps2: float) -> tuple[float, float]:
    """Work (kJ) and time (s) of full traction up to a speed, coasting, and braking to the stop, in steps of time: an
    independent program that knows neither stages nor grids."""
    train, distance_m, step_s = scenario.train, scenario.plan.distance_m, 0.01
    grade = MeanGrade(scenario.line.grade_permil, train.length_m)
    position_m = speed_mps = work_j = time_s = 0.0
    has_pulled = False
    while True:
        has_pulled = has_pulled or speed_mps >= traction_to_mps
        if speed_mps**2 >= 2 * braking_mps2 * (distance_m - position_m) or (has_pulled and speed_mps <= 0.0):
            return work_j / 1000, time_s + speed_mps / braking_mps2
        pull_n = 0.0 if has_pulled else float(force_limit_n(train.traction, speed_mps))
        net_n = pull_n - float(resistance_n(train, speed_mps, grade(position_m)))
        after_mps = speed_mps + net_n / train.inertial_mass_kg * step_s
        moved_m = (speed_mps + after_mps) / 2 * step_s
        position_m, speed_mps, time_s, work_j = (
            position_m + moved_m,
            after_mps,
            time_s + step_s,
            work_j + pull_n * moved_m,
        )


@pytest.mark.slow
def test_a_simulated_driving_of_three_phases_needs_no_less_than_the_bound() -> None:
    scenario = section(5)
    slow_mps, fast_mps = 10.0, 23.0
    for _ in range(14):
        middle_mps = (slow_mps + fast_mps) / 2
        _, time_s = three_phases(scenario, middle_mps, 1.0)
        slow_mps, fast_mps = (middle_mps, fast_mps) if time_s > 94.0 else (slow_mps, middle_mps)
    work_kj, time_s = three_phases(scenario, fast_mps, 1.0)
    assert time_s == pytest.approx(94.0, abs=0.05)
    assert energy_bound(scenario, time_s).bound_kj == pytest.approx(work_kj, rel=2e-3)


def test_a_time_below_the_shortest_is_refused_by_name() -> None:
    with pytest.raises(CurveError, match=r"running time 75 s is shorter than the shortest, 75\.85"):
        energy_bound(section(5), 75.0)


def test_the_shortest_time_itself_has_a_bound() -> None:
    scenario = section(5)
    shortest_s = shortest_time_s(scenario)
    found = energy_bound(scenario, shortest_s)
    assert found.shortest_s == shortest_s
    assert found.bound_kj > energy_bound(scenario, shortest_s + 1).bound_kj


def test_a_train_that_cannot_climb_is_told_where() -> None:
    scenario = section(5)
    steep = replace(scenario, line=replace(scenario.line, grade_permil=((-118.0, 0.0), (200.0, 150.0))))
    with pytest.raises(CurveError, match=r"cannot climb .* permil at"):
        shortest_time_s(steep)


def test_a_margin_above_a_limit_is_refused() -> None:
    scenario = section(5)
    crawl = replace(scenario, line=replace(scenario.line, speed_limit_mps=((-118.0, 0.5),)))
    with pytest.raises(CurveError, match="speed margin"):
        shortest_time_s(crawl, comfort=True)


def test_a_train_that_rolls_down_needs_hardly_any_work() -> None:
    scenario = section(5)
    plan = replace(scenario.plan, distance_m=300.0)
    downhill = replace(scenario, plan=plan, line=Line("x", ((-118.0, -30.0),), ((-118.0, 16.0),)))
    assert energy_bound(downhill, 200.0).bound_kj < 50.0


LINES = st.builds(
    lambda grades, limits: Line(
        "random",
        tuple((-118.0 + 150 * i, float(permil)) for i, permil in enumerate(grades)),
        tuple((-118.0 + 130 * i, kmh / 3.6) for i, kmh in enumerate(limits)),
    ),
    st.lists(st.integers(-25, 25), min_size=1, max_size=5),
    st.lists(st.integers(25, 80), min_size=1, max_size=5),
)


def on_line(line: Line, distance_m: float) -> Scenario:
    scenario = section(5)
    return replace(scenario, line=line, plan=replace(scenario.plan, distance_m=distance_m))


def bound(line: Line, distance_m: float, share: float, kind: Kind) -> EnergyBound:
    scenario = on_line(line, distance_m)
    return energy_bound(scenario, shortest_time_s(scenario, comfort=kind == "comfort") * share, kind)


@pytest.mark.slow
@settings(max_examples=8, deadline=None)
@given(line=LINES, distance_m=st.floats(250.0, 500.0), share=st.floats(1.02, 1.6), more=st.floats(0.02, 0.4))
def test_the_dual_value_is_below_the_feasible_one_and_more_time_costs_no_more(
    line: Line, distance_m: float, share: float, more: float
) -> None:
    found, later = (bound(line, distance_m, part, "ideal") for part in (share, share + more))
    for each in (found, later):
        assert each.feasible_kj >= each.dual_kj * (1 - ALLOWED) - 5.0
        assert each.feasible_kj <= each.dual_kj * 1.02 + 20.0
    assert later.feasible_kj <= found.feasible_kj * (1 + ALLOWED) + 5.0
    assert found.bound_at_kj(later.running_time_s) <= later.feasible_kj * (1 + ALLOWED) + 5.0


@pytest.mark.slow
@settings(max_examples=4, deadline=None)
@given(line=LINES, distance_m=st.floats(250.0, 500.0), share=st.floats(1.05, 1.4))
def test_comfort_costs_no_less_than_the_ideal_driving_of_the_same_time(
    line: Line, distance_m: float, share: float
) -> None:
    comfort = bound(line, distance_m, share, "comfort")
    ideal = energy_bound(on_line(line, distance_m), comfort.running_time_s, "ideal")
    assert ideal.bound_kj <= comfort.feasible_kj * (1 + ALLOWED) + 5.0
    assert np.isfinite(comfort.multiplier_w)
