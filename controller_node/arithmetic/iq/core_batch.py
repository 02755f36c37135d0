"""Fixed point on int64 arrays, N trains: the part common to both profiles.

Operands are arrays of shape (N,) or plain ``int`` common to all; every 32 x 32 bit product fits into int64. Results
equal those of one train element by element; counters count elements.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.controller_node.arithmetic.arrays import ManyTrains
from railhil.controller_node.arithmetic.base import (
    DIVISION_BY_ZERO,
    INT32_MAX,
    INT32_MIN,
    SATURATION,
    WRAP,
    Constant,
    Counters,
    Curve,
)
from railhil.controller_node.arithmetic.iq.core import MASK, SIGN, FixedPoint
from railhil.controller_node.arithmetic.iq.interface import IqMath

Ints: TypeAlias = NDArray[np.int64]


class FixedPointBatch(IqMath[Ints], ManyTrains[Ints]):
    """IQmath for N trains."""

    #: The profile for one train, used element by element for functions that are too rare or have too many branches for
    #: arrays.
    one_train: ClassVar[type[FixedPoint]]

    def __init__(self) -> None:
        super().__init__()
        self._one = self.one_train()
        self._curves: dict[int, tuple[Curve, Ints]] = {}
        #: Kind of event -> count for each train, arrays of shape (N,), if telemetry is on.
        self.per_train: dict[int, Ints] | None = None

    def _count_where(self, kind: int, happened: Any) -> None:
        """Count an event by a condition, or by its number of occurrences, for each train or for all together."""
        if np.count_nonzero(happened):
            self._count(kind, int(np.sum(happened)))
            if self.per_train is not None:
                self.per_train[kind] += happened

    def _wrap(self, exact: Any) -> Any:
        if isinstance(exact, np.ndarray):
            # The cast keeps the low 32 bits, in half the time of the sums below.
            wrapped = exact.astype(np.int32).astype(np.int64)
        else:
            wrapped = ((exact + SIGN) & MASK) - SIGN
        self._count_where(WRAP, wrapped != exact)
        return wrapped

    def _limit(self, exact: Any) -> Any:
        """Saturated to int32."""
        limited = np.minimum(np.maximum(exact, INT32_MIN), INT32_MAX)
        self._count_where(SATURATION, limited != exact)
        return limited

    def _each(self, function: str, q: int, *operands: Any) -> Any:
        """A function of one train applied to every element, with its counts."""
        arrays = np.broadcast_arrays(*(np.asarray(operand) for operand in operands))
        call = getattr(self._one, function)
        results, counts = [], []
        for row in zip(*(array.ravel().tolist() for array in arrays), strict=True):
            self._one.counters = counters = Counters()
            results.append(call(*row, q))
            counts.append((counters.wraps, counters.saturations, counters.zero_divisions))
        for kind, happened in zip((WRAP, SATURATION, DIVISION_BY_ZERO), np.array(counts).T, strict=True):
            self._count_where(kind, happened.reshape(arrays[0].shape))
        return np.array(results, dtype=np.int64).reshape(arrays[0].shape)

    def shl(self, a: Ints, count: int) -> Any:
        return self._wrap(a << count)

    def add(self, a: Ints, b: Ints) -> Any:
        return self._wrap(a + b)

    def sub(self, a: Ints, b: Ints) -> Any:
        return self._wrap(a - b)

    def sadd(self, a: Ints, b: Ints) -> Any:
        return self._limit(a + b)

    def ssub(self, a: Ints, b: Ints) -> Any:
        return self._limit(a - b)

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
        low = ((product + SIGN) & MASK) - SIGN
        wrapped = (((low << -shift) + SIGN) & MASK) - SIGN
        self._count_where(WRAP, (low != product) | (wrapped >> -shift != low))
        return wrapped

    def mpy_i32(self, a: Ints, n: Ints) -> Any:
        return self._wrap(a * n)

    def dot(self, coefficients: Sequence[Ints], values: Sequence[Ints], q: int) -> Any:
        half = 1 << (q - 1)
        exact: Any = 0
        for coefficient, value in zip(coefficients, values, strict=True):
            exact = exact + ((coefficient * value + half) >> q)
        return self._wrap(exact)

    def sat(self, a: Ints, upper: Ints, lower: Ints) -> Ints:
        limited = self.clip(a, upper, lower)
        self._count_where(SATURATION, limited != a)
        return limited

    def clip(self, a: Ints, upper: Ints, lower: Ints) -> Ints:
        return np.maximum(np.minimum(a, upper), lower)

    def curve(self, curve: Curve, a: Ints) -> Any:
        cell_bits = curve.q_in - 8
        # By identity, because comparing two curves means comparing 257 numbers. The curve is kept, so its id stays
        # unique.
        known = self._curves.get(id(curve))
        if known is None:
            samples = np.array([sample.raw for sample in curve.samples], dtype=np.int64)
            known = self._curves[id(curve)] = (curve, samples)
        samples = known[1]
        index = np.minimum(np.asarray(a) >> cell_bits, 255)
        left, right = samples[index], samples[index + 1]
        return left + (((right - left) * (a - (index << cell_bits))) >> cell_bits)

    def table(self, name: str, constants: Sequence[Constant]) -> Any:
        return np.array([constant.raw for constant in constants], dtype=np.int64)

    def sqrt(self, a: Ints, q: int) -> Any:
        return self._each("sqrt", q, a)

    def isqrt(self, a: Ints, q: int) -> Any:
        return self._each("isqrt", q, a)

    def mag(self, a: Ints, b: Ints, q: int) -> Any:
        return self._each("mag", q, a, b)

    def exp(self, a: Ints, q: int) -> Any:
        return self._each("exp", q, a)

    def log(self, a: Ints, q: int) -> Any:
        return self._each("log", q, a)

    def sin(self, a: Ints, q: int) -> Any:
        return self._each("sin", q, a)

    def cos(self, a: Ints, q: int) -> Any:
        return self._each("cos", q, a)

    def sin_pu(self, a: Ints, q: int) -> Any:
        return self._each("sin_pu", q, a)

    def cos_pu(self, a: Ints, q: int) -> Any:
        return self._each("cos_pu", q, a)

    def asin(self, a: Ints, q: int) -> Any:
        return self._each("asin", q, a)

    def acos(self, a: Ints, q: int) -> Any:
        return self._each("acos", q, a)

    def atan2(self, y: Ints, x: Ints, q: int) -> Any:
        return self._each("atan2", q, y, x)

    def atan2_pu(self, y: Ints, x: Ints, q: int) -> Any:
        return self._each("atan2_pu", q, y, x)

    def to_f(self, a: Ints, q: int) -> Any:
        return self._each("to_f", q, a)

    def from_float(self, value: Any, q: int) -> Any:
        return self._each("from_float", q, value)

    def ato_iq(self, text: Any, q: int) -> Any:
        return self._each("ato_iq", q, text)

    def to_a(self, form: str, a: Ints, q: int) -> Any:
        """A list, one (error, text) for each element."""
        return [self._one.to_a(form, x, q) for x in np.asarray(a).ravel().tolist()]
