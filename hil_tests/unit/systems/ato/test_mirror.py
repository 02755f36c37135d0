"""A line mirrored for the return direction: the profiles that come with the specification, and its own inverse."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.support.paths import TEST_DATA
from railhil.scenarios.layers import DATA
from railhil.scenarios.profiles import profile_value
from railhil.systems.ato.scenario.importers import ttobench
from railhil.systems.ato.scenario.mirror import mirror_line
from railhil.systems.ato.scenario.model import Balise, Line

LENGTH_M, TRAIN_M = 22_728.0, 118.0
YIZHUANG = ttobench.load_line(DATA / "sources" / "yizhuang_line" / "CN_Songjiazhuang_Yizhuang.json").line


def test_the_return_profiles_of_yizhuang_are_those_of_the_specification() -> None:
    back = json.loads((TEST_DATA / "line" / "return_profiles.json").read_text())
    line = mirror_line(YIZHUANG, LENGTH_M, TRAIN_M)
    assert [list(row) for row in line.grade_permil] == back["grade_permil"]
    assert [at_m for at_m, _ in line.speed_limit_mps] == [at_m for at_m, _ in back["speed_limit_kmh"]]
    assert [mps * 3.6 for _, mps in line.speed_limit_mps] == pytest.approx([kmh for _, kmh in back["speed_limit_kmh"]])


def test_level_track_has_no_negative_zero() -> None:
    line = mirror_line(Line("level", ((0.0, 0.0), (50.0, 2.0)), ((0.0, 20.0),)), 100.0, 30.0)
    assert [str(permil) for _, permil in line.grade_permil] == ["-2.0", "0.0"]


def test_rows_that_begin_at_the_end_of_the_line_are_left_out() -> None:
    line = mirror_line(Line("x", ((0.0, 1.0), (100.0, 2.0)), ((0.0, 20.0), (130.0, 10.0))), 100.0, 30.0)
    assert line.grade_permil == ((-30.0, -1.0),)
    assert line.speed_limit_mps == ((-30.0, 20.0),)


def test_balises_keep_their_places_and_numbers_in_the_order_of_the_return_run() -> None:
    line = Line("x", ((0.0, 0.0),), ((0.0, 20.0),), (Balise(1, 10.0, 10.5), Balise(2, 60.0, 60.0)))
    assert mirror_line(line, 100.0, 30.0).balises == (Balise(2, 10.0, 10.0), Balise(1, 60.0, 59.5))


@given(
    steps=st.lists(st.tuples(st.integers(1, 200), st.integers(-30, 30)), min_size=1, max_size=8),
    ends_m=st.integers(1, 100),
    train_m=st.integers(1, 100),
    share=st.floats(0.001, 0.999),
)
def test_each_place_has_the_opposite_grade_and_the_same_limit(
    steps: list[tuple[int, int]], ends_m: int, train_m: int, share: float
) -> None:
    at_m, rows = -float(train_m), []
    for length_m, value in steps:
        rows.append((at_m, float(value)))
        at_m += length_m
    length_m = at_m + ends_m
    line = Line("x", tuple(rows), tuple((from_m, 50.0 + value) for from_m, value in rows))
    back = mirror_line(line, length_m, train_m)
    place_m = -train_m + share * (length_m + train_m)
    if min(abs(place_m - from_m) for from_m, _ in rows) > 1e-6:
        mirrored_m = length_m - train_m - place_m
        assert profile_value(back.grade_permil, mirrored_m) == -profile_value(line.grade_permil, place_m)
        assert profile_value(back.speed_limit_mps, mirrored_m) == profile_value(line.speed_limit_mps, place_m)
    twice = mirror_line(back, length_m, train_m)
    assert all(
        profile_value(twice.grade_permil, x + 1e-6) == profile_value(line.grade_permil, x + 1e-6) for x, _ in rows
    )
