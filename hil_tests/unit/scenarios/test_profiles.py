"""Profiles over the line: the value at a position, parts of a profile, its mean over a train."""

from __future__ import annotations

import pytest

from railhil.scenarios.profiles import MeanGrade, cut, merge_profiles, profile_value

PROFILE = ((0.0, 5.0), (10.0, 7.0), (20.0, 6.0))


@pytest.mark.parametrize(("position_m", "value"), [(-1.0, 5.0), (0.0, 5.0), (9.9, 5.0), (10.0, 7.0), (30.0, 6.0)])
def test_the_value_at_a_position(position_m: float, value: float) -> None:
    assert profile_value(PROFILE, position_m) == value


@pytest.mark.parametrize(
    ("from_m", "to_m", "rows"),
    [(0.0, 10.0, [0]), (10.0, 20.0, [1]), (3.0, 12.0, [0, 1]), (1.0, 2.0, [0]), (25.0, 30.0, [2]), (-9.0, -5.0, [0])],
)
def test_the_rows_between_two_positions(from_m: float, to_m: float, rows: list[int]) -> None:
    assert cut(PROFILE, from_m, to_m) == tuple(PROFILE[row] for row in rows)


def test_rows_that_repeat_the_value_before_them_are_left_out() -> None:
    assert merge_profiles(((0.0, 5.0), (5.0, 0.0), (7.0, 0.0), (9.0, 5.0))) == ((0.0, 5.0), (5.0, 0.0), (9.0, 5.0))
    assert merge_profiles(()) == ()


def test_the_mean_grade_is_extreme_where_the_train_has_left_a_row() -> None:
    mean = MeanGrade(((0.0, 0.0), (100.0, 8.0), (120.0, -2.0)), 40.0)
    assert mean.extremes(60.0, 300.0) == (-2.0, pytest.approx(4.0))
    assert set(mean.breakpoints_m) == {0.0, 40.0, 100.0, 120.0, 140.0, 160.0}
