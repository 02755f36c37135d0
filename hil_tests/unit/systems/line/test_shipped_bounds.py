"""The shipped bounds of Yizhuang's sections are those of the golden values, and every section has one."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.scenarios.load import load_any
from railhil.systems.line.scenario.model import LineScenario
from railhil.systems.line.shipped_bounds import shipped_bound_kj


def line_named(name: str) -> LineScenario:
    line = load_any(name)
    assert isinstance(line, LineScenario)
    return line


@pytest.mark.parametrize("name", ["yizhuang_out", "yizhuang_back", "yizhuang_round"])
def test_every_section_has_a_bound(name: str) -> None:
    line = line_named(name)
    for number, section in enumerate(line.sections, start=1):
        assert shipped_bound_kj(line, number, section.running_time_s) is not None


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
    heavier = replace(line, train=replace(line.train, mass_kg=line.train.mass_kg * 1.01))
    assert shipped_bound_kj(heavier, 1, first) is None
    assert shipped_bound_kj(line_named("four_stops"), 1, 107.0) is None
