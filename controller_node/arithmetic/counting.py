"""Operation counts of a law and what they cost on a C28x at 150 MHz.

A law is straight-line code, so one counted step gives the cost of every step: it is the worst case too.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any, ClassVar

from controller_node.arithmetic.base import Arithmetic, Condition, Constant, Curve, T

#: Cycles with call and return, tables in internal memory: TI IQmath user's guide V1.70, section 4.3. ``add`` and
#: ``sub``, shifts, comparisons, branches and memory traffic are our estimates.
C28X_CYCLES = {
    "mpy": 6,
    "rmpy": 17,
    "rsmpy": 21,
    "mpy_iqx": 7,
    "div": 63,
    "sat": 7,
    "abs": 2,
    "convert": 4,
    "add": 2,
    "branch": 4,
    "load_store": 2,
}


def estimated_cycles(counts: Counter[str]) -> int:
    """Cycles of the counted operations with program and data in RAM; from flash allow twice as many."""
    return sum(C28X_CYCLES[operation] * count for operation, count in counts.items())


class Counting(Arithmetic[T]):
    """Counts the operations that pass through to another arithmetic."""

    name: ClassVar[str] = "counting"

    def __init__(self, inner: Arithmetic[T]) -> None:
        super().__init__()
        self._inner = inner
        self.counters = inner.counters
        self.wide = inner.wide  # type: ignore[misc]
        self.counts: Counter[str] = Counter()

    def _count(self, operation: str, times: int = 1) -> None:
        self.counts[operation] += times
        self.counts["load_store"] += times

    def const(self, constant: Constant) -> T:
        return self._inner.const(constant)

    def raw(self, a: T, q: int) -> T:
        return self._inner.raw(a, q)

    def from_raw(self, raw: Any, q: int) -> T:
        return self._inner.from_raw(raw, q)

    def convert(self, a: T, q_from: int, q_to: int) -> T:
        self._count("convert")
        return self._inner.convert(a, q_from, q_to)

    def quantise(self, a: T, q_from: int, q_to: int) -> T:
        self._count("rmpy")
        return self._inner.quantise(a, q_from, q_to)

    def add(self, a: T, b: T) -> T:
        self._count("add")
        return self._inner.add(a, b)

    def sub(self, a: T, b: T) -> T:
        self._count("add")
        return self._inner.sub(a, b)

    def neg(self, a: T) -> T:
        self._count("add")
        return self._inner.neg(a)

    def abs(self, a: T) -> T:
        self._count("abs")
        return self._inner.abs(a)

    def mpy(self, a: T, b: T, q: int) -> T:
        self._count("mpy")
        return self._inner.mpy(a, b, q)

    def rmpy(self, a: T, b: T, q: int) -> T:
        self._count("rmpy")
        return self._inner.rmpy(a, b, q)

    def rsmpy(self, a: T, b: T, q: int) -> T:
        self._count("rsmpy")
        return self._inner.rsmpy(a, b, q)

    def mpy_iqx(self, a: T, q_a: int, b: T, q_b: int, q: int) -> T:
        self._count("mpy_iqx")
        return self._inner.mpy_iqx(a, q_a, b, q_b, q)

    def dot(self, coefficients: Sequence[T], values: Sequence[T], q: int) -> T:
        self._count("rmpy", len(values))
        self._count("add", len(values) - 1)
        return self._inner.dot(coefficients, values, q)

    def div(self, a: T, b: T, q: int) -> T:
        self._count("div")
        return self._inner.div(a, b, q)

    def sat(self, a: T, upper: T, lower: T) -> T:
        self._count("sat")
        return self._inner.sat(a, upper, lower)

    def clip(self, a: T, upper: T, lower: T) -> T:
        self._count("sat")
        return self._inner.clip(a, upper, lower)

    def minimum(self, a: T, b: T) -> T:
        self._count("branch")
        return self._inner.minimum(a, b)

    def maximum(self, a: T, b: T) -> T:
        self._count("branch")
        return self._inner.maximum(a, b)

    def gt(self, a: T, b: T) -> Condition:
        self._count("add")
        return self._inner.gt(a, b)

    def where(self, condition: Condition, a: T, b: T) -> T:
        self._count("branch")
        return self._inner.where(condition, a, b)

    def curve(self, curve: Curve, a: T) -> T:
        self._count("convert", 2)
        self._count("branch")
        self._count("add", 3)
        self._count("mpy")
        return self._inner.curve(curve, a)

    def table(self, constants: Sequence[Constant]) -> Any:
        return self._inner.table(constants)

    def locate(self, table: Any, a: T) -> Any:
        steps = len(table).bit_length()
        self._count("add", 2 * steps)
        self._count("branch", steps)
        return self._inner.locate(table, a)
