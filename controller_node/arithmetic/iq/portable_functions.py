"""Algorithms and tables of the portable profile (see :mod:`railhil.controller_node.arithmetic.iq.portable`).

"Fractional product" means (a * b) >> 31 of 32-bit numbers.

Inverse sine and four-quadrant arctangent have one polynomial for each 1/32 of the argument: of third order for the
arctangent in turns (Q32), of fourth for the inverse sine in rad (Q29). Both interpolate the exact function at the ends
of the cell and at equal steps in between. The library's coefficients differ from the exact ones by a few units, like
the solution of an ill-conditioned system in doubles; the differences are listed here.

Two faults of the library affect its results and are therefore reproduced: arguments of equal magnitude (atan2(3, 3) =
-1.88), and the sign of ``atan2`` within about one LSB of half a turn.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np

from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from railhil.controller_node.arithmetic.iq import series
from railhil.controller_node.arithmetic.iq.core import MASK, SIGN, low32
from railhil.controller_node.arithmetic.iq.interface import check_trig_format

#: 1/x in Q6 at the middle of 65 cells of 1/128 from 1/2, rounded.
RECIPROCAL = tuple((2 * 16384 + 129 + 2 * i) // (2 * (129 + 2 * i)) for i in range(65))
RECIPROCALS = np.array(RECIPROCAL, dtype=np.int64)
#: 1/sqrt(x) in Q14 at the middle of 96 cells of 1/128 from 1/4, truncated.
_INVERSE_ROOT = tuple(math.isqrt(2**36 // (65 + 2 * i)) for i in range(96))
#: From this format on the root uses three Newton steps instead of two.
_THREE_STEPS_Q = 24

_LN2 = series.log(2, 0, 31)
#: Coefficients of x^10 .. x^0 in Q30, truncated; the library's x^9 is larger by 5.
_EXP = tuple(2**30 // math.factorial(k) + (5 if k == 9 else 0) for k in range(10, -1, -1))
_EXP_ENTRIES = 22
#: No lower limit of the argument from this format on: e^-16 is above 1 LSB.
_EXP_ANY_Q = 27
#: Coefficients of x^14 .. x^0 of ln(1 + x) in Q30, truncated toward zero; the library's x^14 is smaller by 1.
_LN = (*((-1 if k % 2 == 0 else 1) * (2**30 // k) - (1 if k == 14 else 0) for k in range(14, 0, -1)), 0)
_TWO_THIRDS = 2**32 // 3

_PI_Q29, _PI_Q30 = (((series.pi(q + 65) >> 64) + 1) >> 1 for q in (29, 30))
#: 1/3 in Q31.
_THIRD = 0x2AAAAAAB
#: sin and cos of k/64 in Q31.
_SIN = tuple(series.sine(k, 6, 31) for k in range(52))
_COS = tuple(min(series.sine(k, 6, 31, quadrants=1), INT32_MAX) for k in range(52))


def signed(a: int, b: int) -> int:
    """Fractional product of signed numbers."""
    return low32((a * b) >> 31)


def unsigned(a: Any, b: Any) -> Any:
    """Fractional product of unsigned numbers: ``int``, or uint64 arrays below 2^32."""
    return ((a * b) >> 31) & MASK


def quotient(guess: Any, divisor: Any, numerator: Any) -> Any:
    """Three Newton steps g (2 - d g), then numerator * g; ``int`` or uint64 arrays."""
    for _ in range(3):
        guess = unsigned(guess, ((SIGN - unsigned(guess, divisor)) << 1) & MASK)
    return unsigned(guess, numerator)


def inverse_root(x: int, q: int) -> int:
    """1/sqrt(x) in Q30 of x in Q32, 1/4 <= x < 1: g (3 - x g g) / 2."""
    guess = _INVERSE_ROOT[(x >> 25) - 32] << 16
    for _ in range(2 if q < _THREE_STEPS_Q else 3):
        guess = unsigned(guess, (3 * 2**30 - unsigned(unsigned(x, guess), guess)) & MASK)
    return guess


def ratio_q31(numerator: int, denominator: int) -> int:
    """Ratio of two magnitudes, the first at most the second, in Q31; the result may be 2^31."""
    shift = max(31 - denominator.bit_length(), 0)
    divisor, scaled = denominator << shift, numerator << (shift + 1)
    if scaled > MASK:
        return INT32_MAX
    size: int = quotient(RECIPROCAL[(divisor >> 24) - 64] << 24, divisor, scaled)
    return size


def even_shift(x: int, bits: int) -> int:
    """Smallest even left shift that makes x at least a quarter of 2^bits."""
    return (bits - x.bit_length()) & ~1


def rounded_shift(x: int, count: int) -> int:
    """x >> count of 32 bits, as in the library's roots: in steps of 16, 8 and 1, where the last step of 1 rounds up.

    A count of 8, 16 or 24 therefore truncates.
    """
    if count >= 32:
        return 0
    if count >= 16:
        x, count = x >> 16, count - 16
    if count >= 8:
        x, count = x >> 8, count - 8
    return low32(((x >> (count - 1)) + 1) >> 1 if count else x)


def root(a: int, q: int) -> int:
    """Root of a number in Q ``q``, at most 31; 0 for a <= 0."""
    if a <= 0:
        return 0
    x = a << (q & 1)
    shift = even_shift(x, 32)
    x <<= shift
    return rounded_shift(unsigned(inverse_root(x, q), x), (31 - q) - ((32 - q) >> 1) + (shift >> 1))


@lru_cache
def _exp_table(q: int) -> tuple[int, int, tuple[int, ...]]:
    """Smallest argument, index of e^0, and the powers of e in Q ``q`` + 1, truncated, 0 beyond 32 bits."""
    zero = series.floored(lambda bits: q * series.ln_bits(2, 0, 0, bits))

    def power(n: int) -> int:
        cut = 1 << (q + 1) if n == 0 else series.floored(lambda bits: series.exp_bits(n, 0, q + 1, bits))
        return cut if cut <= MASK else 0

    smallest = series.exp_range(q)[0] if q < _EXP_ANY_Q else INT32_MIN
    return smallest, zero, tuple(power(i - zero) for i in range(_EXP_ENTRIES))


@lru_cache
def ln_out_of_range(q: int) -> int:
    """Largest argument for which the library returns INT32_MIN, 0 for none: one above the last one out of range."""
    return series.floored(lambda bits: series.exp_bits(-(1 << (31 - q)), 0, q, bits)) + 1 if q > 26 else 0


def exponential(a: int, q: int) -> int:
    """e^a, ``a`` at most the largest argument of the format: power of e by table, the rest by series."""
    smallest, zero, powers = _exp_table(q)
    if a < smallest:
        return 0
    rest = (a << (31 - q)) & INT32_MAX
    whole = a >> q
    if a < 0:
        rest, whole = rest - SIGN, whole + 1
    power = powers[whole + zero]
    if rest <= -_LN2:
        rest, power = rest + _LN2, power >> 1
    elif rest >= _LN2:
        rest, power = rest - _LN2, power << 1 & MASK
    value = _EXP[0]
    for coefficient in _EXP[1:]:
        value = signed(rest, value) + coefficient
    return (int(unsigned(power, value << 1 & MASK)) + 1) >> 1


def logarithm(a: int, q: int) -> int:
    """ln a, a > 0: scaled to 2/3..4/3, series, plus the exponent times ln 2."""
    exponent = 31 - q
    x = a
    while x < _TWO_THIRDS:
        x <<= 1
        exponent -= 1
    value = _LN[0]
    for coefficient in _LN[1:]:
        value = signed(x - INT32_MAX, value) + coefficient
    whole = unsigned(_LN2, (abs(exponent) << q) & MASK)
    return low32((value >> (30 - q)) + (whole if exponent > 0 else -whole))


def _sine_near(x: int) -> int:
    """Sine of x in Q31, at most pi/4: table in steps of 1/64, second-order interpolation."""
    k, rest = x >> 25 & 0x3F, x & 0x1FFFFFF
    sine, cosine = _SIN[k], _COS[k]
    bend = low32(-(sine + signed(cosine, signed(_THIRD, rest)))) >> 1
    return sine + signed(rest, cosine + signed(rest, bend))


def _cosine_near(x: int) -> int:
    """Cosine of x in Q31, at most pi/4; as :func:`_sine_near`."""
    k, rest = x >> 25 & 0x3F, x & 0x1FFFFFF
    sine, cosine = _SIN[k], _COS[k]
    bend = low32(signed(sine, signed(_THIRD, rest)) - cosine) >> 1
    return cosine + signed(rest, signed(rest, bend) - sine)


def _half_turn(x: int, q: int, cosine: bool, negative: bool) -> int:
    """Sine or cosine in Q ``q`` of an angle x in Q30, 0 to pi, with the sign from the range reduction."""
    if x >= _PI_Q29:
        x = _PI_Q30 - x
        negative ^= cosine
    x <<= 1
    if x > _PI_Q29:
        x, cosine = _PI_Q30 - x, not cosine
    size = ((_cosine_near(x) if cosine else _sine_near(x)) & MASK) >> (31 - q)
    return -size if negative else size


def sine_of_radians(a: int, q: int, cosine: bool) -> int:
    """Sine or cosine of an angle in rad, reduced to 0..pi by doubling modulo pi."""
    check_trig_format(q)
    x = abs(a)
    for _ in range(29 - q):
        x = (x - _PI_Q29 if x >= _PI_Q29 else x) << 1 & MASK
    odd = x >= _PI_Q29
    return _half_turn((x - _PI_Q29 if odd else x) << 1, q, cosine, odd ^ (a < 0 and not cosine))


def sine_of_turns(a: int, q: int, cosine: bool) -> int:
    """Sine or cosine of an angle in turns."""
    x = abs(a) << (32 - q) & MASK
    odd = x >= SIGN
    return _half_turn(unsigned(x % SIGN, _PI_Q30), q, cosine, odd ^ (a < 0 and not cosine))


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
        value = signed(x, value) + coefficient
    return value


def arcsine(a: int, q: int) -> int:
    """asin a in rad; 0 outside -1 to 1. Above 1/2 it is pi/2 - 2 asin(root((1 - a) / 2))."""
    check_trig_format(q)
    if abs(a) > 1 << q:
        return 0
    x = abs(a) << (31 - q)
    mirrored = x > 1 << 30
    if mirrored:
        x = root((2**31 - x) >> 1, 31)
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
    ratio = ratio_q31(smaller, larger) if larger else INT32_MAX
    # A ratio of 1 cannot be represented in Q31 and becomes -1.
    turn = _horner(low32(ratio), atan_coefficients(min(ratio >> 26, _CELLS - 1)))
    if abs(y) > abs(x):
        turn = 2**30 - turn
    return (2**31 - turn if x < 0 else turn) & MASK


def angle(y: int, x: int, q: int) -> int:
    """Angle of the point (x, y) in rad, -pi to pi; pi/4 for the origin."""
    check_trig_format(q)
    # Half a turn is misread as a negative number.
    size = signed(low32(_turn_q32(y, x)), _TURN_Q28)
    size = (size + (1 << (28 - q) if q < 29 else 0)) >> (29 - q)
    return -size if y < 0 else size


def turn(y: int, x: int, q: int) -> int:
    """Angle of the point (x, y) in turns, -1/2 to 1/2; 1/8 for the origin."""
    size = ((_turn_q32(y, x) + (1 << (31 - q))) & MASK) >> (32 - q)
    return -size if y < 0 else size
