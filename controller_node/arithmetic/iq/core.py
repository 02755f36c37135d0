"""Fixed point on plain ``int``, one train: the part common to both profiles.

Products are 64 bit wide and floored; nothing saturates unless the function says so. Events are counted only when they
occur, so the common path of an operation is one expression and one comparison.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from railhil.controller_node.arithmetic.base import (
    DIVISION_BY_ZERO,
    INT32_MAX,
    INT32_MIN,
    SATURATION,
    WRAP,
    Constant,
    Curve,
    OneTrain,
)
from railhil.controller_node.arithmetic.iq.interface import IqMath

SIGN = 2**31
MASK = 2**32 - 1


def low32(exact: int) -> int:
    """Low 32 bits as a signed number."""
    return ((exact + SIGN) & MASK) - SIGN


class FixedPoint(IqMath[int], OneTrain[int]):
    """IQmath for one train."""

    def _wrapped(self, exact: int) -> int:
        self._count(WRAP, 1)
        return low32(exact)

    def _limited(self, exact: int) -> int:
        """Saturated to int32."""
        if INT32_MIN <= exact <= INT32_MAX:
            return exact
        self._count(SATURATION, 1)
        return INT32_MAX if exact > 0 else INT32_MIN

    def _divided_by_zero(self) -> int:
        self._count(DIVISION_BY_ZERO, 1)
        return INT32_MAX

    def shl(self, a: int, count: int) -> int:
        exact = a << count
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def add(self, a: int, b: int) -> int:
        exact = a + b
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def sub(self, a: int, b: int) -> int:
        exact = a - b
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def sadd(self, a: int, b: int) -> int:
        return self._limited(a + b)

    def ssub(self, a: int, b: int) -> int:
        return self._limited(a - b)

    def neg(self, a: int) -> int:
        return -a if a != INT32_MIN else self._wrapped(-a)

    def abs(self, a: int) -> int:
        return a if a >= 0 else self.neg(a)

    def mpy(self, a: int, b: int, q: int) -> int:
        exact = (a * b) >> q
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def rmpy(self, a: int, b: int, q: int) -> int:
        exact = (a * b + (1 << (q - 1))) >> q
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def rsmpy(self, a: int, b: int, q: int) -> int:
        return self._limited((a * b + (1 << (q - 1))) >> q)

    def mpy_iqx(self, a: int, q_a: int, b: int, q_b: int, q: int) -> int:
        shift = q_a + q_b - q
        exact = (a * b) >> shift if shift >= 0 else (a * b) << -shift
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def mpy_i32(self, a: int, n: int) -> int:
        exact = a * n
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def dot(self, coefficients: Sequence[int], values: Sequence[int], q: int) -> int:
        # Wrapping once at the end gives the same 32 bits as wrapping every product and sum.
        half = 1 << (q - 1)
        exact = 0
        for coefficient, value in zip(coefficients, values, strict=True):
            exact += (coefficient * value + half) >> q
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def sat(self, a: int, upper: int, lower: int) -> int:
        if lower <= a <= upper:
            return a
        limited = self.clip(a, upper, lower)
        if limited != a:
            self._count(SATURATION, 1)
        return limited

    def clip(self, a: int, upper: int, lower: int) -> int:
        # In the order of the C28x: if the limits are swapped, the lower one wins.
        limited = a if a < upper else upper
        return limited if limited > lower else lower

    def curve(self, curve: Curve, a: int) -> int:
        cell_bits = curve.q_in - 8
        index = min(a >> cell_bits, 255)
        left, right = curve.samples[index].raw, curve.samples[index + 1].raw
        return left + (((right - left) * (a - (index << cell_bits))) >> cell_bits)

    def table(self, name: str, constants: Sequence[Constant]) -> Any:
        return tuple(constant.raw for constant in constants)

    def from_float(self, value: Any, q: int) -> int:
        # No format reaches further; ldexp would overflow for larger values.
        scaled = math.ldexp(value, q) if abs(value) <= SIGN else math.inf
        if not INT32_MIN - 1 < scaled < INT32_MAX + 1:
            raise ValueError(f"_IQ{q}({value!r}) is outside int32")
        return int(scaled)
