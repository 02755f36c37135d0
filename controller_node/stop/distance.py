"""Stopping distance and time of a brake that is a delay and a lag, equations (4) and (5), by Newton's method.

With the lag tau, the deceleration a and T = t - delta::

    (4) v(t) = v0 - a (T - tau (1 - exp(-T/tau)))                v(t_s) = 0
    (5) f(v0) = v0 t_s - a (T^2/2 - tau T + tau^2 (1 - exp(-T/tau)))

Where (4) holds at t_s, (5) is v0 (delta + tau) + T (v0 - a T/2) without the large terms that cancel. The left side of
(4) is convex in T, so that Newton's method from above is monotone; both bounds from which it starts are above the root.
"""

from __future__ import annotations

from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.stop.numbers import ACCEL_Q, DISTANCE_Q, GAIN_Q, SPEED_Q, TIME_Q, Numbers

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
    """Time and distance from the command to brake until the train stands.

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
