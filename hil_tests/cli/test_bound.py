"""``railhil bound``: the least work of a scenario's sections, as a table and as JSON, and what has none."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.cli import Railhil, complaint
from railhil.scenarios.system import System

#: 400 m of level track: the programme is quick.
SHORT = """\
schema_version = 1
name = "short"
title = "Short"
extends = "yizhuang_05"
line = { name = "flat: A - B", grade_permil = [[-118, 0]], speed_limit_kmh = [[-118, 60]] }
target = { generate = {} }
plan = { distance_m = 400, running_time_s = %s }
"""


@pytest.fixture
def short(tmp_path: Path) -> Path:
    path = tmp_path / "short.toml"
    path.write_text(SHORT % "60")
    return path


def test_the_table_names_section_times_and_work(here: Railhil, short: Path) -> None:
    done = here("bound", short)
    assert done.exit_code == 0
    row = next(line for line in done.out.splitlines() if line.startswith("A - B")).split()
    running_time_s, least_s, ideal_kj, ideal_run_kj, comfort_kj, comfort_run_kj = map(float, row[3:])
    assert least_s < running_time_s == 60.0
    assert ideal_run_kj == pytest.approx(ideal_kj, rel=0.003)
    assert comfort_run_kj == pytest.approx(comfort_kj, rel=0.003)
    assert ideal_kj < comfort_kj
    assert "the dual value, a lower bound" in done.out
    assert "sum" not in done.out


def test_json_has_both_values_and_the_sums(here: Railhil, short: Path) -> None:
    document = here("bound", short, "--json").json
    (section,) = document["sections"]
    assert (section["name"], section["length_m"], section["running_time_s"]) == ("A - B", 400.0, 60.0)
    for kind in ("ideal", "comfort"):
        assert section[kind]["bound_kj"] == min(section[kind]["dual_kj"], section[kind]["feasible_kj"])
        assert document["total"][kind] == section[kind]
    assert section["ideal"]["bound_kj"] < section["comfort"]["bound_kj"]


def test_a_time_too_short_for_comfort_has_no_bound_of_that_kind(here: Railhil, short: Path) -> None:
    fast = "braking_max_mps2 = 1.0, traction_utilisation = 1.0, speed_margin_kmh = 0, jerk_max_mps3 = 5.0"
    short.write_text(SHORT.replace("generate = {}", f"generate = {{ {fast} }}") % "49")
    document = here("bound", short, "--json").json
    assert document["sections"][0]["ideal"]["bound_kj"] > 0.0
    assert document["sections"][0]["comfort"] is None
    assert document["total"]["comfort"] is None
    row = next(line for line in here("bound", short).out.splitlines() if line.startswith("A - B"))
    assert row.split()[-2:] == ["-", "-"]


def test_each_section_of_a_line_has_a_row_and_the_sum_stands_below(here: Railhil) -> None:
    done = here("bound", "four_stops", "--json")
    names = [section["name"] for section in done.json["sections"]]
    assert names == ["A - B", "B - D"]
    assert done.json["total"]["length_m"] == sum(section["length_m"] for section in done.json["sections"])
    shown = here("bound", "four_stops").out.splitlines()
    assert [line.split()[0] for line in shown if line[:3] in ("A -", "B -", "sum")] == ["A", "B", "sum"]


def test_a_scenario_of_another_system_is_refused_with_those_that_have_bounds(here: Railhil) -> None:
    line = complaint(here("bound", "jinan_xuzhou"))
    assert "of system hst1" in line
    assert "ato" in line


def test_a_system_without_the_part_has_none() -> None:
    assert System("x", "x", "x:x", "x:x", "x:x", "x", "x", "x:x", "x:x").optional_part("bound") is None
