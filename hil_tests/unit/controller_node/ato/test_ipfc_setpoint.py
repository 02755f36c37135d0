"""Set-points by time and by distance, against the exact target curve."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hil_tests.support import shipped
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.setpoint import SetPoints
from railhil.controller_node.laws.base import SPEED_Q
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import TargetCurve
from railhil.systems.ato.scenario.target import Target

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


@pytest.mark.parametrize("name", shipped.ATO)
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


@pytest.mark.parametrize("arithmetic", ["float64", "iq"])
def test_distance_indexing_is_the_curve_from_its_first_position_on(arithmetic: str) -> None:
    for position_01mm in (50_001, 50_100, 52_000):
        time_s = float(TARGET.time_s(position_01mm / 1e4))
        expected = TARGET.speed_mps(time_s + np.arange(11) * 0.5) * 3.6
        np.testing.assert_allclose(kmh(arithmetic, "distance", 3, position_01mm), expected, atol=5e-4)


def test_at_the_last_entries_of_a_slow_stop() -> None:
    """0.01 m/s2: the last two entries of the table have the same position, to 0.1 mm."""
    slow = replace(SCENARIO, target=TargetCurve(((0.0, 0.5), (3.9, 0.5), (4.1, -0.01), (300.0, -0.01))))
    stop_01mm = round(Target(slow.target).stop_position_m * 1e4)
    for arithmetic in ("float64", "iq"):
        number = make(arithmetic)
        points = SetPoints(number, slow, "distance", 2)
        past = [points.at(600, stop_01mm + away)[0] for away in (1, 2, 100)]
        assert past[0] == past[1] == past[2] == number.raw(past[2], SPEED_Q) == 0


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


def test_the_table_ends_with_the_overtime_of_plan_or_target() -> None:
    """205 s are 410 periods; 206.2 s a part of one more. Later the entry of that period holds."""
    late = replace(SCENARIO, plan=replace(SCENARIO.plan, running_time_s=196.2))
    early = replace(SCENARIO, plan=replace(SCENARIO.plan, running_time_s=190.0))
    for scenario, last_k in ((SCENARIO, 410), (late, 413), (early, 410)):
        points = SetPoints(make("float64"), scenario, "time", 3)
        for k in (last_k - 1, last_k, last_k + 1, last_k + 50):
            times_s = (min(k, last_k) + np.arange(4)) * 0.5
            set_point, preview = points.at(k, 0)
            assert [set_point, *preview] == pytest.approx(TARGET.speed_mps(times_s) * 3.6)


def test_virtual_speeds_end_at_minus_100_kmh() -> None:
    """4 m/s2: -144 km/h after 10 s."""
    hard: Any = replace(SCENARIO, target=TargetCurve(((0.0, 4.0), (9.0, 4.0), (11.0, -4.0), (20.0, -4.0))))
    points = SetPoints(make("float64"), hard, "time", 10).at(10_000, 0)
    assert [points[0], *points[1]] == [-100.0] * 11


@pytest.mark.parametrize(("share", "kept"), [(0.45, False), (0.55, True), (1.5, True)])
def test_a_set_point_below_half_a_bit_is_zero(share: float, kept: bool) -> None:
    """v = a t, with this share of a bit at 0.5 s."""
    accel = share * LSB_KMH / 3.6 / 0.5
    creeping = replace(SCENARIO, target=TargetCurve(((0.0, accel), (100.0, accel), (101.0, -1.0), (102.0, -1.0))))
    set_point, _ = SetPoints(make("float64"), creeping, "time", 1).at(1, 0)
    assert (set_point != 0.0) == kept


def test_unknown_indexing_is_one_line() -> None:
    with pytest.raises(InputError, match=r"^indexing: name: found 'tme', allowed one of time, distance$"):
        SetPoints(make("iq"), SCENARIO, "tme", 10)


def test_distance_indexing_needs_a_distance() -> None:
    hop: Any = replace(SCENARIO, target=TargetCurve(((0.0, 0.5), (2.0, 0.5), (2.1, -0.5))))
    with pytest.raises(InputError, match="more than 5 m"):
        SetPoints(make("iq"), hop, "distance", 10)
    assert SetPoints(make("iq"), hop, "time", 10).at(0, 0)[0] == 0
    five_metres: Any = replace(SCENARIO, target=TargetCurve(((0.0, 0.3), (10.0, -0.3))))
    with pytest.raises(InputError, match="found '5 m to the stop', allowed more than 5 m"):
        SetPoints(make("iq"), five_metres, "distance", 10)
