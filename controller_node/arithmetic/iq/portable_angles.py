"""Inverse sine and four-quadrant arctangent of the portable profile
(:mod:`railhil.controller_node.arithmetic.iq.portable`).

The library has one polynomial for each 1/32 of the argument: of third order for the arctangent in turns (Q32), of
fourth for the inverse sine in rad (Q29). Both interpolate the exact function at the ends of the cell and at equal steps
in between. The library's coefficients differ from the exact ones by a few units, like the solution of an
ill-conditioned system in doubles; the differences are listed here.

Two faults of the library affect its results and are therefore reproduced: arguments of equal magnitude (atan2(3, 3) =
-1.88), and the sign of ``atan2`` within about one LSB of half a turn.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache

from railhil.controller_node.arithmetic.base import INT32_MAX
from railhil.controller_node.arithmetic.iq import portable_functions as functions
from railhil.controller_node.arithmetic.iq import series
from railhil.controller_node.arithmetic.iq.core import MASK, low32
from railhil.controller_node.arithmetic.iq.interface import check_trig_format

#: Cells of the argument 0..1.
_CELLS = 32
#: Extra fraction bits of the function values that the polynomials interpolate.
_BITS = 64
#: Both truncated.
_RIGHT_ANGLE_Q29, _TURN_Q28 = (series.pi(q + _BITS) >> _BITS for q in (28, 29))
#: Right angle used by the library's acos, with the decimal digits of its header.
_RIGHT_ANGLE = Fraction("1.570796327")

#: The library's coefficients minus those of the interpolation, highest power first, for the cells in which they differ.
_ATAN_OFF = {
    16: (0, 1, 0, 0),
    23: (0, 1, 0, 0),
    25: (1, 0, 0, 0),
    27: (0, 1, 0, 0),
    28: (0, -1, 0, 0),
    30: (0, -1, 0, 0),
}
_ASIN_OFF = {
    2: (2, 0, 0, 0, 0),
    3: (-12, 2, 0, 0, 0),
    4: (-7, 0, 0, 0, 0),
    5: (10, -3, 1, 0, 0),
    6: (-6, 2, 0, 0, 0),
    7: (11, -2, -1, 0, 0),
    8: (8, -1, 0, 0, 0),
    9: (-5, -6, 3, 0, 0),
    10: (1, -4, 3, -1, 0),
    11: (24, 0, -7, 2, -1),
    12: (-1, 11, -1, 1, 0),
    13: (8, -2, -4, 1, 0),
    14: (19, -41, 17, -3, 0),
    15: (15, -21, 9, -2, 1),
}


def _interpolated(value: Callable[[int, int], int], order: int, cell: int) -> list[int]:
    """Coefficients, highest power first, of the polynomial through ``value(n, steps)`` at the n / steps of a cell."""
    steps = _CELLS * order
    places = [cell * order + k for k in range(order + 1)]
    # Newton's divided differences, then expanded from the last node backwards.
    differences = [Fraction(value(place, steps), 1 << _BITS) for place in places]
    for k in range(1, order + 1):
        for j in range(order, k - 1, -1):
            differences[j] = (differences[j] - differences[j - 1]) / k
    powers = [Fraction(0)] * (order + 1)
    for place, difference in zip(reversed(places), reversed(differences), strict=True):
        powers = [below - place * here for below, here in zip([Fraction(0), *powers[:-1]], powers, strict=True)]
        powers[0] += difference
    return [round(power * steps**k) for k, power in enumerate(powers)][::-1]


@lru_cache
def atan_coefficients(cell: int) -> tuple[int, ...]:
    """Coefficients of x^3 .. x^0, in Q32, for the arctangent in turns."""
    exact = _interpolated(lambda n, steps: series.turn_bits(n, steps, 32, _BITS), 3, cell)
    return tuple(map(int.__add__, exact, _ATAN_OFF.get(cell, (0,) * 4)))


@lru_cache
def asin_coefficients(cell: int) -> tuple[int, ...]:
    """Coefficients of x^4 .. x^0, in Q29, for the inverse sine in rad."""
    exact = _interpolated(lambda n, steps: series.arcsine_bits(n, steps, 29, _BITS), 4, cell)
    return tuple(map(int.__add__, exact, _ASIN_OFF.get(cell, (0,) * 5)))


def _horner(x: int, coefficients: tuple[int, ...]) -> int:
    """Polynomial of x in Q31."""
    value = 0
    for coefficient in coefficients:
        value = functions.signed(x, value) + coefficient
    return value


def arcsine(a: int, q: int) -> int:
    """asin a in rad; 0 outside -1 to 1. Above 1/2 it is pi/2 - 2 asin(root((1 - a) / 2))."""
    check_trig_format(q)
    if abs(a) > 1 << q:
        return 0
    x = abs(a) << (31 - q)
    mirrored = x > 1 << 30
    if mirrored:
        x = functions.root((2**31 - x) >> 1, 31)
    # The last cell includes its end point: the library repeats its coefficients for 1/2.
    size = _horner(x, asin_coefficients(min(x >> 26, _CELLS // 2 - 1)))
    if mirrored:
        size = _RIGHT_ANGLE_Q29 - 2 * size
    size >>= 29 - q
    return -size if a < 0 else size


def arccosine(a: int, q: int) -> int:
    """acos a in rad: the right angle of the header, truncated, minus :func:`arcsine`."""
    return int(_RIGHT_ANGLE * 2**q) - arcsine(a, q)


def _turn_q32(y: int, x: int) -> int:
    """Angle of the point (x, size of y) in turns, 0 to 1/2, in Q32."""
    smaller, larger = sorted((abs(x), abs(y)))
    ratio = functions.ratio_q31(smaller, larger) if larger else INT32_MAX
    # A ratio of 1 cannot be represented in Q31 and becomes -1.
    turn = _horner(low32(ratio), atan_coefficients(min(ratio >> 26, _CELLS - 1)))
    if abs(y) > abs(x):
        turn = 2**30 - turn
    return (2**31 - turn if x < 0 else turn) & MASK


def angle(y: int, x: int, q: int) -> int:
    """Angle of the point (x, y) in rad, -pi to pi; pi/4 for the origin."""
    check_trig_format(q)
    # Half a turn is misread as a negative number.
    size = functions.signed(low32(_turn_q32(y, x)), _TURN_Q28)
    size = (size + (1 << (28 - q) if q < 29 else 0)) >> (29 - q)
    return -size if y < 0 else size


def turn(y: int, x: int, q: int) -> int:
    """Angle of the point (x, y) in turns, -1/2 to 1/2; 1/8 for the origin."""
    size = ((_turn_q32(y, x) + (1 << (31 - q))) & MASK) >> (32 - q)
    return -size if y < 0 else size
