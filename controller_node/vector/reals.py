"""Real numbers for the laws of this folder: the operations of an arithmetic without formats.

The laws need float64 or float32: their quantities span too many orders of magnitude for one fixed-point format each.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any, Generic

from railhil.controller_node.arithmetic.base import Arithmetic, Condition, Constant, T

#: Format stated where the interface of the arithmetics asks for one; the wide arithmetics ignore it.
Q = 16


class Reals(Generic[T]):
    """The operations of ``arithmetic``, and the constants loaded through it (in ``constants``)."""

    def __init__(self, arithmetic: Arithmetic[T]) -> None:
        self.ar = arithmetic
        self.constants: list[Constant] = []
        self.zero, self.one = (self.number(f"{value:g}", value) for value in (0.0, 1.0))

    def number(self, name: str, value: float, origin: str = "") -> T:
        """A constant as an operand."""
        constant = Constant(name, float(value), Q, origin)
        if constant not in self.constants:
            self.constants.append(constant)
        return self.ar.const(constant)

    def numbers(self, name: str, values: Sequence[float], origin: str = "") -> tuple[T, ...]:
        """Several constants: ``name[0]``, ``name[1]``, ..."""
        return tuple(self.number(f"{name}[{i}]", value, origin) for i, value in enumerate(values))

    def add(self, *values: T) -> T:
        """Sum, from left to right."""
        return reduce(self.ar.add, values)

    def sub(self, a: T, b: T) -> T:
        """a - b."""
        return self.ar.sub(a, b)

    def neg(self, a: T) -> T:
        """-a."""
        return self.ar.neg(a)

    def mul(self, a: T, b: T) -> T:
        """a * b."""
        return self.ar.mpy(a, b, Q)

    def div(self, a: T, b: T) -> T:
        """a / b."""
        return self.ar.div(a, b, Q)

    def dot(self, first: Sequence[T], second: Sequence[T]) -> T:
        """Scalar product, from left to right."""
        return self.ar.dot(tuple(first), tuple(second), Q)

    def axpy(self, factor: T, values: Sequence[T], onto: Sequence[T]) -> tuple[T, ...]:
        """``onto + factor * values``, element by element."""
        return tuple(self.add(b, self.mul(factor, a)) for a, b in zip(values, onto, strict=True))

    def clip(self, a: T, lowest: T, highest: T) -> T:
        """``a`` limited to ``lowest``..``highest``."""
        return self.ar.clip(a, highest, lowest)

    def gt(self, a: T, b: T) -> Condition:
        """Condition a > b."""
        return self.ar.gt(a, b)

    def select(self, condition: Condition, new: Any, old: Any) -> Any:
        """``new`` where the condition holds, else ``old``: nested (named) tuples of one shape, leaf by leaf."""
        if isinstance(new, tuple):
            leaves = [self.select(condition, a, b) for a, b in zip(new, old, strict=True)]
            return type(new)(*leaves) if hasattr(new, "_fields") else tuple(leaves)
        return self.ar.where(condition, new, old)
