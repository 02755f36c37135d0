"""The shipped bounds of Yizhuang's sections are those of the golden values, and every section has one."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.scenarios.load import load_any
from railhil.systems.ato.energy.programme import energy_bound
from railhil.systems.line.scenario.model import LineScenario
from railhil.systems.line.scenario.sections import section_scenario
from railhil.systems.line.shipped_bounds import has_shipped_bounds, shipped_bound_kj


def line_named(name: str) -> LineScenario:
    line = load_any(name)
    assert isinstance(line, LineScenario)
    return line


@pytest.mark.parametrize("name", ["yizhuang_out", "yizhuang_back", "yizhuang_round", "four_stops", "zurich"])
def test_every_section_has_a_bound(name: str) -> None:
    line = line_named(name)
    for number, section in enumerate(line.sections, start=1):
        assert shipped_bound_kj(line, number, section.running_time_s) is not None
        assert shipped_bound_kj(line, number, section.fastest_s) is not None
    assert has_shipped_bounds(line)


def test_bounds_are_the_golden_ones() -> None:
    line = line_named("yizhuang_out")
    golden = json.loads((TEST_DATA / "line" / "line_bounds.json").read_text())["sections"]
    assert len(golden) == len(line.sections)
    for number, row in enumerate(golden, start=1):
        assert shipped_bound_kj(line, number, row["timetable_s"]) == pytest.approx(row["comfort_kJ"], rel=0.005)


def test_a_bound_falls_with_the_time_and_belongs_to_its_section() -> None:
    line = line_named("yizhuang_out")
    first = line.sections[0].running_time_s
    at, later = shipped_bound_kj(line, 1, first), shipped_bound_kj(line, 1, first + 2.0)
    assert at is not None
    assert later is not None
    assert later < at
    assert shipped_bound_kj(line, 1, 0.9 * first) is None
    for time_s in (140.0, 150.0, 151.5, 158.0, 173.0):
        assert shipped_bound_kj(line_named("four_stops"), 2, time_s + 6.0) < shipped_bound_kj(  # type: ignore[operator]
            line_named("four_stops"), 2, time_s + 5.0
        )
    heavier = replace(line, train=replace(line.train, mass_kg=line.train.mass_kg * 1.01))
    assert shipped_bound_kj(heavier, 1, first) is None
    assert not has_shipped_bounds(heavier)


@pytest.mark.slow
def test_between_the_rows_the_bound_is_a_little_below_that_of_a_new_search() -> None:
    line = line_named("four_stops")
    for time_s in (147.0, 165.0):
        told, found = shipped_bound_kj(line, 2, time_s), energy_bound(section_scenario(line, 1), time_s, "comfort")
        assert told is not None
        assert 0.985 * found.bound_kj < told < 1.003 * found.bound_kj
