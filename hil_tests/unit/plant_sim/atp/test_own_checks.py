"""The protection's checks of its own readings, at their limits."""

from __future__ import annotations

from math import inf, nan

import pytest

from railhil.plant_sim.atp.own_checks import SelfTest


@pytest.mark.parametrize("row", [(nan, 1.0, 1.0), (1.0, inf, 1.0), (1.0, 1.0, -inf), (1.0, -0.001, 1.0)])
def test_readings_that_cannot_be(row: tuple[float, float, float]) -> None:
    assert not SelfTest().is_healthy(*row)
    assert SelfTest().is_healthy(1.0, 0.0, 1.0)


@pytest.mark.parametrize(
    ("step_s", "is_healthy"), [(0.35, True), (0.351, False), (0.0, False), (-0.1, False), (0.01, True)]
)
def test_the_time_between_two_looks(step_s: float, is_healthy: bool) -> None:
    checks = SelfTest()
    assert checks.is_healthy(0.0, 0.0, 5.0)
    assert checks.is_healthy(step_s, 0.0, 5.0) is is_healthy


def looks(checks: SelfTest, count: int, speed_mps: float, more_m: float, start: tuple[float, float]) -> list[bool]:
    """Looks every 250 ms; the odometer reads ``more_m`` too much in each."""
    time_s, odometer_m = start
    found = []
    for number in range(1, count + 1):
        way_m = (speed_mps * 0.25 + more_m) * number
        found.append(checks.is_healthy(time_s + 0.25 * number, speed_mps, odometer_m + way_m))
    return found


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_odometer_and_speed_differ_by_a_metre_at_most(sign: float) -> None:
    checks = SelfTest()
    assert checks.is_healthy(0.0, 8.0, 0.0)
    assert checks.is_healthy(0.25, 8.0, 2.0 + sign)
    assert not checks.is_healthy(0.5, 8.0, 4.0 + sign * 1.0078125)


def test_the_mean_speed_of_a_step_counts() -> None:
    checks = SelfTest()
    assert checks.is_healthy(0.0, 0.0, 0.0)
    # 0 to 12 m/s in 0.25 s: 1.5 m.
    assert checks.is_healthy(0.25, 12.0, 0.5)
    assert not checks.is_healthy(0.5, 12.0, 3.484375)


def test_the_difference_is_that_of_the_last_20_m() -> None:
    """8 m/s: 20 m are 10 looks, and only behind them the comparison begins again."""
    for gone_before in (0, 11):
        checks = SelfTest()
        assert checks.is_healthy(0.0, 8.0, 0.0)
        assert all(looks(checks, gone_before, 8.0, 0.0898, (0.0, 0.0)))
        start = 0.25 * gone_before, (2.0 + 0.0898) * gone_before
        assert looks(checks, 11, 8.0, 0.09375, start) == [True] * 10 + [False]


def test_the_comparison_begins_again_directly_behind_20_m() -> None:
    checks = SelfTest()
    assert checks.is_healthy(0.0, 0.5, 0.0)
    # 161 looks of 12.5 cm.
    assert all(looks(checks, 170, 0.5, 1 / 161.5, (0.0, 0.0)))
    checks = SelfTest()
    assert checks.is_healthy(0.0, 0.5, 0.0)
    assert looks(checks, 161, 0.5, 1 / 160.5, (0.0, 0.0))[-1] is False
