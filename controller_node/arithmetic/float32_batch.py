"""Single precision of the C28x floating-point unit for N trains: float32 arrays, the same bits as ``float32``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.controller_node.arithmetic.arrays import ManyTrains
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN, Constant, Curve
from railhil.controller_node.arithmetic.float32 import (
    ESTIMATE_BITS,
    FLT_MAX,
    FLT_MIN,
    LAST_CELL,
    MANTISSA_BITS,
    Single,
    nearest,
)

Singles: TypeAlias = NDArray[np.float32]


class Float32Batch(Single[Singles], ManyTrains[Singles]):
    """Single precision for N trains, rounding to nearest even; operands are float32 of shape (N,) or common to all."""

    def _fit(self, value: Any) -> Any:
        """Doubles rounded like the result of an operation."""
        with np.errstate(over="ignore", under="ignore"):
            rounded = np.asarray(value, dtype=np.float64).astype(np.float32)
        return self._known(rounded)

    @staticmethod
    def _known(rounded: Any) -> Any:
        """Singles without denormals, -0 and NaN."""
        plain = np.where(np.isnan(rounded), np.float32(np.inf), rounded)
        return np.where(abs(plain) < np.float32(FLT_MIN), np.float32(0.0), plain)

    def operand(self, value: Any) -> Singles:
        return self._fit(value)  # type: ignore[no-any-return]

    def const(self, constant: Constant) -> Any:
        return np.float32(nearest(constant.value))

    def raw(self, a: Singles, q: int) -> Any:
        scaled = np.ldexp(np.asarray(a, dtype=np.float64), q)
        return np.floor(np.clip(scaled + 0.5, INT32_MIN, INT32_MAX)).astype(np.int64)

    def from_raw(self, raw: Any, q: int) -> Singles:
        return self.operand(np.ldexp(np.asarray(raw, dtype=np.float64), -q))

    def quantise(self, a: Singles, q_from: int, q_to: int) -> Any:
        scaled = np.ldexp(np.asarray(a, dtype=np.float64), q_to)
        return np.ldexp(np.floor(scaled + 0.5), -q_to).astype(np.float32)

    def add(self, a: Singles, b: Singles) -> Any:
        with np.errstate(invalid="ignore"):
            return self._fit(np.add(a, b, dtype=np.float64))

    def neg(self, a: Singles) -> Any:
        return np.float32(0.0) - a

    def mpy(self, a: Singles, b: Singles, q: int) -> Any:
        with np.errstate(invalid="ignore"):
            return self._fit(np.multiply(a, b, dtype=np.float64))

    def _estimate(self, a: Singles) -> Any:
        mantissa, exponent = np.frexp(np.asarray(a, dtype=np.float64))
        with np.errstate(divide="ignore"):
            digits = np.floor(np.ldexp(1.0 / mantissa, ESTIMATE_BITS) + 0.5)
        estimate = np.ldexp(digits, -ESTIMATE_BITS - exponent)
        return self.operand(np.where(a == 0, np.inf, np.where(np.isinf(a), 0.0, estimate)))

    def _by_infinity(self, b: Singles, reciprocal: Singles) -> Any:
        return np.where(np.isinf(b), np.float32(0.0), reciprocal)

    def sqrt(self, a: Singles, q: int) -> Any:
        return self._fit(np.sqrt(np.maximum(a, np.float32(0.0)), dtype=np.float64))

    def curve(self, curve: Curve, a: Singles) -> Any:
        samples = self.table(curve.name, curve.samples)
        scaled = np.asarray(a, dtype=np.float32) * np.float32(256.0)
        index = np.minimum(scaled, np.float32(LAST_CELL)).astype(np.int64)
        fraction = scaled - index.astype(np.float32)
        left, right = samples[index], samples[index + 1]
        return self.add(left, self.mpy(self.sub(right, left), fraction, 0))

    def table(self, name: str, constants: Sequence[Constant]) -> Any:
        return np.array([nearest(constant.value) for constant in constants], dtype=np.float32)


class Float32TruncatedBatch(Float32Batch):
    """Single precision for N trains, rounding toward zero."""

    name: ClassVar[str] = "float32-truncated"

    def _fit(self, value: Any) -> Any:
        exact = np.asarray(value, dtype=np.float64)
        mantissa, exponent = np.frexp(exact)
        cut = np.ldexp(np.trunc(mantissa * 2.0**MANTISSA_BITS), exponent - MANTISSA_BITS)
        finite = np.where(np.isinf(exact), exact, np.clip(cut, -FLT_MAX, FLT_MAX))
        # Before the conversion, which would round a denormal.
        return self._known(np.where(abs(finite) < FLT_MIN, 0.0, finite).astype(np.float32))

    def add(self, a: Singles, b: Singles) -> Any:
        first, second = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
        with np.errstate(invalid="ignore", over="ignore"):
            total = first + second
            b_part = total - first
            lost = (first - (total - b_part)) + (second - b_part)
            too_far = lost * total < 0
        return self._fit(np.where(too_far, np.nextafter(total, 0.0), total))
