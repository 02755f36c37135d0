"""The operations available to a control law: one interface, several number systems.

A law is straight-line code of these operations. Comparisons yield a condition that only :meth:`Arithmetic.where`
consumes, so the same code runs on one train, on arrays over N trains, or under a recorder that writes C.

Every quantity has a Q format, the number of fraction bits of its int32 (value = raw / 2^Q). Formats are arguments where
they affect a result; arithmetics with a wide format (float64) ignore them.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar

INT32_MIN = -(2**31)
INT32_MAX = 2**31 - 1

#: Bits of :attr:`Counters.flags`, as in CTL_STAT.
WRAP = 1
SATURATION = 2
DIVISION_BY_ZERO = 4

#: ``float``, ``int``, or a numpy array of either (one element per train).
T = TypeVar("T")

#: ``bool`` or an array of them, the result of a comparison.
Condition: TypeAlias = Any


@dataclass(frozen=True, slots=True)
class Constant:
    """A number known before the run, with the format in which a fixed-point arithmetic holds it.

    ``raw`` is rounded to nearest (``_IQ()`` of the target truncates: constants are therefore emitted as integers).
    Raises ``ValueError`` when the value does not fit into int32.
    """

    name: str
    value: float
    q: int
    #: Where the value comes from: equation, parameter, limit.
    origin: str = field(default="", compare=False)
    #: Integer that represents the value in Q ``q``.
    raw: int = field(init=False)

    def __post_init__(self) -> None:
        raw = math.floor(math.ldexp(self.value, self.q) + 0.5) if math.isfinite(self.value) else INT32_MAX + 1
        if not INT32_MIN <= raw <= INT32_MAX:
            raise ValueError(f"constant {self.name} = {self.value!r} does not fit into int32 with Q{self.q}")
        object.__setattr__(self, "raw", raw)

    @property
    def rounding_error(self) -> float:
        """Held value minus true value."""
        return math.ldexp(self.raw, -self.q) - self.value

    @property
    def relative_error(self) -> float:
        """Magnitude of the rounding error relative to that of the value, 0 for the value 0."""
        return abs(self.rounding_error / self.value) if self.value else 0.0


@dataclass(frozen=True)
class Curve:
    """A function on 0..1 for use in a law: evaluated exactly where possible, else from 257 samples.

    The table is interpolated linearly: argument in Q ``q_in`` (at least 8), result in Q ``q_out``.
    """

    name: str
    function: Callable[[float], float]
    q_in: int
    q_out: int
    samples: tuple[Constant, ...]

    @classmethod
    def sampled(cls, name: str, function: Callable[[float], float], q_in: int, q_out: int, origin: str = "") -> Curve:
        """The curve with its table made from the function."""
        samples = (Constant(f"{name}[{i}]", function(i / 256), q_out, origin) for i in range(257))
        return cls(name, function, q_in, q_out, tuple(samples))


@dataclass(frozen=True, eq=False)
class Problem:
    """A problem that a library solves in each step, such as an optimisation with constraints: no formula of operations.

    ``function``: ``inputs`` numbers in, ``outputs`` numbers out; pure: equal inputs give equal outputs.
    """

    name: str
    inputs: int
    outputs: int
    function: Callable[[Sequence[float]], Sequence[float]]


@dataclass(slots=True)
class Counters:
    """Events in an arithmetic since it was made; always zero in wide arithmetics."""

    wraps: int = 0
    saturations: int = 0
    zero_divisions: int = 0

    @property
    def flags(self) -> int:
        """Bit 0 wrap, bit 1 saturation, bit 2 division by zero."""
        return (
            (WRAP if self.wraps else 0)
            | (SATURATION if self.saturations else 0)
            | (DIVISION_BY_ZERO if self.zero_divisions else 0)
        )


class Arithmetic(ABC, Generic[T]):
    """The operations of a law, named after TI's IQmath where it has the operation."""

    #: Name used on the command line and in every record of a run.
    name: ClassVar[str]
    #: True when no format can overflow. Laws put their format limits under ``if not arithmetic.wide``; that is a
    #: property of the build, not of the data.
    wide: ClassVar[bool]
    #: True when it has :meth:`solve`.
    solves: ClassVar[bool] = False

    def __init__(self) -> None:
        self.counters = Counters()
        #: List that collects every noted quantity in order, if telemetry is on.
        self.noted: list[T] | None = None
        #: While ``noted`` is a list, each wrap, saturation or division by zero: quantities noted so far, kind, count.
        #: It is assigned to the quantity that is noted next.
        self.events: list[tuple[int, int, int]] = []

    def note(self, name: str, a: T, q: int, unit: str = "") -> T:
        """Name ``a`` (in Q ``q``) as a quantity of the law; returns it unchanged.

        Names, formats and order of the notes are the same in every step. Telemetry, the audit and the exported C use
        these names.
        """
        if self.noted is not None:
            self.noted.append(a)
        return a

    def note_all(self, name: str, values: Sequence[T], q: int, unit: str = "") -> tuple[T, ...]:
        """:meth:`note` for each of several: ``name[0]``, ``name[1]``, ..."""
        if self.noted is not None:
            self.noted.extend(values)
        return tuple(values)

    @abstractmethod
    def const(self, constant: Constant) -> T:
        """The constant as an operand."""

    def load(self, constants: Sequence[Constant]) -> tuple[T, ...]:
        """Several constants as operands."""
        return tuple(self.const(constant) for constant in constants)

    @abstractmethod
    def raw(self, a: T, q: int) -> T:
        """Integer that represents ``a`` in Q ``q`` (``a`` is already in that format): for the wire and telemetry."""

    @abstractmethod
    def from_raw(self, raw: Any, q: int) -> T:
        """The operand represented by an integer in Q ``q``: the inverse of :meth:`raw`."""

    @abstractmethod
    def convert(self, a: T, q_from: int, q_to: int) -> T:
        """Same value in another format: left shift wraps, right shift floors."""

    @abstractmethod
    def quantise(self, a: T, q_from: int, q_to: int) -> T:
        """Nearest multiple of 2^-q_to, ties upward; ``q_to`` < ``q_from``. Quantises in every arithmetic."""

    @abstractmethod
    def add(self, a: T, b: T) -> T:
        """a + b, wrapping."""

    @abstractmethod
    def sub(self, a: T, b: T) -> T:
        """a - b, wrapping."""

    @abstractmethod
    def neg(self, a: T) -> T:
        """-a, wrapping (INT32_MIN stays)."""

    @abstractmethod
    def abs(self, a: T) -> T:
        """Absolute value of a, wrapping (INT32_MIN stays)."""

    @abstractmethod
    def mpy(self, a: T, b: T, q: int) -> T:
        """``_IQ<q>mpy``: product shifted right by q, floor, wrapping. The result's Q is Qa + Qb - q."""

    @abstractmethod
    def rmpy(self, a: T, b: T, q: int) -> T:
        """``_IQ<q>rmpy``: as :meth:`mpy` with rounding, ties upward; q >= 1."""

    @abstractmethod
    def rsmpy(self, a: T, b: T, q: int) -> T:
        """``_IQ<q>rsmpy``: as :meth:`rmpy`, saturating instead of wrapping."""

    @abstractmethod
    def mpy_iqx(self, a: T, q_a: int, b: T, q_b: int, q: int) -> T:
        """``_IQ<q>mpyIQX``: product of two formats in a third, floor, wrapping."""

    @abstractmethod
    def dot(self, coefficients: Sequence[T], values: Sequence[T], q: int) -> T:
        """Sum of ``rmpy(coefficient, value, q)`` in order, wrapping; q >= 1."""

    @abstractmethod
    def div(self, a: T, b: T, q: int) -> T:
        """``_IQ<q>div``: quotient of two numbers of one format, in Q ``q``; rounded, saturating."""

    @abstractmethod
    def sqrt(self, a: T, q: int) -> T:
        """``_IQ<q>sqrt``: root of a number in Q ``q``, in Q ``q``; rounded, 0 for a <= 0."""

    @abstractmethod
    def sat(self, a: T, upper: T, lower: T) -> T:
        """``_IQsat`` as a format limit: counted when it limits."""

    @abstractmethod
    def clip(self, a: T, upper: T, lower: T) -> T:
        """``_IQsat`` as part of a law's equations: not counted."""

    @abstractmethod
    def minimum(self, a: T, b: T) -> T:
        """Smaller of the two."""

    @abstractmethod
    def maximum(self, a: T, b: T) -> T:
        """Larger of the two."""

    def gt(self, a: Any, b: Any) -> Condition:
        """Condition a > b."""
        return a > b

    @abstractmethod
    def where(self, condition: Condition, a: T, b: T) -> T:
        """a where the condition is true, else b; both are evaluated."""

    @abstractmethod
    def curve(self, curve: Curve, a: T) -> T:
        """``curve`` at ``a`` (in Q ``curve.q_in``, inside 0..1), result in Q ``curve.q_out``."""

    @abstractmethod
    def table(self, name: str, constants: Sequence[Constant]) -> Any:
        """Constants of one format as a table for :meth:`at` and :meth:`locate`."""

    def at(self, table: Any, index: Any, offset: int = 0) -> T:
        """Entry ``index + offset`` of a table; the index comes from :meth:`locate` or :meth:`index`."""
        return table[index + offset]  # type: ignore[no-any-return]

    @abstractmethod
    def index(self, k: Any, last: int) -> Any:
        """Table index from an integer: ``k`` limited to 0..``last``."""

    @abstractmethod
    def locate(self, table: Any, a: T) -> Any:
        """Index of the last entry <= a of an increasing table, at least 0 and at most the last index minus one."""

    def solve(self, problem: Problem, values: Sequence[T]) -> tuple[T, ...]:
        """Solution of a problem for its inputs, in double precision.

        :raises TypeError: an arithmetic whose :attr:`solves` is false.
        """
        raise TypeError(f"{self.name} cannot solve {problem.name}")


class OneTrain(Arithmetic[T]):
    """Choices between two numbers, and places in tables, as they are for one train in every number system."""

    def minimum(self, a: Any, b: Any) -> Any:
        return a if a < b else b

    def maximum(self, a: Any, b: Any) -> Any:
        return a if a > b else b

    def where(self, condition: Condition, a: T, b: T) -> T:
        return a if condition else b

    def index(self, k: Any, last: int) -> Any:
        return min(max(k, 0), last)

    def locate(self, table: Any, a: T) -> Any:
        return min(max(bisect_right(table, a) - 1, 0), len(table) - 2)
