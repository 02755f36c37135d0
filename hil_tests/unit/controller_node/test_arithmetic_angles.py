"""asin, acos, atan2 and atan2PU against 80 decimal digits, in all formats; the faults of the portable library."""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction

import pytest

from hil_tests.exact import FORMATS, PI, nearest, rounded, sine, spread, with_many_digits
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from railhil.controller_node.arithmetic.iq import C28, Portable


@pytest.fixture(autouse=True)
def _digits() -> None:
    with_many_digits()


def edges(result: int, q: int) -> tuple[Decimal, Decimal]:
    """Half an LSB below a result and half an LSB above it."""
    return (Decimal(result) - Decimal("0.5")) / 2**q, (Decimal(result) + Decimal("0.5")) / 2**q


def is_left_of(y: int, x: int, angle: Decimal) -> bool:
    """Does the point (x, y) lie on or to the left of a ray, by at most half a turn?"""
    return y * sine(angle + PI / 2) >= x * sine(angle)


def test_inverse_sine_and_cosine() -> None:
    for q in range(1, 30):
        ar, portable = C28(), Portable()
        one = 1 << q
        for a in {0, 1, -1, one >> 1, -one >> 1, one - 1, one, -one, *(a % (2 * one + 1) - one for a in spread(q))}:
            below, above = edges(ar.asin(a, q), q)
            assert below <= -PI / 2 or sine(below) <= Decimal(a) / one
            assert above >= PI / 2 or Decimal(a) / one <= sine(above)
            below, above = edges(ar.acos(a, q), q)
            assert below <= 0 or sine(below + PI / 2) >= Decimal(a) / one
            assert above >= PI or Decimal(a) / one >= sine(above + PI / 2)
            assert abs(portable.asin(a, q) - ar.asin(a, q)) <= 4
            assert abs(portable.acos(a, q) - ar.acos(a, q)) <= 4
        assert (ar.asin(0, q), ar.acos(one, q), ar.counters.saturations) == (0, 0, 0)
        half_pi = rounded(PI / 2, q)
        for beyond in (one + 1, INT32_MAX):
            assert (ar.asin(beyond, q), ar.asin(-beyond, q)) == (half_pi, -half_pi)
            assert (ar.acos(beyond, q), ar.acos(-beyond, q)) == (0, rounded(PI, q))
            assert (portable.asin(beyond, q), portable.asin(-beyond, q)) == (0, 0)
            assert portable.acos(beyond, q) == portable.acos(-beyond, q) == int(Decimal("1.570796327") * one)
        assert ar.counters.saturations == 8


def test_angle_of_a_point() -> None:
    for q in FORMATS:
        ar, portable = C28(), Portable()
        points = zip(spread(q + 100), spread(q + 200)[::-1], strict=True)
        # Eighths of a turn stand below.
        for y, x in ((y, x) for y, x in points if abs(y) != abs(x) and x and y):
            turn = ar.atan2_pu(y, x, q)
            below, above = (2 * PI * edge for edge in edges(turn, q))
            assert is_left_of(y, x, below)
            assert not is_left_of(y, x, above)
            assert abs(portable.atan2_pu(y, x, q) + (1 << q if y < 0 else 0) - turn) <= 16
            if q < 30:
                angle = ar.atan2(y, x, q)
                below, above = edges(angle, q)
                assert below < -PI or is_left_of(y, x, below)
                assert above > PI or not is_left_of(y, x, above)
                # The size: the library's sign is wrong next to half a turn.
                assert abs(abs(portable.atan2(y, x, q)) - abs(angle)) <= 16


def test_eighths_of_a_turn() -> None:
    """The only results that can be ties: ties upward in Q1 and Q2."""
    for q in FORMATS:
        ar = C28()
        around = [(0, 3), (3, 3), (3, 0), (3, -3), (0, -3), (-3, -3), (-3, 0), (-3, 3)]
        for eighth, (y, x) in enumerate(around):
            assert ar.atan2_pu(y, x, q) == nearest(Fraction(eighth << q, 8))
            if q < 30:
                assert ar.atan2(y, x, q) == rounded((eighth if eighth < 5 else eighth - 8) * PI / 4, q)
        assert ar.atan2_pu(0, 0, q) == 0
        assert abs(Portable().atan2_pu(0, 0, q) - (1 << q) / 8) <= 1


def test_the_librarys_faults_of_atan2_are_reproduced() -> None:
    portable = Portable()
    assert portable.atan2(3 << 24, 3 << 24, 24) == pytest.approx(-1.8807 * 2**24, rel=1e-4)
    assert (portable.atan2(2, INT32_MIN, 24), C28().atan2(2, INT32_MIN, 24)) == (-52707179, 52707179)
    assert portable.atan2(INT32_MIN, INT32_MIN, 24) == pytest.approx(-3 * math.pi / 4 * 2**24, abs=2)
