"""Traction is taken off before the train would reach the permitted speed, if the line asks for it."""

from __future__ import annotations

import pytest

from railhil.bus.layout import CHECK_ERRONEOUS
from railhil.controller_node.line.heed import AGE_MAX_MS, PermittedSpeed
from railhil.wire.line import AtpLim, AtpStatus


def told(speeds_01mmps: list[int], permitted_4mmps: int = 5000) -> PermittedSpeed:
    """A permitted speed of 20 m/s, and the train's speed at each telegram, 80 ms apart."""
    permitted = PermittedSpeed()
    for number, speed_01mmps in enumerate(speeds_01mmps):
        permitted.take(AtpLim(permitted_4mmps=permitted_4mmps, life=number & 15), speed_01mmps, 80 * number)
    return permitted


@pytest.mark.parametrize(
    ("speeds_01mmps", "allows"),
    [
        ([195_000, 195_000], True),
        # 1 m/s2: 0.4 m/s below the permitted speed, which is reached in 0.4 s; 0.7 m/s below it, in 0.7 s.
        ([195_200, 196_000], False),
        ([192_200, 193_000], True),
        ([201_000, 199_000], True),
        ([200_800, 200_100], False),
    ],
)
def test_traction_is_off_half_a_second_before_the_permitted_speed(speeds_01mmps: list[int], allows: bool) -> None:
    assert told(speeds_01mmps).allows(80) is allows


def test_without_fresh_telegrams_nothing_is_limited() -> None:
    permitted = told([195_200, 196_000])
    assert not permitted.allows(80 + AGE_MAX_MS)
    assert permitted.allows(81 + AGE_MAX_MS)


def test_telegrams_that_repeat_or_are_not_correct_count_nothing() -> None:
    permitted = PermittedSpeed()
    permitted.take(AtpLim(status=AtpStatus.WARNING, life=3), 0, 0)
    permitted.take(AtpLim(status=AtpStatus.WARNING, life=3), 0, 80)
    permitted.take(AtpLim(status=AtpStatus.WARNING, life=4, check=CHECK_ERRONEOUS), 0, 160)
    assert permitted.told[AtpStatus.WARNING] == sum(permitted.told) == 1
