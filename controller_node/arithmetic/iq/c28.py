"""Profile of the TMS320F28335: the results of TI's C28x IQmath library.

Restated from TI's IQmath user's guide V1.70 and published headers (facts only, no code). Exact where a document fixes
the result bit by bit. Quotient, roots, exponential, logarithm, sine, cosine and their inverses are modelled as the
exact value, rounded to nearest (ties upward) and saturated; TI's guide gives 28 bits for the quotient (7 LSB of 2^31),
29 for the roots (6), 30 for the sine and 26 for the arctangent, and no figure for exponential, logarithm, asin, acos.
"""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np

from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, INT32_MAX, INT32_MIN, SATURATION
from railhil.controller_node.arithmetic.iq import decimals, series
from railhil.controller_node.arithmetic.iq.core import FixedPoint
from railhil.controller_node.arithmetic.iq.core_batch import FixedPointBatch, Ints
from railhil.controller_node.arithmetic.iq.interface import check_trig_format


class C28(FixedPoint):
    """IQmath of the C28x for one train, on plain ``int``."""

    name: ClassVar[str] = "iq"

    def div(self, a: int, b: int, q: int) -> int:
        if b == 0:
            return self._divided_by_zero()
        if b < 0:
            a, b = -a, -b
        exact = ((a << (q + 1)) + b) // (2 * b)
        return exact if INT32_MIN <= exact <= INT32_MAX else self._limited(exact)

    def int_part(self, a: int, q: int) -> int:
        return a >> q if a >= 0 else -(self._size(a) >> q)

    def frac(self, a: int, q: int) -> int:
        mask = (1 << q) - 1
        return a & mask if a >= 0 else -(self._size(a) & mask)

    def _size(self, a: int) -> int:
        return self._limited(abs(a))

    def mpy_i32_int(self, a: int, n: int, q: int) -> int:
        whole = (self._size(a) * self._size(n)) >> q
        if whole > INT32_MAX:
            whole = self._wrapped(whole)
        # The sign is put on the low 32 bits with OVM set (NEGTC).
        return whole if (a < 0) == (n < 0) else self._limited(-whole)

    def mpy_i32_frac(self, a: int, n: int, q: int) -> int:
        part = (self._size(a) * self._size(n)) & ((1 << q) - 1)
        return part if (a < 0) == (n < 0) else -part

    # The root of four times the exact square is twice the result: its last bit decides the rounding.

    def sqrt(self, a: int, q: int) -> int:
        return (math.isqrt(a << (q + 2)) + 1) >> 1 if a > 0 else 0

    def isqrt(self, a: int, q: int) -> int:
        return self._limited((math.isqrt((1 << (3 * q + 2)) // a) + 1) >> 1) if a > 0 else 0

    def mag(self, a: int, b: int, q: int) -> int:
        return self._limited((math.isqrt((a * a + b * b) << 2) + 1) >> 1)

    def exp(self, a: int, q: int) -> int:
        smallest, largest = series.exp_range(q)
        if a > largest:
            self._count(SATURATION, 1)
        return series.exp(min(max(a, smallest), largest), q, q)

    def log(self, a: int, q: int) -> int:
        if a <= 0:
            self._count(SATURATION, 1)
            return INT32_MIN
        return self._limited(series.log(a, q, q))

    def sin(self, a: int, q: int) -> int:
        check_trig_format(q)
        return series.sine(a, q, q)

    def cos(self, a: int, q: int) -> int:
        check_trig_format(q)
        return series.sine(a, q, q, quadrants=1)

    def sin_pu(self, a: int, q: int) -> int:
        return series.sine_of_turns(a, q, q)

    def cos_pu(self, a: int, q: int) -> int:
        return series.sine_of_turns(a, q, q, quadrants=1)

    def _limited_to_one(self, a: int, q: int) -> int:
        """``a`` inside -1 to 1."""
        limited = self.clip(a, 1 << q, -(1 << q))
        if limited != a:
            self._count(SATURATION, 1)
        return limited

    def asin(self, a: int, q: int) -> int:
        check_trig_format(q)
        return series.arcsine(self._limited_to_one(a, q), q, q)

    def acos(self, a: int, q: int) -> int:
        check_trig_format(q)
        return series.arcsine(self._limited_to_one(a, q), q, q, cosine=True)

    def atan2(self, y: int, x: int, q: int) -> int:
        check_trig_format(q)
        return series.angle(y, x, q)

    def atan2_pu(self, y: int, x: int, q: int) -> int:
        return series.turn(y, x, q)

    def to_f(self, a: int, q: int) -> int:
        if a == 0:
            return 0
        # Shifted up until the two top bits differ, then complemented: 30 bits follow the leading one.
        sign, size = (0, a) if a > 0 else (1 << 31, ~a)
        shift = 31 - size.bit_length()
        normal = (size << shift) | ((1 << shift) - 1 if a < 0 else 0)
        exponent = 127 + 30 - q - shift
        return sign | exponent << 23 | (normal >> 7) & 0x7FFFFF

    def ato_iq(self, text: Any, q: int) -> int:
        return self._limited(decimals.rounded_decimal(text, q))

    def to_a(self, form: str, a: int, q: int) -> Any:
        return decimals.c28_decimal(form, a, q)


class C28Batch(FixedPointBatch):
    """IQmath of the C28x for N trains."""

    name: ClassVar[str] = "iq"
    one_train = C28

    def div(self, a: Ints, b: Ints, q: int) -> Any:
        numerator, denominator = np.broadcast_arrays(np.asarray(a, dtype=np.int64), np.asarray(b, dtype=np.int64))
        by_zero = denominator == 0
        self._count_where(DIVISION_BY_ZERO, by_zero)
        numerator = np.where(denominator < 0, -numerator, numerator)
        denominator = np.where(by_zero, 1, abs(denominator))
        quotient = ((numerator << (q + 1)) + denominator) // (2 * denominator)
        return self._limit(np.where(by_zero, INT32_MAX, quotient))

    def int_part(self, a: Ints, q: int) -> Any:
        return np.sign(a) * (self._limit(abs(a)) >> q)

    def frac(self, a: Ints, q: int) -> Any:
        return np.sign(a) * (self._limit(abs(a)) & ((1 << q) - 1))

    def _sizes(self, a: Ints, n: Ints) -> tuple[Any, Any]:
        """Product of the sizes, and its sign."""
        return self._limit(abs(a)) * self._limit(abs(n)), np.sign(a) * np.sign(n)

    def mpy_i32_int(self, a: Ints, n: Ints, q: int) -> Any:
        product, sign = self._sizes(a, n)
        # The sign is put on the low 32 bits with OVM set (NEGTC).
        return self._limit(sign * self._wrap(product >> q))

    def mpy_i32_frac(self, a: Ints, n: Ints, q: int) -> Any:
        product, sign = self._sizes(a, n)
        return sign * (product & ((1 << q) - 1))
