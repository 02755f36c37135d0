"""Sections of a line: complete scenarios of ato, their target curves, and the running time chosen at a departure."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import cast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.common.errors import InputError
from railhil.scenarios.layers import DATA
from railhil.scenarios.load import load, load_any, names
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.ato.scenario.model import Scenario, TargetCurve
from railhil.systems.ato.scenario.target import Target
from railhil.systems.line.scenario.model import LineScenario, Mode, Route
from railhil.systems.line.scenario.sections import (
    choose_running_time,
    fit_target,
    make_target,
    section_line,
    section_scenario,
)

SINGLE = [name for name in names() if name.startswith("yizhuang_") and name[9:11].isdigit()]


@lru_cache
def single(number: int) -> Scenario:
    return load(SINGLE[number - 1])


@lru_cache
def yizhuang() -> LineScenario:
    return cast("LineScenario", load_any("yizhuang_out"))


@pytest.mark.parametrize("index", range(13))
def test_a_section_equals_the_single_run_on_it(index: int) -> None:
    section, run = section_scenario(yizhuang(), index), single(1 + index)
    assert section.line == run.line
    assert (section.train, section.target, section.timing) == (run.train, run.target, run.timing)
    assert (section.plan.distance_m, section.plan.running_time_s) == (run.plan.distance_m, run.plan.running_time_s)
    assert (section.sensors, section.perturbations) == (run.sensors, run.perturbations)
    assert type(section) is Scenario
    assert section.system == "ato"


def test_an_undisturbed_departure_uses_the_curve_of_the_timetable() -> None:
    line = yizhuang()
    name, running_time_s, curve = choose_running_time(line, 4, 748.0)
    assert (name, running_time_s, curve) == ("timetable", 94.0, None)
    assert make_target(line, 4, 94.0, 993.0) is line.sections[4].target


@settings(max_examples=40, deadline=None)
@given(
    late_s=st.floats(-5.0, 4.0).map(lambda value: round(value * 2) / 2),
    short_m=st.floats(-5.0, 5.0),
    index=st.integers(0, 12),
)
def test_a_target_stops_at_the_place_and_time_that_are_asked_for(late_s: float, short_m: float, index: int) -> None:
    line = yizhuang()
    section = line.sections[index]
    way_m = line.stops[section.arrival].position_m - line.stops[section.departure].position_m + short_m
    made = Target(make_target(line, index, section.running_time_s - late_s, way_m))
    assert made.stop_position_m == pytest.approx(way_m, abs=1e-6)
    assert made.stop_time_s == pytest.approx(section.running_time_s - late_s, abs=1e-7)


@given(k=st.floats(0.8, 1.3), s=st.floats(0.9, 1.1))
def test_a_fitted_curve_is_as_fast_as_its_ratios_say(k: float, s: float) -> None:
    curve = TargetCurve(((0.0, 0.5), (20.0, 0.5), (40.0, -0.5), (60.0, -0.5)))
    plain = Target(curve)
    fitted = Target(fit_target(curve, plain.stop_time_s * k, plain.stop_position_m * s))
    assert fitted.stop_time_s == pytest.approx(plain.stop_time_s * k, rel=1e-12)
    assert fitted.stop_position_m == pytest.approx(plain.stop_position_m * s, rel=1e-12)
    assert fitted.speed_mps(25.0 * k) == pytest.approx(plain.speed_mps(25.0) * s / k, rel=1e-9)


def test_a_curve_that_would_become_too_fast_is_generated_again() -> None:
    line = yizhuang()
    way_m = 993.0 + 20.0
    made = make_target(line, 4, 94.0, way_m)
    times_s = [time_s for time_s, _ in line.sections[4].target.nodes]
    assert [time_s for time_s, _ in made.nodes] != pytest.approx(times_s)
    assert Target(made).stop_position_m == pytest.approx(way_m, abs=1e-6)


def test_a_running_time_below_the_fastest_is_an_error() -> None:
    with pytest.raises(CurveError, match="shorter than the fastest"):
        make_target(yizhuang(), 4, 60.0, 993.0)


@pytest.mark.parametrize(
    ("departure_s", "expected_s"),
    [(748.0, 94.0), (751.5, 90.5), (800.0, None), (728.0, 114.0), (700.0, 1.3 * 94.0)],
    ids=["on time", "late", "later than the fastest makes good", "early", "much too early"],
)
def test_the_running_time_is_the_time_left_between_fastest_and_slowest(
    departure_s: float, expected_s: float | None
) -> None:
    line = yizhuang()
    _, running_time_s, _ = choose_running_time(line, 4, departure_s)
    assert running_time_s == (line.sections[4].fastest_s if expected_s is None else expected_s)


@pytest.mark.parametrize(
    ("departure_s", "profile", "running_time_s"),
    [(748.0, "normal", 94.0), (752.0, "fast", 90.0), (780.0, "fast", 89.5), (738.0, "economy", 104.0)],
)
def test_regulation_by_profiles_takes_the_slowest_that_is_fast_enough(
    departure_s: float, profile: str, running_time_s: float
) -> None:
    line = yizhuang()
    curves = tuple(make_target(line, 4, time_s, 993.0) for time_s in (89.5, 94.0, 100.0))
    section = replace(line.sections[4], profiles=curves, fastest_s=89.5)
    sections = (*line.sections[:4], section, *line.sections[5:])
    line = replace(line, sections=sections, route=Route(regulation="profiles"))
    name, found_s, curve = choose_running_time(line, 4, departure_s)
    assert name == profile
    assert found_s == pytest.approx(running_time_s, abs=1e-7)
    assert curve is not None
    assert Target(make_target(line, 4, found_s, 993.1, curve)).stop_position_m == pytest.approx(993.1, abs=1e-6)


def test_without_regulation_the_timetable_decides() -> None:
    line = replace(yizhuang(), route=Route(regulation="none"))
    assert choose_running_time(line, 4, 780.0) == ("timetable", 94.0, line.sections[4].target)


def test_a_section_sees_the_profiles_under_the_standing_train() -> None:
    line = yizhuang()
    assert section_line(line, 1).grade_permil[0][0] <= -118.0 + 1e-9


@pytest.mark.parametrize(("mode", "percent"), [("fast", 0.0), ("normal", 5.0), ("economy", 12.0)])
def test_an_ordered_profile_counts_whatever_is_left_of_the_timetable(mode: Mode, percent: float) -> None:
    line = yizhuang()
    wanted_s = line.sections[4].fastest_s * (1 + percent / 100)
    for departure_s in (700.0, 748.0, 900.0):
        name, running_time_s, curve = choose_running_time(line, 4, departure_s, mode)
        assert (name, running_time_s) == (mode, pytest.approx(wanted_s))
        assert curve is None, "the line has no profiles: the curve is generated"
    stops = tuple(replace(stop, mode=mode) for stop in line.stops)
    assert choose_running_time(replace(line, stops=stops), 4, 748.0)[0] == mode
    assert choose_running_time(replace(line, stops=stops), 4, 748.0, "timetable")[0] == "timetable"


def test_a_file_orders_a_profile_for_one_section_or_for_all(tmp_path: Path) -> None:
    def modes(text: str) -> list[str]:
        file = tmp_path / "own.toml"
        file.write_text(f'extends = "yizhuang_out"\nname = "own"\n[route]\nprofiles_percent = [6, 8, 12]\n{text}\n')
        line = load_any(file)
        assert [bool(one.profiles) for one in line.sections] == [stop.mode != "timetable" for stop in line.stops[:-1]]
        return [stop.mode for stop in line.stops]

    assert modes("") == ["timetable"] * 14
    assert modes('mode = "economy"') == ["economy"] * 13 + ["timetable"]
    every = ["timetable"] * 5 + ["fast"] + ["timetable"] * 8
    assert modes(f"mode = {every}") == every


@pytest.mark.parametrize("place", ["C", "D"])
def test_a_stop_without_a_departure_takes_no_order(place: str, tmp_path: Path) -> None:
    text = (DATA / "runs" / "four_stops.toml").read_text().replace('"four_stops"', '"own"')
    (tmp_path / "own.toml").write_text(text.replace(f'name = "{place}",', f'name = "{place}", mode = "fast",'))
    with pytest.raises(InputError, match=r"route\.stops\[[23]\]\.mode: found 'fast', allowed no such key"):
        load_any(tmp_path / "own.toml")
