"""Formats of the stopping laws, and the constants that they hold.

Everything is in SI units. In fixed point speeds reach +-2048 m/s in steps of 1 um/s, distances +-32 km in steps of
15 um, accelerations +-128 m/s2; weights and gains below 2 are in Q30.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T

SPEED_Q = 20
DISTANCE_Q = 16
ACCEL_Q = 24
TIME_Q = 20
GAIN_Q = 30
#: No train of these laws is faster; estimates are limited to it, which also bounds them for the interval analysis.
FASTEST_MPS = 64.0


class Numbers(Generic[T]):
    """An arithmetic, and the constants loaded through it (in ``constants``)."""

    def __init__(self, arithmetic: Arithmetic[T]) -> None:
        self.ar = arithmetic
        self.constants: list[Constant] = []
        self._operands: dict[tuple[str, float, int], T] = {}
        self.zero = self.hold("zero", 0.0, 0, "law")
        self.one = self.hold("one", 1.0, 0, "law")
        self.fastest = self.hold("fastest", FASTEST_MPS, SPEED_Q, "law")
        self.slowest = self.hold("minus_fastest", -FASTEST_MPS, SPEED_Q, "law")

    def hold(self, name: str, value: float, q: int, origin: str) -> T:
        """A constant as an operand; the same one for the same name, value and format."""
        key = (name, float(value), q)
        if (known := self._operands.get(key)) is not None:
            return known
        constant = Constant(name, float(value), q, origin)
        self.constants.append(constant)
        self._operands[key] = operand = self.ar.const(constant)
        return operand

    def rounded(self, value: T, q_from: int, q_to: int) -> T:
        """The same value in a format with fewer fraction bits, rounded: :meth:`Arithmetic.convert` floors, by half a
        bit on average, which a sum over all cycles would add up."""
        return self.ar.rmpy(value, self.one, q_from - q_to)

    def hold_all(self, name: str, values: Sequence[float], q: int, origin: str) -> tuple[T, ...]:
        """Several constants: ``name[0]``, ``name[1]``, ..."""
        return tuple(self.hold(f"{name}[{i}]", value, q, origin) for i, value in enumerate(values))
