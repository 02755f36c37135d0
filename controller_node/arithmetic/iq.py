"""Fixed point of the TMS320F28335: int32, two's complement, with the results of TI's C28x IQmath library.

Semantics restated from TI's IQmath user's guide V1.70 and the published headers (facts only, no code): products are
64 bit wide and floored; nothing saturates unless the function says so; ``div`` is modelled as the exact quotient
rounded to nearest (TI's routine is at most 7 LSB of 2^31 away at full scale), x / 0 = 0x7FFFFFFF whatever x.

:class:`Iq` takes plain ``int``, :class:`IqBatch` int64 arrays (every 32 x 32 bit product fits); results are equal.
Both count wraps, saturations and divisions by zero.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from controller_node.arithmetic.base import (
    INT32_MAX,
    INT32_MIN,
    Arithmetic,
    Condition,
    Constant,
    Curve,
)

Ints = NDArray[np.int64]

_SIGN = 2**31
_MASK = 2**32 - 1


def iq_macro(value: float, q: int) -> int:
    """``_IQ<q>(value)`` of the target's compiler: truncation toward zero.

    Raises ``ValueError`` outside int32 (undefined on the target) and for NaN.
    """
    scaled = math.ldexp(value, q)
    if not INT32_MIN - 1 < scaled < INT32_MAX + 1:
        raise ValueError(f"_IQ{q}({value!r}) is outside int32")
    return int(scaled)


class Iq(Arithmetic[int]):
    """IQmath of the C28x for one train, on plain ``int``."""

    name: ClassVar[str] = "iq"
    wide: ClassVar[bool] = False

    def _wrapped(self, exact: int) -> int:
        self.counters.wraps += 1
        return ((exact + _SIGN) & _MASK) - _SIGN

    def const(self, constant: Constant) -> int:
        return constant.raw

    def raw(self, a: int, q: int) -> int:
        return a

    def from_raw(self, raw: Any, q: int) -> Any:
        return raw

    def shl(self, a: int, count: int) -> int:
        """``a << count``, wrapping."""
        exact = a << count
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def shr(self, a: int, count: int) -> int:
        """``a >> count``, floor (arithmetic shift)."""
        return a >> count

    def convert(self, a: int, q_from: int, q_to: int) -> int:
        return self.shl(a, q_to - q_from) if q_to > q_from else a >> (q_from - q_to)

    def quantise(self, a: int, q_from: int, q_to: int) -> int:
        return self.rmpy(a, 1, q_from - q_to)

    def add(self, a: int, b: int) -> int:
        exact = a + b
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def sub(self, a: int, b: int) -> int:
        exact = a - b
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

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
        return self.sat((a * b + (1 << (q - 1))) >> q, INT32_MAX, INT32_MIN)

    def mpy_iqx(self, a: int, q_a: int, b: int, q_b: int, q: int) -> int:
        shift = q_a + q_b - q
        exact = (a * b) >> shift if shift >= 0 else (a * b) << -shift
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def dot(self, coefficients: Sequence[int], values: Sequence[int], q: int) -> int:
        # Wrapping once at the end gives the same 32 bits as wrapping every product and sum.
        half = 1 << (q - 1)
        exact = 0
        for coefficient, value in zip(coefficients, values, strict=True):
            exact += (coefficient * value + half) >> q
        return exact if INT32_MIN <= exact <= INT32_MAX else self._wrapped(exact)

    def div(self, a: int, b: int, q: int) -> int:
        if b == 0:
            self.counters.zero_divisions += 1
            return INT32_MAX
        if b < 0:
            a, b = -a, -b
        return self.sat(((a << (q + 1)) + b) // (2 * b), INT32_MAX, INT32_MIN)

    def sat(self, a: int, upper: int, lower: int) -> int:
        if lower <= a <= upper:
            return a
        self.counters.saturations += 1
        return lower if a < lower else upper

    def clip(self, a: int, upper: int, lower: int) -> int:
        return lower if a < lower else upper if a > upper else a

    def minimum(self, a: int, b: int) -> int:
        return a if a < b else b

    def maximum(self, a: int, b: int) -> int:
        return a if a > b else b

    def gt(self, a: int, b: int) -> Condition:
        return a > b

    def where(self, condition: Condition, a: int, b: int) -> int:
        return a if condition else b

    def curve(self, curve: Curve, a: int) -> int:
        cell_bits = curve.q_in - 8
        index = min(a >> cell_bits, 255)
        left, right = curve.samples[index].raw, curve.samples[index + 1].raw
        return left + (((right - left) * (a - (index << cell_bits))) >> cell_bits)

    def table(self, name: str, constants: Sequence[Constant]) -> Any:
        return tuple(constant.raw for constant in constants)

    def sqrt(self, a: int, q: int) -> int:
        # Root of 4 a 2^q is twice the result: the last bit rounds.
        return (math.isqrt(a << (q + 2)) + 1) >> 1 if a > 0 else 0

    def at(self, table: Any, index: Any, offset: int = 0) -> int:
        return table[index + offset]  # type: ignore[no-any-return]

    def index(self, k: Any, last: int) -> Any:
        return min(max(k, 0), last)

    def locate(self, table: Any, a: int) -> Any:
        return min(max(bisect_right(table, a) - 1, 0), len(table) - 2)


class IqBatch(Arithmetic[Ints]):
    """IQmath of the C28x for N trains, on int64 arrays of shape (N,) or plain ``int`` common to all.

    Counters count elements.
    """

    name: ClassVar[str] = "iq"
    wide: ClassVar[bool] = False

    def _wrap(self, exact: Any) -> Any:
        wrapped = ((exact + _SIGN) & _MASK) - _SIGN
        self.counters.wraps += int(np.count_nonzero(wrapped != exact))
        return wrapped

    def const(self, constant: Constant) -> Any:
        return constant.raw

    def raw(self, a: Ints, q: int) -> Ints:
        return a

    def from_raw(self, raw: Any, q: int) -> Any:
        return raw

    def shl(self, a: Ints, count: int) -> Any:
        """``a << count``, wrapping; count <= 31."""
        return self._wrap(a << count)

    def shr(self, a: Ints, count: int) -> Any:
        """``a >> count``, floor (arithmetic shift)."""
        return a >> count

    def convert(self, a: Ints, q_from: int, q_to: int) -> Any:
        return self.shl(a, q_to - q_from) if q_to > q_from else a >> (q_from - q_to)

    def quantise(self, a: Ints, q_from: int, q_to: int) -> Any:
        return self.rmpy(a, 1, q_from - q_to)  # type: ignore[arg-type]

    def add(self, a: Ints, b: Ints) -> Any:
        return self._wrap(a + b)

    def sub(self, a: Ints, b: Ints) -> Any:
        return self._wrap(a - b)

    def neg(self, a: Ints) -> Any:
        return self._wrap(-a)

    def abs(self, a: Ints) -> Any:
        return self._wrap(abs(a))

    def mpy(self, a: Ints, b: Ints, q: int) -> Any:
        return self._wrap((a * b) >> q)

    def rmpy(self, a: Ints, b: Ints, q: int) -> Any:
        return self._wrap((a * b + (1 << (q - 1))) >> q)

    def rsmpy(self, a: Ints, b: Ints, q: int) -> Any:
        return self._limit((a * b + (1 << (q - 1))) >> q)

    def mpy_iqx(self, a: Ints, q_a: int, b: Ints, q_b: int, q: int) -> Any:
        shift = q_a + q_b - q
        if shift >= 0:
            return self._wrap((a * b) >> shift)
        # A product shifted left can pass 64 bits: its low 32 bits come from the low 32 bits of the product.
        product: Any = a * b
        low = ((product + _SIGN) & _MASK) - _SIGN
        wrapped = (((low << -shift) + _SIGN) & _MASK) - _SIGN
        self.counters.wraps += int(np.count_nonzero((low != product) | (wrapped >> -shift != low)))
        return wrapped

    def dot(self, coefficients: Sequence[Ints], values: Sequence[Ints], q: int) -> Any:
        half = 1 << (q - 1)
        exact: Any = 0
        for coefficient, value in zip(coefficients, values, strict=True):
            exact = exact + ((coefficient * value + half) >> q)
        return self._wrap(exact)

    def div(self, a: Ints, b: Ints, q: int) -> Any:
        numerator, denominator = np.broadcast_arrays(np.asarray(a, dtype=np.int64), np.asarray(b, dtype=np.int64))
        by_zero = denominator == 0
        self.counters.zero_divisions += int(np.count_nonzero(by_zero))
        numerator = np.where(denominator < 0, -numerator, numerator)
        denominator = np.where(by_zero, 1, abs(denominator))
        quotient = ((numerator << (q + 1)) + denominator) // (2 * denominator)
        return self._limit(np.where(by_zero, INT32_MAX, quotient))

    def _limit(self, exact: Any) -> Any:
        return self.sat(exact, INT32_MAX, INT32_MIN)  # type: ignore[arg-type]

    def sat(self, a: Ints, upper: Ints, lower: Ints) -> Ints:
        limited = self.clip(a, upper, lower)
        self.counters.saturations += int(np.count_nonzero(limited != a))
        return limited

    def clip(self, a: Ints, upper: Ints, lower: Ints) -> Ints:
        return np.minimum(np.maximum(a, lower), upper)

    def minimum(self, a: Ints, b: Ints) -> Ints:
        return np.minimum(a, b)

    def maximum(self, a: Ints, b: Ints) -> Ints:
        return np.maximum(a, b)

    def gt(self, a: Ints, b: Ints) -> Condition:
        return a > b

    def where(self, condition: Condition, a: Ints, b: Ints) -> Ints:
        return np.where(condition, a, b)

    def curve(self, curve: Curve, a: Ints) -> Any:
        cell_bits = curve.q_in - 8
        samples = np.array([sample.raw for sample in curve.samples], dtype=np.int64)
        index = np.minimum(np.asarray(a) >> cell_bits, 255)
        left, right = samples[index], samples[index + 1]
        return left + (((right - left) * (a - (index << cell_bits))) >> cell_bits)

    def table(self, name: str, constants: Sequence[Constant]) -> Any:
        return np.array([constant.raw for constant in constants], dtype=np.int64)

    def sqrt(self, a: Ints, q: int) -> Any:
        flat = np.asarray(a, dtype=np.int64)
        roots = [(math.isqrt(x << (q + 2)) + 1) >> 1 if x > 0 else 0 for x in flat.ravel().tolist()]
        return np.array(roots, dtype=np.int64).reshape(flat.shape)

    def at(self, table: Any, index: Any, offset: int = 0) -> Ints:
        return table[index + offset]  # type: ignore[no-any-return]

    def index(self, k: Any, last: int) -> Any:
        return np.clip(k, 0, last)

    def locate(self, table: Any, a: Ints) -> Any:
        return np.clip(np.searchsorted(table, a, side="right") - 1, 0, table.size - 2)
