"""Single precision of the C28x floating-point unit (FPU32): specification, consequences, and the version for one train.

Specification, after TI's FPU guide SPRUEO2 and workshop notes: IEEE 754 single format; a denormal is zero, -0 is
+0, NaN is infinity; rounding to nearest even, or toward zero while the mode bit STF.RNDF32 is clear (``float32`` and
``float32-truncated``); products and sums are rounded separately, there is no fused multiply-add. Division follows TI's
fast RTS library: an 8-bit reciprocal estimate, two Newton steps, one product. The table of the estimate is not
published, so a quotient is close to the target's, not equal to it. The relative error of railhil's quotient is at most
1.76 * 2^-23 (truncated: 3.51 * 2^-23), provided that no step under- or overflows. Derivation, in units of 2^-24
(truncated: 2^-23): the last Newton step contributes at most 0.5 from b * r below 1 and 1 from 2 - b * r, its product 1
and the product with the numerator 1, together 3.5. The error of the estimate, at most 2^-8, is squared twice: 2^-32.
The distance to the target's quotient is not known.

Assumptions where the documents are silent: NaN becomes *plus* infinity; a result that rounds to a denormal is zero; an
overflow is infinite when rounding to nearest and the largest number when rounding toward zero (IEEE 754); a number
divided by infinity is 0; the root is correctly rounded.

For one train operands are ``float`` with single-precision values, for N trains float32 arrays (``float32_batch``); both
give the same bits. Every operand comes from an operation here (``const``, ``table``, ``from_raw``, ``operand``, ...)
and is therefore a normal number, +0 or infinite: only results need checking.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from array import array
from collections.abc import Sequence
from typing import Any, ClassVar

from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN, Arithmetic, Constant, Curve, OneTrain, T

#: Smallest normal and largest number of the format.
FLT_MIN = 2.0**-126
FLT_MAX = (2.0 - 2.0**-23) * 2.0**127

#: Bits after the leading one of the reciprocal estimate.
ESTIMATE_BITS = 7
MANTISSA_BITS = 24
#: Last cell of a curve of 257 samples.
LAST_CELL = 255.0

# The processor rounds a double stored here to nearest even.
_single = array("f", [0.0])


def nearest(value: float) -> float:
    """A double rounded to the nearest single that the unit supports: no denormal, no -0, no NaN."""
    _single[0] = value
    rounded = _single[0]
    if FLT_MIN <= abs(rounded) <= FLT_MAX:
        return rounded
    if abs(rounded) < FLT_MIN:
        return 0.0
    return -math.inf if rounded < 0 else math.inf


def toward_zero(value: float) -> float:
    """Like :func:`nearest`, but truncated after the 24th bit."""
    size = abs(value)
    if FLT_MIN <= size <= FLT_MAX:
        mantissa, exponent = math.frexp(value)
        return math.ldexp(int(mantissa * 2.0**MANTISSA_BITS), exponent - MANTISSA_BITS)
    if size < FLT_MIN:
        return 0.0
    if math.isinf(value):
        return value
    return math.copysign(FLT_MAX, value) if size > FLT_MAX else math.inf


def rounding_error(constant: Constant) -> float:
    """Value that both float32 arithmetics hold for a constant, minus its true value."""
    return nearest(constant.value) - constant.value


class Single(Arithmetic[T]):
    """Operations derived from the rounded sum and product, for one number and for arrays.

    A double holds the product of two singles exactly, and rounding its sum, quotient or root again to a single is
    innocuous (53 >= 2 * 24 + 2 bits), so intermediate doubles are not more precise than the target.
    """

    name: ClassVar[str] = "float32"
    wide: ClassVar[bool] = True

    @abstractmethod
    def operand(self, value: Any) -> T:
        """A real number as an operand, rounded like the result of an operation."""

    @abstractmethod
    def _estimate(self, a: T) -> T:
        """1/a to 8 bits."""

    def convert(self, a: T, q_from: int, q_to: int) -> T:
        return a

    def sub(self, a: Any, b: Any) -> Any:
        return self.add(a, -b)

    def abs(self, a: Any) -> Any:
        return abs(a)

    def rmpy(self, a: T, b: T, q: int) -> T:
        return self.mpy(a, b, q)

    def rsmpy(self, a: T, b: T, q: int) -> T:
        return self.mpy(a, b, q)

    def mpy_iqx(self, a: T, q_a: int, b: T, q_b: int, q: int) -> T:
        return self.mpy(a, b, q)

    def dot(self, coefficients: Sequence[T], values: Sequence[T], q: int) -> T:
        products = [self.mpy(c, v, q) for c, v in zip(coefficients, values, strict=True)]
        total = products[0]
        for product in products[1:]:
            total = self.add(total, product)
        return total

    def div(self, a: T, b: T, q: int) -> T:
        reciprocal = self._estimate(b)
        two = self.operand(2.0)
        for _ in range(2):
            reciprocal = self.mpy(reciprocal, self.sub(two, self.mpy(b, reciprocal, q)), q)
        return self.mpy(a, self._by_infinity(b, reciprocal), q)

    @abstractmethod
    def _by_infinity(self, b: T, reciprocal: T) -> T:
        """0 where ``b`` is infinite, else ``reciprocal``."""

    def sat(self, a: T, upper: T, lower: T) -> T:
        return self.clip(a, upper, lower)

    def clip(self, a: T, upper: T, lower: T) -> T:
        return self.minimum(self.maximum(a, lower), upper)


class Float32(Single[float], OneTrain[float]):
    """Single precision for one train, rounding to nearest even."""

    def operand(self, value: Any) -> float:
        return nearest(value)

    def const(self, constant: Constant) -> float:
        # The compiler rounds constants to nearest in every mode of the unit.
        return nearest(constant.value)

    def raw(self, a: float, q: int) -> Any:
        # F32TOI32 saturates.
        return math.floor(min(max(math.ldexp(a, q) + 0.5, INT32_MIN), INT32_MAX))

    def from_raw(self, raw: Any, q: int) -> float:
        return self.operand(math.ldexp(raw, -q))

    def quantise(self, a: float, q_from: int, q_to: int) -> float:
        # On the target: scale, F32TOI32, correct by one where the fraction left is >= 0.5 or < -0.5, scale; a number of
        # 2^23 or more is an integer. All these steps are exact; x + 0.5 in single precision is not: 0.49999997 gives 1.
        return math.ldexp(math.floor(math.ldexp(a, q_to) + 0.5), -q_to) if abs(a) <= FLT_MAX else a

    def add(self, a: float, b: float) -> float:
        return nearest(a + b)

    def neg(self, a: float) -> float:
        return 0.0 - a

    def mpy(self, a: float, b: float, q: int) -> float:
        return nearest(a * b)

    def _estimate(self, a: float) -> float:
        if a == 0.0 or abs(a) > FLT_MAX:
            return math.inf if a == 0.0 else 0.0
        mantissa, exponent = math.frexp(a)
        digits = math.floor(math.ldexp(1.0 / mantissa, ESTIMATE_BITS) + 0.5)
        return self.operand(math.ldexp(digits, -ESTIMATE_BITS - exponent))

    def _by_infinity(self, b: float, reciprocal: float) -> float:
        return 0.0 if abs(b) > FLT_MAX else reciprocal

    def sqrt(self, a: float, q: int) -> float:
        return self.operand(math.sqrt(a)) if a > 0 else 0.0

    def curve(self, curve: Curve, a: float) -> float:
        scaled = a * 256.0
        index = int(min(scaled, LAST_CELL))
        left, right = (self.const(sample) for sample in curve.samples[index : index + 2])
        return self.add(left, self.mpy(self.sub(right, left), scaled - index, 0))

    def table(self, name: str, constants: Sequence[Constant]) -> Any:
        return self.load(constants)


class Float32Truncated(Float32):
    """Single precision for one train, rounding toward zero: the unit's state after reset, a stress test of a law."""

    name: ClassVar[str] = "float32-truncated"

    def operand(self, value: Any) -> float:
        return toward_zero(value)

    def add(self, a: float, b: float) -> float:
        total = a + b
        # The double itself is rounded: the exact rounding error (Knuth's TwoSum) shows whether its magnitude is too
        # large. With an infinite operand that error is NaN, and every comparison is false.
        b_part = total - a
        lost = (a - (total - b_part)) + (b - b_part)
        if lost * total < 0:
            total = math.nextafter(total, 0.0)
        return toward_zero(total)

    def mpy(self, a: float, b: float, q: int) -> float:
        return toward_zero(a * b)
