"""A stopping law's model of train and line: grades, the brake model that it rolls forward, the stopping distance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.stop.numbers import ACCEL_Q, DISTANCE_Q, GAIN_Q, SPEED_Q, TIME_Q, Numbers

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
        # Until the command that is computed now begins to act, the commands on their way act, the oldest first.
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

    def predict(self, now: Rolled[T], disturbance: T, queue: Sequence[T]) -> Rolled[T]:
        """The train when the command that is computed now begins to act.

        :param disturbance: acceleration besides the brake's, m/s2 (Q ``ACCEL_Q``).
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
    """Decay of an acceleration of 1 m/s2 without a command, and the speed (m/s) and distance (m) by it."""
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


#: Steps of Newton's method: the error is below 1e-9 s after four.
NEWTON_STEPS = 4
#: exp(-x) is 0 beyond; halvings of x before the series, and its terms.
_FAR = 30.0
_HALVINGS = 8
_TERMS = 7
#: Longest time and way, and slowest mean speed before the stop: bounds of the intermediate results.
_LONGEST_S, _LONGEST_M, _LEAST_MPS = 256.0, 10_000.0, -4.0
#: Smallest slope in Newton's method: at speed 0 the slope is 0, and so is the difference.
_LEAST_SLOPE = 1e-6


class NegativeExp(Generic[T]):
    """exp(-T/tau) from sums and products alone, so that it has the same bits on every machine.

    ``exp(-x) = exp(-x/256)^256``, with seven terms of the series; the result is in Q ``GAIN_Q``.
    """

    def __init__(self, numbers: Numbers[T], lag_s: float) -> None:
        self._ar = numbers.ar
        self._one = numbers.hold("exp_one", 1.0, GAIN_Q, "series")
        self._none = numbers.hold("exp_zero", 0.0, TIME_Q, "series")
        self._most = numbers.hold("exp_far", _FAR * lag_s, TIME_Q, "series, model")
        self._scale = numbers.hold("exp_scale", 1.0 / (lag_s * 2**_HALVINGS), GAIN_Q, "series, model")
        self._parts = numbers.hold_all("exp_part", [1.0 / n for n in range(_TERMS, 1, -1)], GAIN_Q, "series")

    def __call__(self, time: T) -> T:
        """``time``: T in s (Q ``TIME_Q``), at least 0."""
        ar, one = self._ar, self._one
        x = ar.mpy_iqx(ar.clip(time, self._most, self._none), TIME_Q, self._scale, GAIN_Q, GAIN_Q)
        total = one
        for part in self._parts:
            total = ar.sub(one, ar.rmpy(ar.rmpy(x, part, GAIN_Q), total, GAIN_Q))
        total = ar.sub(one, ar.rmpy(x, total, GAIN_Q))
        for _ in range(_HALVINGS):
            total = ar.rmpy(total, total, GAIN_Q)
        return total


class Stop(NamedTuple, Generic[T]):
    """``time``: t_s, s (Q ``TIME_Q``). ``distance``: f, m (Q ``DISTANCE_Q``)."""

    time: T
    distance: T


class StoppingDistance(Generic[T]):
    """Time and distance from the command to brake until the train stands, equations (4) and (5), by Newton's method.

    The brake is a delay and a lag. With the lag tau, the deceleration a and T = t - delta::

        (4) v(t) = v0 - a (T - tau (1 - exp(-T/tau)))                v(t_s) = 0
        (5) f(v0) = v0 t_s - a (T^2/2 - tau T + tau^2 (1 - exp(-T/tau)))

    Where (4) holds at t_s, (5) is v0 (delta + tau) + T (v0 - a T/2) without the large terms that cancel. The left side
    of (4) is convex in T, so that Newton's method from above is monotone; both bounds from which it starts are above
    the root.

    Times are limited to 256 s and distances to 10 km.

    :param delay_s, lag_s: delta and tau.
    :raises ValueError: a lag that is not positive.
    """

    def __init__(self, numbers: Numbers[T], delay_s: float, lag_s: float) -> None:
        if not lag_s > 0.0:
            raise ValueError(f"lag {lag_s:g} s: must be positive")
        self._numbers = numbers
        self._exp = NegativeExp(numbers, lag_s)
        self._one = numbers.hold("slope_one", 1.0, GAIN_Q, "Newton's method")
        self._flat = numbers.hold("least_slope", _LEAST_SLOPE, GAIN_Q, "Newton's method")
        self._delay = numbers.hold("model_delay", delay_s, TIME_Q, "scenario")
        self._lag = numbers.hold("model_lag", lag_s, TIME_Q, "scenario")
        self._both = numbers.hold("model_delay_and_lag", delay_s + lag_s, TIME_Q, "scenario")
        self._twice = numbers.hold("model_lag_twice", 2.0 * lag_s, TIME_Q, "scenario")
        self._half = numbers.hold("half", 0.5, GAIN_Q, "equation (5)")
        self._times = numbers.hold("time_max", _LONGEST_S, TIME_Q, "law"), numbers.hold("time_0", 0.0, TIME_Q, "law")
        self._change = self._times[0], numbers.hold("time_min", -_LONGEST_S, TIME_Q, "law")
        self._ways = (
            numbers.hold("way_max", _LONGEST_M, DISTANCE_Q, "law"),
            numbers.hold("way_min", 0.0, DISTANCE_Q, "law"),
        )
        self._slow = numbers.hold("mean_min", _LEAST_MPS, SPEED_Q, "law")
        self._still = numbers.hold("still", 0.0, SPEED_Q, "law")

    def __call__(self, speed: T, decel: T) -> Stop[T]:
        """``speed``: v0, m/s (Q ``SPEED_Q``; below 0 as 0); ``decel``: a, m/s2 (Q ``ACCEL_Q``), above 0."""
        ar = self._numbers.ar
        v0 = ar.clip(speed, self._numbers.fastest, self._still)
        rest = ar.div(v0, ar.convert(decel, ACCEL_Q, SPEED_Q), TIME_Q)
        rest = ar.clip(rest, *self._times)
        root = ar.clip(ar.sqrt(ar.mpy(self._twice, rest, TIME_Q), TIME_Q), *self._times)
        time = ar.clip(ar.minimum(ar.add(rest, self._lag), ar.add(rest, root)), *self._times)
        for _ in range(NEWTON_STEPS):
            slope = ar.sub(self._one, self._exp(time))
            over = ar.sub(ar.sub(time, ar.mpy(self._lag, slope, GAIN_Q)), rest)
            slope = ar.convert(ar.maximum(slope, self._flat), GAIN_Q, TIME_Q)
            change = ar.clip(ar.div(over, slope, TIME_Q), *self._change)
            time = ar.clip(ar.sub(time, change), *self._times)
        braked = ar.mpy_iqx(ar.mpy(decel, self._half, GAIN_Q), ACCEL_Q, time, TIME_Q, SPEED_Q)
        mean = ar.clip(ar.sub(v0, braked), self._numbers.fastest, self._slow)
        distance = ar.add(
            ar.mpy_iqx(v0, SPEED_Q, self._both, TIME_Q, DISTANCE_Q),
            ar.mpy_iqx(mean, SPEED_Q, time, TIME_Q, DISTANCE_Q),
        )
        return Stop(ar.add(time, self._delay), ar.clip(distance, *self._ways))
