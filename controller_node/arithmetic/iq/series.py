"""Exponential, logarithm, sine, cosine and their inverses in whole numbers, correctly rounded.

No floating-point library takes part, so results are the same on every machine. An argument is ``a`` / 2^``q``; a result
is the function's value times 2^``scale`` as an integer, rounded to nearest or down. A value is computed with guard
bits, and again with twice as many as long as its error bound leaves the rounding open (Ziv's method). This terminates:
except for the values handled separately, none of these functions has a dyadic value at a dyadic argument (Lindemann,
Niven).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from math import isqrt

from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN

#: Error bound of an approximation, in units of its last bit; the sums below stay under a thousandth of it.
_ERROR = 1 << 20
#: Fraction bits of the first attempt, beyond those of the result.
_FIRST_BITS = 64
#: Bits by which a result may exceed its argument's scale (exp up to 2^31, reduction of an angle up to 2^31).
_HEADROOM_BITS = 48


def _settled(approximate: Callable[[int], int], addend: Callable[[int], int]) -> int:
    """floor(value + addend / 2^bits), where ``approximate(bits)`` is value * 2^bits within the error bound."""
    bits = _FIRST_BITS
    while True:
        middle = approximate(bits) + addend(bits)
        low, high = (middle - _ERROR) >> bits, (middle + _ERROR) >> bits
        if low == high:
            return low
        bits *= 2


def nearest(approximate: Callable[[int], int]) -> int:
    """The integer nearest to the value of an approximation (see :func:`_settled`)."""
    return _settled(approximate, lambda bits: 1 << (bits - 1))


def floored(approximate: Callable[[int], int]) -> int:
    """The largest integer below the value, which must not be an integer itself."""
    return _settled(approximate, lambda bits: 0)


def _atanh(z: int, bits: int) -> int:
    """atanh of ``z`` / 2^bits, magnitude at most 1/2."""
    square = (z * z) >> bits
    total, power, k = 0, z, 1
    while power not in (0, -1):
        total += power // k
        power = (power * square) >> bits
        k += 2
    return total


@lru_cache
def ln2(bits: int) -> int:
    """ln 2 * 2^bits: 2 atanh(1/3)."""
    return 2 * _atanh((1 << bits) // 3, bits)


@lru_cache
def pi(bits: int) -> int:
    """pi * 2^bits by Machin's formula: 16 atan(1/5) - 4 atan(1/239)."""

    def atan_of_inverse(n: int) -> int:
        power = (1 << bits) // n
        total, k, sign = 0, 1, 1
        while power:
            total += sign * (power // k)
            power //= n * n
            k, sign = k + 2, -sign
        return total

    return 16 * atan_of_inverse(5) - 4 * atan_of_inverse(239)


def exp_bits(a: int, q: int, scale: int, bits: int) -> int:
    """e^(a / 2^q) * 2^(scale + bits); the value itself below 2^32."""
    fine = bits + _HEADROOM_BITS
    x = (a << fine) >> q
    halvings, rest = divmod(x, ln2(fine))
    term = total = 1 << fine
    k = 1
    while term:
        term = (term * rest >> fine) // k
        total += term
        k += 1
    shift = halvings + scale - _HEADROOM_BITS
    return total << shift if shift >= 0 else total >> -shift


def ln_bits(a: int, q: int, scale: int, bits: int) -> int:
    """ln(a / 2^q) * 2^(scale + bits), a > 0."""
    fine = bits + _HEADROOM_BITS
    exponent = a.bit_length()
    # a = m 2^exponent with 1/2 <= m < 1, and ln m = 2 atanh((m - 1) / (m + 1)).
    one = 1 << exponent
    z = ((a - one) << fine) // (a + one)
    value = 2 * _atanh(z, fine) + (exponent - q) * ln2(fine)
    return value << (scale - _HEADROOM_BITS) if scale >= _HEADROOM_BITS else value >> (_HEADROOM_BITS - scale)


def _sine_bits(angle: int, quadrant: int, bits: int) -> int:
    """Sine of ``quadrant`` * pi/2 + ``angle`` / 2^bits, where the magnitude of the angle is at most pi/4."""
    square = angle * angle >> bits
    total = term = 1 << bits if quadrant & 1 else angle
    k = 1 if quadrant & 1 else 2
    while term not in (0, -1):
        term = -((term * square >> bits) // (k * (k + 1)))
        total += term
        k += 2
    return -total if quadrant & 2 else total


def sine_bits(a: int, q: int, quadrants: int, scale: int, bits: int) -> int:
    """sin(a / 2^q + quadrants * pi/2) * 2^(scale + bits), argument in rad."""
    fine = bits + _HEADROOM_BITS
    right_angle = pi(fine - 1)
    angle = (a << fine) >> q
    quadrant = (2 * angle + right_angle) // (2 * right_angle)
    value = _sine_bits(angle - quadrant * right_angle, quadrant + quadrants, fine)
    return value >> (_HEADROOM_BITS - scale)


def _atan(z: int, bits: int) -> int:
    """atan of ``z`` / 2^bits, 0 to 1: halved twice, then its series."""
    one = 1 << bits
    for _ in range(2):
        z = (z << bits) // (one + isqrt((one << bits) + z * z))
    square = (z * z) >> bits
    total, power, k = 0, z, 1
    while power:
        total += power // k if k & 2 == 0 else -(power // k)
        power = (power * square) >> bits
        k += 2
    return total << 2


def angle_bits(y: int, x: int, scale: int, bits: int) -> int:
    """Angle of the point (x, y), -pi to pi, in rad, times 2^(scale + bits); scale at most 48. 0 for the origin."""
    fine = bits + _HEADROOM_BITS
    smaller, larger = sorted((abs(x), abs(y)))
    value = _atan((smaller << fine) // max(larger, 1), fine)
    if abs(y) > abs(x):
        value = pi(fine - 1) - value
    if x < 0:
        value = pi(fine) - value
    return (value if y >= 0 else -value) >> (_HEADROOM_BITS - scale)


def turn_bits(y: int, x: int, scale: int, bits: int) -> int:
    """As :func:`angle_bits`, in turns: -1/2 to 1/2."""
    fine = bits + _HEADROOM_BITS
    return (angle_bits(y, x, _HEADROOM_BITS, bits) << fine) // pi(fine + 1) >> (_HEADROOM_BITS - scale)


def arcsine_bits(n: int, d: int, scale: int, bits: int, cosine: bool = False) -> int:
    """asin, or acos, of n / d, magnitude at most 1, in rad, times 2^(scale + bits)."""
    fine = bits + _HEADROOM_BITS
    sine, other = n << fine, isqrt((d * d - n * n) << 2 * fine)
    return angle_bits(other, sine, scale, bits) if cosine else angle_bits(sine, other, scale, bits)


def exp(a: int, q: int, scale: int) -> int:
    """e^(a / 2^q) * 2^scale, to nearest."""
    return 1 << scale if a == 0 else nearest(lambda bits: exp_bits(a, q, scale, bits))


def log(a: int, q: int, scale: int) -> int:
    """ln(a / 2^q) * 2^scale, to nearest; a > 0."""
    return nearest(lambda bits: ln_bits(a, q, scale, bits))


def sine(a: int, q: int, scale: int, quadrants: int = 0) -> int:
    """sin(a / 2^q + quadrants * pi/2) * 2^scale, to nearest; scale at most 31."""
    return nearest(lambda bits: sine_bits(a, q, quadrants, scale, bits))


def sine_of_turns(a: int, q: int, scale: int, quadrants: int = 0) -> int:
    """Sine of ``a`` / 2^q turns plus ``quadrants`` quarter turns, times 2^scale, to nearest; scale at most 31."""
    # Reduced exactly: a quarter turn is 2^(q - 2), even if that is not an integer.
    quadrant = ((a << 3) + (1 << q)) >> (q + 1)
    rest = (a << 2) - (quadrant << q)

    def approximate(bits: int) -> int:
        fine = bits + _HEADROOM_BITS
        return _sine_bits(rest * pi(fine - 1) >> q, quadrant + quadrants, fine) >> (_HEADROOM_BITS - scale)

    return nearest(approximate)


def arcsine(a: int, q: int, scale: int, cosine: bool = False) -> int:
    """asin, or acos, of ``a`` / 2^``q``, magnitude at most 1, in rad, times 2^scale, to nearest; scale at most 48."""
    return nearest(lambda bits: arcsine_bits(a, 1 << q, scale, bits, cosine))


def angle(y: int, x: int, scale: int) -> int:
    """Angle of the point (x, y), -pi to pi, in rad, times 2^scale, to nearest; scale at most 48. 0 for the origin."""
    return nearest(lambda bits: angle_bits(y, x, scale, bits))


def turn(y: int, x: int, scale: int) -> int:
    """Angle of the point (x, y) in turns, 0 to 1, times 2^scale, to nearest; scale at most 48. 0 for the origin."""
    if x == 0 or y == 0 or abs(x) == abs(y):
        # Multiples of an eighth are the only dyadic results: a tie in Q1 and Q2 would never be decided.
        eighths = nearest(lambda bits: turn_bits(y, x, 3, bits)) % 8
        return ((eighths << scale) + 4) >> 3
    return nearest(lambda bits: turn_bits(y, x, scale, bits)) + (1 << scale if y < 0 else 0)


@lru_cache
def exp_range(q: int) -> tuple[int, int]:
    """Smallest and largest argument whose exponential is at least 1 LSB and at most INT32_MAX, in Q ``q``."""
    largest = floored(lambda bits: ln_bits(INT32_MAX, q, q, bits))
    smallest = -floored(lambda bits: q * ln_bits(2, 0, q, bits))
    return max(smallest, INT32_MIN), largest
