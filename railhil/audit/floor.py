"""The twin of an arithmetic that multiplies without rounding: what a law loses that calls ``mpy`` for ``rmpy``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from railhil.controller_node.arithmetic.base import Arithmetic


def floored(arithmetic: Arithmetic[int]) -> Arithmetic[int]:
    """A fresh fixed-point arithmetic of the same kind whose rounded products are floored ones.

    Each floored product is half a bit lower on average, and a sum of n products n halves. The quantiser of the notch
    keeps its rounding: it is an equation of the law, not a matter of how products are formed.
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
