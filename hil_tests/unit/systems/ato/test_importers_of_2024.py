"""Running paths of railtoolkit 2024.07 and tracks of TTOBench 1.4, from the file to the verdict of a run."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pytest

from hil_tests.support.paths import TEST_DATA
from railhil.bench import unrecorded_run
from railhil.common.errors import InputError
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.importers import railtoolkit, ttobench
from railhil.systems.ato.scenario.importers.section import Stop

VALLEY = TEST_DATA / "railtoolkit" / "paths" / "valley_2024_07.yaml"
TUNNELS = TEST_DATA / "ttobench" / "two_tunnels.json"


def scenario_on(folder: Path, line: str, distance_m: float) -> Path:
    """A scenario of a metro train on an imported line."""
    path = folder / "mine.toml"
    path.write_text(
        f"""
schema_version = 1
name = "mine"
title = "t"
[train]
file = "yizhuang_b6"
[line]
{line}
[plan]
distance_m = {distance_m}
running_time_reserve_percent = 8
stop_error_max_m = 0.5
time_error_max_s = 3
[target.generate]
[sensors]
speed_lsb_kmh = 0.01
odometer_lsb_m = 0.01
[energy]
xi_m = 0.9
xi_b = 0
auxiliary_power_kw = 40
""",
        encoding="utf-8",
    )
    return path


def changed(tmp_path: Path, source: Path, old: str, new: str) -> Path:
    text = source.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / source.name
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


def test_a_section_keeps_the_speed_and_the_resistance_of_the_one_before() -> None:
    line = railtoolkit.load_line(VALLEY, train_length_m=100.0).line
    assert line.name == "Valley line"
    assert line.grade_permil == ((0.0, 0.0), (600.0, -8.0), (1200.0, 5.0), (1900.0, 0.0))
    assert line.speed_limit_mps == ((0.0, 60 / 3.6), (300.0, 80 / 3.6), (1500.0, 70 / 3.6))


def test_stops_are_front_and_middle_points_by_label_or_id() -> None:
    whole = railtoolkit.load_line(VALLEY, train_length_m=100.0)
    names = [Stop("start", 0.0), Stop("Mill", 250.0), Stop("distant signal", 1300.0), Stop("Weir", 1850.0)]
    assert whole.stops == (*names, Stop("end", 2200.0))
    unused = "not used of its file: 1 of the points of interest (measured at the rear, or outside the path)"
    assert whole.remarks == (unused, "level where its file has no resistance: 0 to 600 m")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("        speed: 60\n", "", "characteristic_sections[0].speed: missing, expected a speed at the start"),
        ("speed: 80", "speed: null", "speed: found None, allowed a number"),
        ("speed: 80", "speed: 0", "found 0"),
        ("measure: rear", "measure: tail", "found 'tail'"),
        ("id: Weir", "name: Weir", "points_of_interest[1].label: missing"),
        ("position: 600", "position: 300", "increasing positions"),
        ('"2024.07"', '"2024.08"', "found '2024.08', allowed the text '2022.05' or '2024.07'"),
    ],
)
def test_bad_paths_give_one_line(old: str, new: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        railtoolkit.load_line(changed(tmp_path, VALLEY, old, new), train_length_m=100.0)
    assert "\n" not in str(caught.value)
    assert words in str(caught.value)


@pytest.mark.parametrize("minor", range(1, 6))
def test_tracks_of_every_version_are_read(minor: int, tmp_path: Path) -> None:
    track = ttobench.load_line(changed(tmp_path, TUNNELS, "v1.4", f"v1.{minor}"))
    assert [stop.position_m for stop in track.stops] == [0.0, 900.0, 2200.0]
    assert track.remarks == ("not used of its file: curvatures, tunnels",)


LINES: Mapping[str, tuple[Path, str, str, float]] = {
    "railtoolkit": (VALLEY, 'from_stop = "Mill"\nto_stop = "Weir"', "not used of its file: 1 of the points", 1600.0),
    "ttobench": (TUNNELS, "from_stop = 0\nto_stop = 1", "not used of its file: curvatures, tunnels", 900.0),
}


@pytest.mark.parametrize("key", LINES)
def test_a_run_on_an_imported_line_comes_to_its_verdict(key: str, tmp_path: Path) -> None:
    file, stops, remark, distance_m = LINES[key]
    line = f"{key} = {json.dumps(str(file))}\n{stops}\nbalises_before_stop_m = [150, 40, 5, 0]"
    scenario = load(scenario_on(tmp_path, line, distance_m))
    assert any(remark in sentence for sentence in scenario.assumptions)
    result = unrecorded_run(scenario, RunSpec(law=LawSpec("ipfc_plus")))
    assert result.verdict == "PASS", result.failures
