"""Profile of TI's portable C library (IQmath 2.01): the results of a C export built with gcc and linked with it.

The algorithms are reimplemented from the open library (BSD 3-Clause, (c) 2023 Texas Instruments); tables come from
formulas. Results equal, bit for bit, those of the library built with 32-bit fast integer types and wrapping signed
overflow, except for three faults that are not reproduced: ``div`` of INT32_MIN always saturates there (here it is the
quotient of 2^31), ``toF`` halves a number whose 25 leading bits are ones (here the rounding carries), and TI's own copy
of 2.01 has a wrong ``mpy`` (both open copies are correct). The faults of ``atan2`` and ``atan2PU`` are reproduced:
arguments of equal magnitude mostly give a wrong angle, and near half a turn ``atan2`` has the wrong sign.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, INT32_MAX, INT32_MIN, SATURATION, T
from railhil.controller_node.arithmetic.iq import decimals, series
from railhil.controller_node.arithmetic.iq import portable_functions as functions
from railhil.controller_node.arithmetic.iq.core import MASK, SIGN, FixedPoint, low32
from railhil.controller_node.arithmetic.iq.core_batch import FixedPointBatch, Ints
from railhil.controller_node.arithmetic.iq.interface import IqMath


class _Parts(IqMath[T]):
    """Whole and fractional parts, which are those of floored numbers."""

    def int_part(self, a: Any, q: int) -> Any:
        return a >> q

    def frac(self, a: Any, q: int) -> Any:
        return a & ((1 << q) - 1)

    def mpy_i32_int(self, a: Any, n: Any, q: int) -> Any:
        return self.int_part(self.mpy_i32(a, n), q)

    def mpy_i32_frac(self, a: Any, n: Any, q: int) -> Any:
        return self.frac(self.mpy_i32(a, n), q)


class Portable(_Parts[int], FixedPoint):
    """IQmath of the portable C library for one train, on plain ``int``."""

    name: ClassVar[str] = "iq-portable"

    def clip(self, a: int, upper: int, lower: int) -> int:
        return upper if a > upper else lower if a < lower else a

    def div(self, a: int, b: int, q: int) -> int:
        if b == 0:
            return self._divided_by_zero()
        divisor = abs(b)
        shift = max(31 - divisor.bit_length(), 0)
        divisor <<= shift
        numerator = abs(a) << shift >> (30 - q)
        if numerator <= MASK:
            size: int = functions.quotient(functions.RECIPROCAL[(divisor >> 24) - 64] << 24, divisor, numerator)
            if size <= INT32_MAX:
                return size if (a < 0) == (b < 0) else -size
        self._count(SATURATION, 1)
        return INT32_MAX if (a < 0) == (b < 0) else INT32_MIN

    def sqrt(self, a: int, q: int) -> int:
        return functions.root(a, q)

    def isqrt(self, a: int, q: int) -> int:
        if a <= 0:
            return 0
        x = a << (q & 1)
        shift = functions.even_shift(x, 32)
        right = (30 - q) + ((32 - q) >> 1) - (shift >> 1)
        if right < 0:
            self._count(SATURATION, 1)
            return INT32_MAX
        return functions.rounded_shift(functions.inverse_root(x << shift, q), right)

    def mag(self, a: int, b: int, q: int) -> int:
        square = a * a + b * b
        if square == 0:
            return 0
        shift = functions.even_shift(square, 64)
        if shift == 0:
            self._count(SATURATION, 1)
            return INT32_MAX
        x = square << shift >> 32
        # One routine serves all formats, with the steps of the largest.
        return functions.rounded_shift(functions.unsigned(functions.inverse_root(x, 31), x), (shift >> 1) - 1)

    def exp(self, a: int, q: int) -> int:
        if a > series.exp_range(q)[1]:
            self._count(SATURATION, 1)
            return INT32_MAX
        return functions.exponential(a, q)

    def log(self, a: int, q: int) -> int:
        if 0 < a <= functions.ln_out_of_range(q):
            self._count(SATURATION, 1)
            return INT32_MIN
        return functions.logarithm(a, q) if a > 0 else 0

    def sin(self, a: int, q: int) -> int:
        return functions.sine_of_radians(a, q, cosine=False)

    def cos(self, a: int, q: int) -> int:
        return functions.sine_of_radians(a, q, cosine=True)

    def sin_pu(self, a: int, q: int) -> int:
        return functions.sine_of_turns(a, q, cosine=False)

    def cos_pu(self, a: int, q: int) -> int:
        return functions.sine_of_turns(a, q, cosine=True)

    def asin(self, a: int, q: int) -> int:
        return functions.arcsine(a, q)

    def acos(self, a: int, q: int) -> int:
        return functions.arccosine(a, q)

    def atan2(self, y: int, x: int, q: int) -> int:
        return functions.angle(y, x, q)

    def atan2_pu(self, y: int, x: int, q: int) -> int:
        return functions.turn(y, x, q)

    def to_f(self, a: int, q: int) -> int:
        if a == 0:
            return 0
        size = abs(a)
        shift = 32 - size.bit_length()
        # Added, not OR-ed: a mantissa that rounds up to 2 carries into the exponent.
        mantissa = ((size << shift) + 0x80) >> 8
        return (SIGN if a < 0 else 0) + ((126 + 31 - q - shift) << 23) + mantissa

    def ato_iq(self, text: Any, q: int) -> int:
        exact, saturated = decimals.portable_number(text, q)
        if saturated:
            self._count(SATURATION, 1)
        return low32(exact)

    def to_a(self, form: str, a: int, q: int) -> Any:
        return decimals.portable_decimal(form, a, q)


class PortableBatch(_Parts[Ints], FixedPointBatch):
    """IQmath of the portable C library for N trains."""

    name: ClassVar[str] = "iq-portable"
    one_train = Portable

    def clip(self, a: Ints, upper: Ints, lower: Ints) -> Any:
        return np.where(a > upper, upper, np.where(a < lower, lower, a))

    def div(self, a: Ints, b: Ints, q: int) -> Any:
        numerators, divisors = np.broadcast_arrays(np.asarray(a, dtype=np.int64), np.asarray(b, dtype=np.int64))
        by_zero = divisors == 0
        self._count_where(DIVISION_BY_ZERO, by_zero)
        negative = (numerators < 0) != (divisors < 0)
        divisor = np.where(by_zero, 1, abs(divisors))
        # frexp of an integer below 2^53 is exact: its exponent is the bit length.
        shift = np.maximum(31 - np.frexp(divisor.astype(np.float64))[1].astype(np.int64), 0)
        divisor = divisor << shift
        numerator = abs(numerators) << shift >> (30 - q)
        guess = functions.RECIPROCALS[(divisor >> 24) - 64] << 24
        # Unsigned 32-bit products need unsigned 64 bits.
        operands = [np.atleast_1d(x).astype(np.uint64) for x in (guess, divisor, numerator & MASK)]
        size = functions.quotient(*operands).astype(np.int64)
        size = np.where(numerator > MASK, MASK, size.reshape(divisor.shape))
        saturated = (size > INT32_MAX) & ~by_zero
        self._count_where(SATURATION, saturated)
        signed = np.where(saturated, np.where(negative, INT32_MIN, INT32_MAX), np.where(negative, -size, size))
        return np.where(by_zero, INT32_MAX, signed)
