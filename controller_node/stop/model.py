"""What a stopping law knows of train and line, and the brake model that it rolls forward with its commands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.stop.numbers import ACCEL_Q, DISTANCE_Q, GAIN_Q, SPEED_Q, Numbers

GRAVITY_MPS2 = 9.81
#: Format of grades as accelerations per m/s2, of the weights of past commands in predicted speed (s) and place (s2).
_WEIGHT_Q = 24
_ROUNDING_MPS2 = 1e-3


class Grades(Generic[T]):
    """The grade map: acceleration by the grade at a place, and its mean up to the stopping point.

    :param pieces: position (m) and grade (permil, rising positive) from there on, in rising order.
    :param first_m, stop_m: the part of the line that is needed.
    """

    def __init__(self, numbers: Numbers[T], pieces: Sequence[tuple[float, float]], first_m: float, stop_m: float):
        self._numbers = numbers
        begin = [(position, grade) for position, grade in pieces if position <= first_m][-1:] or [pieces[0]]
        rows = [begin[0], *((place, grade) for place, grade in pieces if first_m < place < stop_m)]
        accels = [-GRAVITY_MPS2 * grade / 1000.0 for _, grade in rows]
        changes = [after - before for before, after in pairwise(accels)]
        self._base = numbers.hold("grade_base", accels[0], ACCEL_Q, "scenario")
        # Positions count from the stopping point: remaining distances.
        self._places = numbers.hold_all(
            "grade_left", [stop_m - place for place, _ in rows[1:]], DISTANCE_Q, "scenario, before the stop"
        )
        self._changes = numbers.hold_all("grade_change", changes, ACCEL_Q, "scenario")

    def at(self, left: T) -> T:
        """Acceleration (m/s2) by the grade where the stopping point is ``left`` m (Q ``DISTANCE_Q``) ahead."""
        ar, total = self._numbers.ar, self._base
        for place, change in zip(self._places, self._changes, strict=True):
            total = ar.where(ar.gt(place, left), ar.add(total, change), total)
        return total

    def mean(self, left: T) -> T:
        """Mean of it from there to the stopping point; ``left``: m, above 0."""
        ar, total = self._numbers.ar, self._base
        for place, change in zip(self._places, self._changes, strict=True):
            share = ar.div(ar.minimum(place, left), left, GAIN_Q)
            total = ar.add(total, ar.mpy(change, share, GAIN_Q))
        return total


class Rolled(NamedTuple, Generic[T]):
    """Left to the stopping point (m), speed (m/s), acceleration by the brake (m/s2)."""

    left: T
    speed: T
    accel: T


class BrakeModel(Generic[T]):
    """Delay and lag of the actuators, equation (1), in steps of one cycle; the past commands are its queue.

    ``count``: commands in the queue, newest first. Within a cycle first an older, then a newer command acts; all
    weights are exact for that.
    """

    def __init__(self, numbers: Numbers[T], delay_s: float, lag_s: float, period_s: float) -> None:
        self._ar = numbers.ar
        self._whole = whole = math.floor(delay_s / period_s + 1e-9)
        rest_s = max(delay_s - whole * period_s, 0.0)
        self.count = whole + 2
        origin = "equation (1)"
        # The older command acts for the rest of the delay, the newer one until the end of the cycle.
        within = _weights([(0.0, rest_s), (rest_s, period_s)], period_s, lag_s)
        decay, kept_s, _ = _kept(period_s, lag_s)
        self._accel = numbers.hold_all("cycle_accel", (decay, *(one[0] for one in within)), GAIN_Q, origin)
        self._speed = numbers.hold_all("cycle_speed", (kept_s, *(one[1] for one in within)), GAIN_Q, origin)
        # Until the command that is computed now begins to act, those on their way do, the oldest first.
        edges = [0.0, *(rest_s + index * period_s for index in range(whole + 1))]
        ahead = _weights(list(pairwise(edges)), delay_s, lag_s)
        accel, speed, place = zip(_kept(delay_s, lag_s), *ahead, strict=True)
        self._ahead_accel = numbers.hold_all("ahead_accel", accel, _WEIGHT_Q, origin)
        self._ahead_speed = numbers.hold_all("ahead_speed", speed, _WEIGHT_Q, origin)
        self._ahead_place = numbers.hold_all("ahead_place", place, _WEIGHT_Q, origin)
        self._delay = numbers.hold("ahead", delay_s, _WEIGHT_Q, "scenario")
        self._half = numbers.hold("ahead_squared_half", delay_s * delay_s / 2.0, _WEIGHT_Q, "scenario")

    def bounds(self, name: str, least_mps2: float, most_mps2: float) -> dict[str, tuple[float, float]]:
        """Bounds of a state with the queue ``name.queue`` and the acceleration ``name.accel``."""
        # The weights of a cycle add up to 1, but are rounded.
        bounds = (least_mps2 - _ROUNDING_MPS2, most_mps2 + _ROUNDING_MPS2)
        return {f"{name}.accel": bounds, **{f"{name}.queue[{i}]": bounds for i in range(self.count)}}

    def step(self, accel: T, queue: Sequence[T]) -> tuple[T, T]:
        """One cycle: acceleration at its end (m/s2), speed gained in it (m/s in Q ``ACCEL_Q``).

        :param queue: with the command that was computed at its beginning in front.
        """
        acting = (accel, queue[self._whole + 1], queue[self._whole])
        return self._ar.dot(self._accel, acting, GAIN_Q), self._ar.dot(self._speed, acting, GAIN_Q)

    def ahead(self, now: Rolled[T], disturbance: T, queue: Sequence[T]) -> Rolled[T]:
        """The train when the command that is computed now begins to act.

        :param disturbance: acceleration besides that of the brake, m/s2 (Q ``ACCEL_Q``).
        :param queue: with the last command in front.
        """
        ar = self._ar
        acting = (now.accel, *reversed(queue[: self._whole + 1]))
        gained = ar.add(ar.dot(self._ahead_speed, acting, _WEIGHT_Q), ar.mpy(disturbance, self._delay, _WEIGHT_Q))
        moved = ar.add(ar.dot(self._ahead_place, acting, _WEIGHT_Q), ar.mpy(disturbance, self._half, _WEIGHT_Q))
        coasted = ar.mpy_iqx(now.speed, SPEED_Q, self._delay, _WEIGHT_Q, DISTANCE_Q)
        return Rolled(
            ar.sub(now.left, ar.add(coasted, ar.convert(moved, ACCEL_Q, DISTANCE_Q))),
            ar.add(now.speed, ar.convert(gained, ACCEL_Q, SPEED_Q)),
            ar.dot(self._ahead_accel, acting, _WEIGHT_Q),
        )


def _decay(x: float) -> float:
    """exp(-x), with the same bits on every machine."""
    part = x / 256.0
    total = 1.0
    for n in range(12, 0, -1):
        total = 1.0 - part / n * total
    for _ in range(8):
        total *= total
    return total


def _kept(time_s: float, lag_s: float) -> tuple[float, float, float]:
    """What an acceleration of 1 m/s2 without a command becomes, and the speed (m/s) and distance (m) by it."""
    decay = _decay(time_s / lag_s)
    speed = lag_s * (1.0 - decay)
    return decay, speed, lag_s * (time_s - speed)


def _pushed(time_s: float, lag_s: float) -> tuple[float, float, float]:
    """Acceleration, speed and distance this long after a command of 1 m/s2 began to act."""
    decay, speed, place = _kept(time_s, lag_s)
    return 1.0 - decay, time_s - speed, time_s * time_s / 2.0 - place


def _weights(spans_s: Sequence[tuple[float, float]], end_s: float, lag_s: float) -> list[tuple[float, ...]]:
    """The same at ``end_s`` for commands that act in these spans only."""
    return [
        tuple(a - b for a, b in zip(_pushed(end_s - first, lag_s), _pushed(end_s - last, lag_s), strict=True))
        for first, last in spans_s
    ]
