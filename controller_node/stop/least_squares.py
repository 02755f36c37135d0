"""Learning over speed, load and rate: recursive least squares on delay and 1/gain of the brake, with a load term.

Braking takes ``y + a tau^2/2 = theta1 v + theta2 v^2/(2a) + theta3 load v^2/(2a)``; theta1 is delay + lag, theta2 is
1/gain of the empty train, and theta3 is its growth to full load. Unlike one offset for each load class it holds at
other speeds too. The estimate is learned once for each run, under the same gates as the offset, and only from a stop
within 3 sigma of the expectation and within 9 % of the braking distance.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.stop.learning import SHARE_MAX
from railhil.controller_node.vector.reals import Reals

#: Standard deviations before the first run: s, 1, 1; and of a stop (m); and by how much the first ones may change from
#: run to run.
_FIRST = (0.3, 0.05, 0.1)
_STOP_SIGMA_M = 0.5
_CHANGE = (0.002, 0.0005, 0.001)
_SIGMAS = 3.0
#: Bounds of a stored estimate.
_BOUNDS = ((0.0, 10.0), (0.3, 3.0), (-2.0, 2.0))


class Braking(NamedTuple, Generic[T]):
    """``theta``, its covariance (upper triangle, row by row), runs and the last one; regressors and distance (m) of the
    braking in this run; 1 once it has been learned."""

    theta: tuple[T, ...]
    covariance: tuple[T, ...]
    runs: T
    last_run: T
    regressors: tuple[T, ...]
    expected: T
    learned: T


def _place(row: int, column: int) -> int:
    low, high = min(row, column), max(row, column)
    return low * 3 - low * (low - 1) // 2 + high - low


def checked(values: Mapping[str, Any]) -> None:
    """Refuse a stored estimate that is impossible for a brake.

    :raises ValueError: a number out of range.
    """
    rows = zip(values["theta"], _BOUNDS, strict=True)
    if not all(low <= value <= high for value, (low, high) in rows) or len(values["covariance"]) != 6:
        raise ValueError(f"theta {values['theta']!r}: not that of a brake")
    if not all(math.isfinite(value) for value in values["covariance"]):
        raise ValueError("covariance: allowed finite numbers")
    if any(values["covariance"][_place(i, i)] <= 0.0 for i in range(3)):
        raise ValueError("covariance: allowed variances above 0")


class LeastSquares(Generic[T]):
    """The estimate of one train.

    :param values: the stored one, None before the first run. :param delay_s, lag_s: of the model.
    """

    def __init__(
        self, arithmetic: Arithmetic[T], values: Mapping[str, Any] | None, delay_s: float, lag_s: float
    ) -> None:
        self.re = re = Reals(arithmetic)
        theta = [delay_s + lag_s, 1.0, 0.0] if values is None else values["theta"]
        first = [_FIRST[i] ** 2 if i == j else 0.0 for i in range(3) for j in range(i, 3)]
        self._theta = re.numbers("theta", theta, "memory")
        self._covariance = re.numbers("covariance", first if values is None else values["covariance"], "memory")
        runs, last_run = (0, 0) if values is None else (values["runs"], values["last_run"])
        self._runs, self._last_run = (
            re.number("rls_runs", runs, "memory"),
            re.number("rls_last_run", last_run, "memory"),
        )
        self._change = re.numbers("rls_change", [value * value for value in _CHANGE], "law")
        self._noise = re.number("rls_noise", _STOP_SIGMA_M**2, "law")
        self._lag = re.number("rls_lag", lag_s * lag_s / 2.0, "scenario")
        self._half, self._percent = re.number("rls_half", 0.5), re.number("rls_percent", 0.01)
        self._sigmas, self._share = re.number("rls_sigmas", _SIGMAS**2), re.number("rls_share", SHARE_MAX)

    def start(self) -> Braking[T]:
        """Before the first step."""
        zero = self.re.zero
        return Braking(self._theta, self._covariance, self._runs, self._last_run, (zero,) * 3, zero, zero)

    def distance(self, state: Braking[T], speed: T, decel: T, load: T) -> tuple[tuple[T, ...], T]:
        """Regressors and expected braking distance, m.

        :param speed: m/s. :param decel: m/s2. :param load: percent.
        """
        re = self.re
        square = re.div(re.mul(re.mul(speed, speed), self._half), decel)
        regressors = (speed, square, re.mul(re.mul(load, self._percent), square))
        return regressors, re.sub(re.dot(state.theta, regressors), re.mul(decel, self._lag))

    def begin(self, state: Braking[T], first: T, regressors: tuple[T, ...], expected: T) -> Braking[T]:
        """Store the values at the beginning of the brake, in the cycle in which ``first`` is 1."""
        re = self.re
        now = re.gt(first, re.zero)
        return state._replace(
            regressors=re.select(now, regressors, state.regressors), expected=re.select(now, expected, state.expected)
        )

    def step(self, state: Braking[T], usable: T, run: T, error: T) -> Braking[T]:
        """Learn the stop of a run, m behind the stopping point, where ``usable`` is 1."""
        re, rows, x = self.re, range(3), state.regressors
        grown = tuple(
            re.add(value, self._change[i]) if i == j else value
            for (i, j), value in zip([(i, j) for i in rows for j in range(i, 3)], state.covariance, strict=True)
        )
        px = [re.dot([grown[_place(i, j)] for j in rows], x) for i in rows]
        variance = re.add(self._noise, re.dot(x, px))
        squared = re.mul(error, error)
        far = re.ar.where(re.gt(squared, re.mul(self._sigmas, variance)), re.one, re.zero)
        limit = re.mul(self._share, state.expected)
        far = re.ar.where(re.gt(squared, re.mul(limit, limit)), re.one, far)
        again = re.ar.where(re.gt(run, state.last_run), re.zero, re.one)
        stop = re.ar.maximum(re.ar.maximum(far, again), re.ar.maximum(state.learned, re.sub(re.one, usable)))
        gain = [re.div(p, variance) for p in px]
        theta = re.axpy(error, gain, state.theta)
        reduced = tuple(re.sub(grown[_place(i, j)], re.mul(gain[i], px[j])) for i in rows for j in range(i, 3))
        new = state._replace(
            theta=theta, covariance=reduced, runs=re.add(state.runs, re.one), last_run=run, learned=re.one
        )
        after: Braking[T] = re.select(re.gt(stop, re.zero), state, new)
        return after

    def memory(self, state: Braking[Any]) -> dict[str, Any]:
        """The estimate after the run."""
        return {
            "theta": [float(value) for value in state.theta],
            "covariance": [float(value) for value in state.covariance],
            "runs": int(state.runs),
            "last_run": int(state.last_run),
        }
