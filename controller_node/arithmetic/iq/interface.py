"""The functions of TI's IQmath beyond those of every arithmetic, with the differences between the two profiles.

A number is an int32 raw value in a format Q ``q`` (1 to 30): value = raw / 2^q. "C28x" is the library of the
TMS320F28335 (TI IQmath user's guide V1.70 and published headers), "portable" TI's open C library 2.01.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, WRAP, Arithmetic, Constant, T

#: Largest format of an angle in rad: pi needs two integer bits.
TRIG_Q_MAX = 29


def check_trig_format(q: int) -> None:
    """Raise ``ValueError`` for formats in which neither library has the functions of an angle in rad."""
    if q > TRIG_Q_MAX:
        raise ValueError(f"sin, cos, asin, acos and atan2 in rad exist for Q1 to Q{TRIG_Q_MAX}, not for Q{q}")


class IqMath(Arithmetic[T]):
    """IQmath on one kind of operand."""

    wide: ClassVar[bool] = False

    def _count(self, kind: int, count: int) -> None:
        """Count wraps, saturations or divisions by zero, and record before which noted quantity they occurred."""
        counters = self.counters
        if kind == WRAP:
            counters.wraps += count
        elif kind == DIVISION_BY_ZERO:
            counters.zero_divisions += count
        else:
            counters.saturations += count
        if self.noted is not None:
            self.events.append((len(self.noted), kind, count))

    def const(self, constant: Constant) -> T:
        raw: Any = constant.raw
        return raw  # type: ignore[no-any-return]

    def raw(self, a: T, q: int) -> T:
        return a

    def from_raw(self, raw: Any, q: int) -> T:
        return raw  # type: ignore[no-any-return]

    @abstractmethod
    def shl(self, a: T, count: int) -> T:
        """``a << count``, wrapping; count 0 to 31."""

    def shr(self, a: Any, count: int) -> Any:
        """``a >> count``, floor (arithmetic shift)."""
        return a >> count

    def convert(self, a: Any, q_from: int, q_to: int) -> Any:
        return self.shl(a, q_to - q_from) if q_to > q_from else a >> (q_from - q_to)

    def quantise(self, a: T, q_from: int, q_to: int) -> T:
        one: Any = 1
        return self.rmpy(a, one, q_from - q_to)

    @abstractmethod
    def sadd(self, a: T, b: T) -> T:
        """a + b, saturating (a C28x sum with OVM = 1)."""

    @abstractmethod
    def ssub(self, a: T, b: T) -> T:
        """a - b, saturating (OVM = 1)."""

    @abstractmethod
    def mpy_i32(self, a: T, n: T) -> T:
        """``_IQ<q>mpyI32``: number times integer, wrapping."""

    @abstractmethod
    def mpy_i32_int(self, a: T, n: T, q: int) -> T:
        """``_IQ<q>mpyI32int``: integer part of number times integer.

        C28x: toward zero, from the 64-bit product of the magnitudes, low 32 bits; the magnitude of INT32_MIN is taken
        as INT32_MAX, and negating low bits equal to INT32_MIN gives INT32_MAX (NEGTC with OVM set). Portable: floor of
        the wrapped product.
        """

    @abstractmethod
    def mpy_i32_frac(self, a: T, n: T, q: int) -> T:
        """``_IQ<q>mpyI32frac``: fraction of number times integer, in Q ``q``.

        C28x: of the product of the magnitudes, with its sign. Portable: 0 or positive.
        """

    @abstractmethod
    def int_part(self, a: T, q: int) -> T:
        """``_IQ<q>int``: integer part. C28x: toward zero, INT32_MIN as -INT32_MAX. Portable: floor."""

    @abstractmethod
    def frac(self, a: T, q: int) -> T:
        """``_IQ<q>frac``: the rest after :meth:`int_part`, in Q ``q``.

        C28x: with the sign of a. Portable: 0 or positive.
        """

    @abstractmethod
    def isqrt(self, a: T, q: int) -> T:
        """``_IQ<q>isqrt``: 1 / root of a, saturating; 0 for a <= 0. C28x: modelled exact, rounded to nearest."""

    @abstractmethod
    def mag(self, a: T, b: T, q: int) -> T:
        """``_IQ<q>mag``: root of a^2 + b^2, saturating. C28x: modelled exact, rounded to nearest."""

    @abstractmethod
    def exp(self, a: T, q: int) -> T:
        """``_IQ<q>exp``: e^a.

        C28x: the *argument* is limited to the range of the format on both sides, so the largest result is below
        INT32_MAX and the smallest is 1 LSB, never 0; modelled exact, rounded to nearest. Portable: INT32_MAX above
        that range, 0 below it. The upper limit counts as a saturation; the lower one moves the result by less than
        1 LSB and does not.
        """

    @abstractmethod
    def log(self, a: T, q: int) -> T:
        """``_IQ<q>log``: natural logarithm, INT32_MIN where it is below the format (counted as a saturation).

        a <= 0: C28x INT32_MIN (counted), portable 0 (not counted). C28x: modelled exact, rounded to nearest.
        """

    @abstractmethod
    def sin(self, a: T, q: int) -> T:
        """``_IQ<q>sin`` of an angle in rad. C28x: modelled exact, rounded to nearest. ``ValueError`` for Q30."""

    @abstractmethod
    def cos(self, a: T, q: int) -> T:
        """``_IQ<q>cos`` of an angle in rad; as :meth:`sin`."""

    @abstractmethod
    def sin_pu(self, a: T, q: int) -> T:
        """``_IQ<q>sinPU`` of an angle in turns. C28x: modelled exact, rounded to nearest."""

    @abstractmethod
    def cos_pu(self, a: T, q: int) -> T:
        """``_IQ<q>cosPU`` of an angle in turns; as :meth:`sin_pu`."""

    @abstractmethod
    def asin(self, a: T, q: int) -> T:
        """``_IQ<q>asin``: angle in rad whose sine is a, -pi/2 to pi/2. ``ValueError`` for Q30.

        C28x: modelled exact, rounded to nearest; an argument outside -1 to 1 is limited (counted as a saturation),
        which no document specifies. Portable: 0 outside -1 to 1, not counted.
        """

    @abstractmethod
    def acos(self, a: T, q: int) -> T:
        """``_IQ<q>acos``: angle in rad whose cosine is a, 0 to pi; as :meth:`asin`. Portable: pi/2 outside -1 to 1."""

    @abstractmethod
    def atan2(self, y: T, x: T, q: int) -> T:
        """``_IQ<q>atan2``: angle of the point (x, y) in rad, -pi to pi. ``ValueError`` for Q30.

        C28x: modelled exact, rounded to nearest; 0 for the origin, which no document specifies. Portable: pi/4 for the
        origin.
        """

    @abstractmethod
    def atan2_pu(self, y: T, x: T, q: int) -> T:
        """``_IQ<q>atan2PU``: angle of the point (x, y) in turns; origin as in :meth:`atan2`.

        C28x: 0 to 1, modelled exact, rounded to nearest. Portable: -1/2 to 1/2.
        """

    @abstractmethod
    def to_f(self, a: T, q: int) -> T:
        """``_IQ<q>toF``: bits of the float32, as an integer 0..2^32 - 1.

        C28x: truncated to 24 bits, negative numbers in one's complement (-1.0 becomes -0.99999994). Portable: rounded,
        ties away from zero.
        """

    @abstractmethod
    def from_float(self, value: Any, q: int) -> T:
        """``_IQ<q>(value)`` of the target's compiler: truncation toward zero, of a float or an array of them.

        Raises ``ValueError`` outside int32 (undefined on the target), for NaN and infinity.
        """

    @abstractmethod
    def ato_iq(self, text: Any, q: int) -> T:
        """``_atoIQ<q>``: number of a decimal text, saturating; 0 for an illegal character.

        C28x: modelled exact, rounded to nearest (ties away from zero). Portable: adds tenths of 31 bits, and loses
        the sign of a text without a point.
        """

    @abstractmethod
    def to_a(self, form: str, a: T, q: int) -> Any:
        """``_IQ<q>toa``: (error, text) for a format ``%A.Bf``; error 1: A digits are too few, 2: illegal format.

        ``A`` (at most 11) digits of the integer part, not counting the sign; the fraction is truncated. In case of an
        error the text is None. Portable: the integer part is padded with zeros, B digits after the point. C28x: no
        leading zeros, B includes the point, INT32_MIN is refused with error 1; this is our interpretation of the guide,
        not checked on a target.
        """
