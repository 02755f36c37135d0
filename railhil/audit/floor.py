"""A twin of an arithmetic that multiplies without rounding: shows what a law loses by ``mpy`` instead of ``rmpy``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from railhil.controller_node.arithmetic.base import Arithmetic


def floored(arithmetic: Arithmetic[int]) -> Arithmetic[int]:
    """A fresh fixed-point arithmetic of the same kind that floors the products which the original rounds.

    Each floored product is half an LSB lower on average, a sum of n products n/2 LSB. The quantiser of the notch
    still rounds: its rounding is part of the law's equations.
    """
    kind: Any = type(arithmetic)

    class Floored(kind):  # type: ignore[misc]
        def rmpy(self, a: int, b: int, q: int) -> int:
            return self.mpy(a, b, q)  # type: ignore[no-any-return]

        def dot(self, coefficients: Sequence[int], values: Sequence[int], q: int) -> int:
            total = 0
            for coefficient, value in zip(coefficients, values, strict=True):
                total = self.add(total, self.mpy(coefficient, value, q))
            return total

        def quantise(self, a: int, q_from: int, q_to: int) -> int:
            return super().rmpy(a, 1, q_from - q_to)  # type: ignore[no-any-return]

    twin: Arithmetic[int] = Floored()
    return twin
