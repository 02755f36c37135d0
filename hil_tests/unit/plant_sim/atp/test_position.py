"""Position of the front as an interval: golden values, growth without balises, balises at wrong places."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.support.braking_cases import LINE_DATA
from railhil.plant_sim.atp.position import PositionInterval

GOLDEN = json.loads((LINE_DATA / "confidence.json").read_text(encoding="utf-8"))


def interval(*balises: tuple[int, float], accuracy_m: float = 0.5) -> PositionInterval:
    found = PositionInterval(0.02, 0.02, accuracy_m)
    found.survey(balises)
    return found


@pytest.mark.parametrize("row", GOLDEN["rows"], ids=lambda row: f"{row[0]:g} m")
def test_the_interval_is_that_of_independent_programs(row: list[float]) -> None:
    """The file has six decimals of a metre."""
    balise_m, since_m, accuracy_m, over, under, estimated_m, least_m, most_m = row
    place = PositionInterval(over, under, accuracy_m)
    place.survey([(1, balise_m)])
    place.refer(balise_m, 100.0, accuracy_m)
    assert place.read(1, 100.0)
    place.update(100.0 + since_m)
    assert place.estimated_m == pytest.approx(estimated_m, abs=1e-9)
    assert (place.least_m, place.most_m) == pytest.approx((least_m, most_m), abs=1e-6)


def test_over_and_under_reading_are_not_the_same() -> None:
    place = PositionInterval(0.05, 0.01, 0.5)
    place.update(1000.0)
    assert place.least_m == pytest.approx(1000 / 1.05 - 0.5)
    assert place.most_m == pytest.approx(1000 / 0.99 + 0.5)


@given(st.floats(-0.02, 0.02), st.floats(0.0, 5000.0), st.floats(-0.05, 0.05))
def test_the_true_front_is_within_the_interval(wheel: float, run_m: float, survey_error_m: float) -> None:
    """A wheel reads up to 2 % of the true way too much or too little, and the balise lies 5 cm beside its place."""
    place = interval((7, 100.0))
    true_balise_m = 100.0 + survey_error_m
    assert place.read(7, true_balise_m * (1 + wheel))
    place.update((true_balise_m + run_m) * (1 + wheel))
    assert place.least_m <= true_balise_m + run_m <= place.most_m


def test_without_a_balise_the_interval_grows() -> None:
    place = interval((1, 500.0))
    widths = []
    for odometer_m in (0.0, 100.0, 499.0):
        place.update(odometer_m)
        widths.append(place.most_m - place.least_m)
    assert widths == sorted(widths)
    assert widths[0] == 1.0
    assert widths[2] > 20.0
    assert place.read(1, 499.0)
    assert place.most_m - place.least_m == 1.0
    assert place.estimated_m == 500.0


def test_a_balise_that_cannot_be_there_is_ignored_and_counted() -> None:
    place = interval((1, 100.0), (2, 200.0))
    # 2 % of 100 m, and the accuracy of both: 3.04 m.
    assert not place.read(1, 96.9)
    assert (place.ignored, place.ignored_in_a_row) == (1, 1)
    assert place.estimated_m == 96.9
    assert not place.read(9, 100.0)
    assert (place.ignored, place.ignored_in_a_row) == (2, 2)
    assert place.read(2, 200.0)
    assert (place.ignored, place.ignored_in_a_row) == (2, 0)
    assert place.read(2, 203.0) is False


def test_a_balise_at_the_edge_of_both_intervals_counts() -> None:
    for sign in (1.0, -1.0):
        place = interval((1, 100.0))
        assert place.read(1, 100.0 + sign * 0.999 + sign * 1.9)
        assert place.estimated_m == 100.0


def test_a_number_may_stand_at_several_places() -> None:
    place = interval((1, 100.0), (1, 4000.0))
    assert place.read(1, 100.2)
    assert place.estimated_m == 100.0
    assert place.read(1, 3990.0)
    assert place.estimated_m == 4000.0


def test_a_reference_is_at_least_as_wide_as_a_balise() -> None:
    place = interval(accuracy_m=0.5)
    place.refer(10.0, 0.0, 0.1)
    assert (place.least_m, place.estimated_m, place.most_m) == (9.5, 10.0, 10.5)
    place.refer(10.0, 0.0, 3.0)
    assert (place.least_m, place.most_m) == (7.0, 13.0)


@pytest.mark.parametrize("at_m", [1.0, -1.0])
def test_exactly_at_the_edge_is_within(at_m: float) -> None:
    assert interval((1, at_m)).read(1, 0.0)
    assert not interval((1, at_m * 1.001)).read(1, 0.0)
