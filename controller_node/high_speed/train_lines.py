"""The actuators of several power units that one filter follows: the exact delays of each, and their mean by mass."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.core import Unit
from railhil.controller_node.high_speed.delay_line import DelayLines, Rolled
from railhil.controller_node.high_speed.reals import Reals

Parts = tuple[Sequence[T], Sequence[T]]


class TrainLines(Generic[T]):
    """Rolls the lags of all units; the same interface as :class:`.delay_line.DelayLines` with a tuple for each unit.

    :param shares: of the train's mass, one for each unit; their sum is 1.
    :param shifts: extra delays to choose from, in whole periods.
    """

    def __init__(self, re: Reals[T], units: Sequence[Unit], shares: Sequence[float], shifts: Sequence[int]) -> None:
        self._re = re
        self.lines = [
            DelayLines(re, (u.traction_delay_s, u.braking_delay_s), u.lag_s, u.sample_period_s, shifts) for u in units
        ]
        #: Past commands of each unit that are needed.
        self.count = max(line.count for line in self.lines)
        self._shares = re.numbers("mass_share", shares, "scenario")
        #: Accelerations of the lags of a train without commands.
        self.rest = (re.zero,) * len(self.lines)

    def mean(self, values: Sequence[T]) -> T:
        """Mean over the units by mass."""
        return self._re.dot(self._shares, values)

    def parts(self, commands: Sequence[Sequence[T]]) -> tuple[Parts[T], ...]:
        """Traction and braking in each command of each unit."""
        return tuple(line.parts(own) for line, own in zip(self.lines, commands, strict=True))

    def roll(self, accel: Sequence[T], parts: Sequence[Parts[T]], first: int) -> Rolled[tuple[T, ...], T]:
        """One period of all units: their accelerations at its end (m/s^2), and the speed gained by the train (m/s)."""
        rows = zip(self.lines, accel, parts, strict=True)
        rolled = [line.roll(old, own, first) for line, old, own in rows]
        return Rolled(tuple(one.accel for one in rolled), self.mean([one.gained for one in rolled]))
