"""IEEE double precision: the reference for every other arithmetic.

Formats are ignored, nothing wraps or saturates. A division by zero gives infinity with the sign of the numerator and
0 / 0 plus infinity, as in float32. One train (plain ``float``) and N trains (float64 arrays) give equal bits: both
evaluate the same operations in the same order, and functions element by element with :mod:`math`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.controller_node.arithmetic.arrays import ManyTrains
from railhil.controller_node.arithmetic.base import Arithmetic, Constant, Curve, OneTrain, Problem, T

Floats: TypeAlias = NDArray[np.float64]


class _Double(Arithmetic[T]):
    """The operations that are the same for one float and for arrays."""

    name: ClassVar[str] = "float64"
    wide: ClassVar[bool] = True
    solves: ClassVar[bool] = True

    def const(self, constant: Constant) -> T:
        value: Any = constant.value
        return value  # type: ignore[no-any-return]

    def convert(self, a: T, q_from: int, q_to: int) -> T:
        return a

    def add(self, a: Any, b: Any) -> Any:
        return a + b

    def sub(self, a: Any, b: Any) -> Any:
        return a - b

    def neg(self, a: Any) -> Any:
        return -a

    def abs(self, a: Any) -> Any:
        return abs(a)

    def mpy(self, a: Any, b: Any, q: int) -> Any:
        return a * b

    def rmpy(self, a: Any, b: Any, q: int) -> Any:
        return a * b

    def rsmpy(self, a: Any, b: Any, q: int) -> Any:
        return a * b

    def mpy_iqx(self, a: Any, q_a: int, b: Any, q_b: int, q: int) -> Any:
        return a * b

    def dot(self, coefficients: Sequence[Any], values: Sequence[Any], q: int) -> Any:
        total: Any = 0.0
        for coefficient, value in zip(coefficients, values, strict=True):
            total = total + coefficient * value
        return total

    def sat(self, a: T, upper: T, lower: T) -> T:
        return self.clip(a, upper, lower)


class Float64(_Double[float], OneTrain[float]):
    """Double precision for one train."""

    def raw(self, a: float, q: int) -> Any:
        return math.floor(math.ldexp(a, q) + 0.5)

    def from_raw(self, raw: Any, q: int) -> float:
        return math.ldexp(raw, -q)

    def quantise(self, a: float, q_from: int, q_to: int) -> float:
        return math.ldexp(math.floor(math.ldexp(a, q_to) + 0.5), -q_to) if math.isfinite(a) else a

    def div(self, a: float, b: float, q: int) -> float:
        if b == 0.0:
            return -math.inf if a < 0.0 else math.inf
        return a / b

    def clip(self, a: float, upper: float, lower: float) -> float:
        return min(max(a, lower), upper)

    def minimum(self, a: float, b: float) -> float:
        return min(a, b)

    def maximum(self, a: float, b: float) -> float:
        return max(a, b)

    def curve(self, curve: Curve, a: float) -> float:
        return curve.function(a)

    def table(self, name: str, constants: Sequence[Constant]) -> Any:
        return tuple(constant.value for constant in constants)

    def sqrt(self, a: float, q: int) -> float:
        return math.sqrt(a) if a > 0 else 0.0

    def solve(self, problem: Problem, values: Sequence[float]) -> tuple[float, ...]:
        return tuple(problem.function(values))


class Float64Batch(_Double[Floats], ManyTrains[Floats]):
    """Double precision for N trains; operands are arrays of shape (N,) or plain numbers common to all."""

    def raw(self, a: Floats, q: int) -> Any:
        return np.floor(np.ldexp(a, q) + 0.5).astype(np.int64)

    def from_raw(self, raw: Any, q: int) -> Floats:
        return np.ldexp(np.asarray(raw, dtype=np.float64), -q)

    def quantise(self, a: Floats, q_from: int, q_to: int) -> Floats:
        return np.ldexp(np.floor(np.ldexp(a, q_to) + 0.5), -q_to)

    def div(self, a: Floats, b: Floats, q: int) -> Any:
        with np.errstate(all="ignore"):
            quotient = np.divide(a, b)
        return np.where(b == 0.0, np.where(a < 0.0, -np.inf, np.inf), quotient)

    def clip(self, a: Floats, upper: Floats, lower: Floats) -> Floats:
        return np.minimum(np.maximum(a, lower), upper)

    def curve(self, curve: Curve, a: Floats) -> Floats:
        # Evaluate each distinct number once: trains of one scenario often have equal values.
        values = np.ascontiguousarray(a, dtype=np.float64)
        raw = values.view(np.int64)
        if raw.size and (raw == raw.flat[0]).all():
            return np.full(np.shape(a), curve.function(float(values.flat[0])))
        bits, places = np.unique(raw, return_inverse=True)
        return np.array([curve.function(x) for x in bits.view(np.float64).tolist()])[places].reshape(np.shape(a))

    def table(self, name: str, constants: Sequence[Constant]) -> Any:
        return np.array([constant.value for constant in constants])

    def sqrt(self, a: Floats, q: int) -> Floats:
        return np.asarray(np.sqrt(np.maximum(a, 0.0)))

    def solve(self, problem: Problem, values: Sequence[Floats]) -> tuple[Floats, ...]:
        # One after the other, so that each train has the bits that it has alone.
        rows = np.stack(np.broadcast_arrays(*(np.atleast_1d(value) for value in values)), axis=1).tolist()
        return tuple(np.array([problem.function(row) for row in rows], dtype=np.float64).T)
