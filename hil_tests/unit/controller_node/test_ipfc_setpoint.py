"""Set-points by time and by distance, against the exact target curve."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.laws.base import SPEED_Q
from railhil.controller_node.setpoint import SetPoints
from railhil.scenarios.load import load, names
from railhil.scenarios.model import TargetCurve
from railhil.scenarios.target import Target

SCENARIO = load("lvshun_tieshan")
TARGET = Target(SCENARIO.target)
LSB_KMH = 2.0**-SPEED_Q


def kmh(arithmetic: str, indexing: str, k: int, position_01mm: int) -> list[float]:
    number = make(arithmetic)
    set_point, preview = SetPoints(number, SCENARIO, indexing, 10).at(k, position_01mm)
    return [number.raw(value, SPEED_Q) / 2**SPEED_Q for value in (set_point, *preview)]


@pytest.mark.parametrize("arithmetic", ["float64", "iq", "iq-portable"])
@pytest.mark.parametrize("k", [0, 1, 47, 260, 388, 395, 400])
def test_time_indexing_is_the_curve(arithmetic: str, k: int) -> None:
    times = (k + np.arange(11)) * 0.5
    np.testing.assert_allclose(kmh(arithmetic, "time", k, 0), TARGET.speed_mps(times) * 3.6, atol=0.51 * LSB_KMH)


def test_speed_becomes_virtually_negative_after_the_stop() -> None:
    points = kmh("iq", "time", 390, 0)
    # 195 s: the stop; then the last deceleration, 0.35 m/s2, goes on.
    np.testing.assert_allclose(points, -0.35 * 3.6 * 0.5 * np.arange(11), atol=1e-5)


def test_set_point_at_the_stop_is_exactly_zero_in_float64() -> None:
    """A law may ask whether it is below zero: fuzzy PID takes its traction away then."""
    set_point, preview = SetPoints(make("float64"), SCENARIO, "time", 4).at(390, 0)
    assert (set_point, preview[0] < 0.0) == (0.0, True)


@pytest.mark.parametrize("name", names())
def test_sign_of_every_set_point_is_the_same_in_float64_and_fixed_point(name: str) -> None:
    scenario = load(name)
    wide, fixed = (SetPoints(make(arithmetic), scenario, "time", 1) for arithmetic in ("float64", "iq"))
    for k in range(int(scenario.plan.running_time_s / 0.5) + 20):
        assert np.sign(wide.at(k, 0)[0]) == np.sign(fixed.at(k, 0)[0])


def test_beyond_the_table_its_last_entries_hold() -> None:
    last = kmh("iq", "time", 410, 0)
    assert kmh("iq", "time", 5000, 0) == last
    assert kmh("iq", "time", -3, 0) == kmh("iq", "time", 0, 0)


@pytest.mark.parametrize("arithmetic", ["float64", "iq", "iq-portable"])
@pytest.mark.parametrize("position_m", [5.1, 50.0, 700.0, 1500.0, 2800.0, 2939.0])
def test_distance_indexing_is_the_curve_at_the_position(arithmetic: str, position_m: float) -> None:
    points = kmh(arithmetic, "distance", 3, round(position_m * 1e4))
    time_s = float(TARGET.time_s(position_m))
    expected = TARGET.speed_mps(time_s + np.arange(11) * 0.5) * 3.6
    # 0.1 mm of position between table entries and 0.1 mm of resolution, at the acceleration over speed there.
    slack_kmh = 3.6 * 2e-4 * 0.8 / TARGET.speed_mps(time_s)
    np.testing.assert_allclose(points, expected, atol=slack_kmh + 2 * LSB_KMH)


def test_distance_indexing_starts_by_time() -> None:
    assert kmh("iq", "distance", 4, 49_999) == kmh("iq", "time", 4, 0)
    assert kmh("iq", "distance", 4, 50_000) == kmh("iq", "time", 4, 0)
    assert kmh("iq", "distance", 4, 50_001) != kmh("iq", "time", 4, 0)


def test_distance_indexing_past_the_stop_asks_for_zero_and_below() -> None:
    points = kmh("iq", "distance", 390, 29_410_000)
    assert points[0] == pytest.approx(0.0, abs=1e-5)
    assert points == kmh("iq", "distance", 390, 29_400_500)
    np.testing.assert_allclose(np.diff(points), -0.35 * 0.5 * 3.6, atol=1e-5)


@pytest.mark.parametrize("indexing", ["time", "distance"])
@pytest.mark.parametrize("arithmetic", ["float64", "iq", "iq-portable"])
def test_many_trains_get_the_set_points_of_each(arithmetic: str, indexing: str) -> None:
    positions = np.array([0, 49_999, 50_001, 7_000_000, 29_399_999, 29_500_000])
    many = SetPoints(make(arithmetic, batch=True), SCENARIO, indexing, 10)
    one = SetPoints(make(arithmetic), SCENARIO, indexing, 10)
    set_point, preview = many.at(7, positions)
    for train, position in enumerate(positions.tolist()):
        expected_point, expected_preview = one.at(7, position)
        assert np.broadcast_to(set_point, 6)[train] == expected_point
        assert [np.broadcast_to(ahead, 6)[train] for ahead in preview] == list(expected_preview)


def test_unknown_indexing_is_one_line() -> None:
    with pytest.raises(InputError, match=r"^indexing: name: found 'tme', allowed one of time, distance$"):
        SetPoints(make("iq"), SCENARIO, "tme", 10)


def test_distance_indexing_needs_a_distance() -> None:
    hop: Any = replace(SCENARIO, target=TargetCurve(((0.0, 0.5), (2.0, 0.5), (2.1, -0.5))))
    with pytest.raises(InputError, match="more than 5 m"):
        SetPoints(make("iq"), hop, "distance", 10)
    assert SetPoints(make("iq"), hop, "time", 10).at(0, 0)[0] == 0
