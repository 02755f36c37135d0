"""The train's actuators with their exact transport delays: two queues of commands, traction and braking (D12).

The positive part of a command acts after the traction delay, the negative part after the braking delay; both add and
pass the lag. A command is held over a sampling period, so within a period each side has the older and then the newer
of two neighbouring commands. Several power units that one filter follows have a mean by mass.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Generic, NamedTuple, TypeVar

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.law import Unit
from railhil.controller_node.high_speed.model import hold_input, make_lag
from railhil.controller_node.vector.reals import Reals

#: A number, or one for each of several units.
Accel = TypeVar("Accel")


class SideWeights(NamedTuple):
    """One side over one period: speed gained (m/s) and acceleration reached per m/s^2 of the older and newer command.

    ``whole``: whole periods of the delay: the newer command was computed ``whole`` periods before the period begins.
    """

    whole: int
    speed: tuple[float, float]
    accel: tuple[float, float]


def side_weights(delay_s: float, lag_s: float, period_s: float) -> SideWeights:
    """Exact for lag and delay."""
    whole = math.floor(delay_s / period_s + 1e-9)
    rest_s = max(delay_s - whole * period_s, 0.0)
    dynamics, drive = make_lag(lag_s)
    _, by_older = hold_input(dynamics, drive, rest_s)
    late, by_newer = hold_input(dynamics, drive, period_s - rest_s)
    older = late @ by_older
    return SideWeights(whole, (float(older[0]), float(by_newer[0])), (float(older[1]), float(by_newer[1])))


def step_response(delay_s: float, lag_s: float, times_s: Sequence[float]) -> tuple[float, ...]:
    """Speed (m/s) at these times after a command of 1 m/s^2 began; 0 until it acts."""
    left = [max(time_s - delay_s, 0.0) for time_s in times_s]
    return tuple(s - lag_s * (1.0 - math.exp(-s / lag_s)) for s in left)


class Rolled(NamedTuple, Generic[Accel, T]):
    """``accel``: acceleration of the lag at the end of a period, m/s^2; ``gained``: speed gained in it, m/s."""

    accel: Accel
    gained: T


class DelayLines(Generic[T]):
    """Rolls the lag through its queues with the exact delays.

    :param shifts: extra delays to choose from, in whole periods, for both sides.
    """

    def __init__(
        self, re: Reals[T], delays_s: tuple[float, float], lag_s: float, period_s: float, shifts: Sequence[int] = (0,)
    ) -> None:
        self._re = re
        sides = [side_weights(delay_s, lag_s, period_s) for delay_s in delays_s]
        self.whole = tuple(side.whole for side in sides)
        self.whole_max = max(self.whole)
        #: Past commands that are needed: u(k-1), ..., u(k-count).
        self.count = self.whole_max + max(shifts) + 2
        decay = math.exp(-period_s / lag_s)
        self._decay = re.number("decay", decay, "lag")
        #: Acceleration of the lag of a unit without commands.
        self.rest = re.zero
        self._coasted = re.number("coasted", lag_s * (1.0 - decay), "lag")
        names = ("traction", "braking")
        self._speed = [re.numbers(f"{name}_speed", side.speed) for name, side in zip(names, sides, strict=True)]
        self._accel = [re.numbers(f"{name}_accel", side.accel) for name, side in zip(names, sides, strict=True)]

    def parts(self, commands: Sequence[T]) -> tuple[tuple[T, ...], tuple[T, ...]]:
        """Traction and braking in each command."""
        ar, zero = self._re.ar, self._re.zero
        return tuple(ar.maximum(u, zero) for u in commands), tuple(ar.minimum(u, zero) for u in commands)

    def roll(self, accel: T, parts: tuple[Sequence[T], Sequence[T]], first: int) -> Rolled[T, T]:
        """One period.

        :param parts: :meth:`parts` of the commands, newest first.
        :param first: place in them of the command that is computed at the beginning of this period; an extra delay of
            whole periods is added to it.
        """
        re = self._re
        after, gained = re.mul(self._decay, accel), re.mul(self._coasted, accel)
        for side, values in enumerate(parts):
            newer = first + self.whole[side]
            acting = (values[newer + 1], values[newer])
            after = re.add(after, re.dot(self._accel[side], acting))
            gained = re.add(gained, re.dot(self._speed[side], acting))
        return Rolled(after, gained)


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
