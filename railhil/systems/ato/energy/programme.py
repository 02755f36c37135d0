"""Least traction work of a section in a given time, by dynamic programming over distance.

The work of a driving plus ``multiplier * time`` is minimised from stage to stage, from the stop backwards: the value of
a stage is a function of the speed, known on a grid up to the speed of the fastest run there, and linear between. A
larger multiplier gives a faster run; bisection finds the one whose run takes the time that is asked for.

Two values come out. The *dual* value, the largest ``value - multiplier * time``, is below the work of every driving but
for the error of the grid. The *feasible* value is the work of one driving, computed step by step with its own speeds.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from railhil.scenarios.profiles import Floats
from railhil.systems.ato.energy.ideal_train import (
    Cells,
    Forces,
    Kind,
    driving_of,
    make_cells,
    shortest_time_s,
    top_speeds_mps,
)
from railhil.systems.ato.energy.transitions import DRIVINGS, IMPOSSIBLE, Transitions
from railhil.systems.ato.scenario.coast import guess_multiplier_w
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.ato.scenario.model import Scenario

#: Stages of 5 m, in the first and last 40 m of 1 m; at most so many, so that a long line takes no more memory.
_STAGE_M, _END_STAGE_M, _END_M = 5.0, 1.0, 40.0
_STAGES_MAX = 2000
#: Steps of the speed grid, from standstill to the speed of the fastest run at the stage.
_SPEEDS = 240
#: Cells whose drivings are computed at once.
_CHUNK = 128
#: Multipliers in W that are searched: a run that hardly counts time, and the fastest one.
_LEAST_W, _MOST_W = 1.0, 1e10
#: Factor by which a multiplier grows until the time lies between two, and their ratio at which the search ends: the
#: dual value is flat there, its error below 0.01 %.
_GROWTH, _RATIO = 2.0, 1.03
#: Steps in which the share of two drivings is halved.
_HALVINGS = 30
#: Ratios of the multipliers of the two parts of the feasible driving to the best one.
_SPREADS = (1.02, 1.1, 1.5, 10.0, 1e3)


@dataclass(frozen=True, slots=True)
class EnergyBound:
    """Least traction work at the wheel in a running time: lower bound, work of a driving, and the multiplier of time,
    by which the work decreases for each second more."""

    kind: Kind
    running_time_s: float
    shortest_s: float
    dual_kj: float
    feasible_kj: float
    multiplier_w: float

    @property
    def bound_kj(self) -> float:
        """The smaller of both values, kJ; its uncertainty is 0.5 %."""
        return min(self.dual_kj, self.feasible_kj)

    def bound_at_kj(self, running_time_s: float) -> float:
        """The bound for another running time, without another search: by duality
        ``bound - multiplier * (time - running time)`` is below the work of every driving, whatever its time. Where the
        times differ by 1 %, it is at most 0.3 % lower than a search of its own.
        """
        return self.bound_kj - self.multiplier_w * (running_time_s - self.running_time_s) / 1000


def energy_bound(scenario: Scenario, running_time_s: float, kind: Kind = "ideal") -> EnergyBound:
    """Least traction work between the two stops of a scenario, over all drivings of the ideal train.

    :param running_time_s: from stop to stop; a driving may be faster.
    :param kind: limits of the driving (:func:`~.ideal_train.driving_of`).
    :raises CurveError: the time is shorter than the shortest, or the train cannot climb a grade.
    """
    shortest_s = shortest_time_s(scenario, comfort=kind == "comfort")
    if running_time_s < shortest_s:
        raise CurveError(f"running time {running_time_s:g} s is shorter than the shortest, {shortest_s:.3f} s")
    programme = _Programme(scenario, kind)
    dual_j, multiplier_w = programme.maximise_dual(running_time_s)
    feasible_j = programme.drive(running_time_s, multiplier_w)
    return EnergyBound(kind, running_time_s, shortest_s, dual_j / 1000, feasible_j / 1000, multiplier_w)


class _Programme:
    """The stages of a section with the transitions between their speed grids, which no multiplier changes."""

    def __init__(self, scenario: Scenario, kind: Kind) -> None:
        driving = driving_of(scenario.train, kind)
        stage_m = max(_STAGE_M, scenario.plan.distance_m / _STAGES_MAX)
        self._cells: Cells = make_cells(scenario, driving, stage_m, _END_STAGE_M, _END_M)
        forces = Forces.of(scenario.train, driving, float(self._cells.limit_mps.max()))
        self._top = top_speeds_mps(self._cells, forces, driving)
        self._transitions = Transitions(self._cells, self._top, forces, driving)
        self._count, self._mass_kg = len(self._cells.limit_mps), forces.mass_kg
        grid = np.linspace(0.0, 1.0, _SPEEDS + 1)
        shape = (self._count, DRIVINGS, _SPEEDS + 1)
        self._below, self._share = np.empty(shape, dtype=np.intp), np.empty(shape)
        self._work, self._time = np.empty(shape), np.empty(shape)
        for first in range(0, self._count, _CHUNK):
            cells = slice(first, min(first + _CHUNK, self._count))
            ends = self._transitions.ends(cells, self._top[:-1][cells, None] * grid)
            below, share = self._place(ends.speed_mps, self._top[1:][cells, None])
            for kept, made in (
                (self._below, below), (self._share, share), (self._work, ends.work_j), (self._time, ends.time_s),
            ):  # fmt: skip
                kept[cells] = np.moveaxis(made, 0, 1)

    @staticmethod
    def _place(speed_mps: Floats, top_mps: Floats | float) -> tuple[NDArray[np.intp], Floats]:
        """Row of the grid below each speed, and the share of the way to the next row."""
        place = speed_mps / np.maximum(top_mps, 1e-9) * _SPEEDS
        below = np.minimum(place, _SPEEDS - 1).astype(np.intp)
        return below, place - below

    def _solve(self, multiplier_w: float) -> tuple[Floats, float]:
        """Value at each stage and speed (J), shape (stages + 1, speeds), and the time of the best run (s)."""
        values = np.zeros((self._count + 1, _SPEEDS + 1))
        time_s = np.zeros(_SPEEDS + 1)
        speeds = np.arange(_SPEEDS + 1)
        for stage in range(self._count - 1, -1, -1):
            below, share, time = self._below[stage], self._share[stage], self._time[stage]
            after, slope = values[stage + 1], np.diff(values[stage + 1])
            costs = self._work[stage] + multiplier_w * time + after[below] + share * slope[below]
            best = costs.argmin(axis=0)
            values[stage] = np.minimum(costs[best, speeds], IMPOSSIBLE)
            at, part = below[best, speeds], share[best, speeds]
            time_s = np.minimum(time[best, speeds] + time_s[at] + part * (time_s[at + 1] - time_s[at]), IMPOSSIBLE)
        return values, float(time_s[0])

    def maximise_dual(self, running_time_s: float) -> tuple[float, float]:
        """Largest dual value in J, and its multiplier in W, searched by halving its ratio.

        Values between rows of the grid are too large where the value is convex. The driving of the multiplier has no
        such error, and its own ``work + multiplier * (time - running time)`` is no less than the true value: the
        smaller of both is taken.
        """
        best_j, best_w = -inf, 0.0
        guess_w = guess_multiplier_w(self._mass_kg, float(self._cells.edges_m[-1]), running_time_s)
        low_w, high_w, multiplier_w = 0.0, inf, min(max(guess_w, 10 * _LEAST_W), _MOST_W / 10)
        while high_w > _RATIO * low_w and _LEAST_W < multiplier_w < _MOST_W:
            values, time_s = self._solve(multiplier_w)
            dual_j = float(values[0, 0]) - multiplier_w * running_time_s
            if dual_j > best_j:
                best_j, best_w = dual_j, multiplier_w
            low_w, high_w = (multiplier_w, high_w) if time_s > running_time_s else (low_w, multiplier_w)
            if low_w == 0.0:
                multiplier_w = high_w / _GROWTH
            else:
                multiplier_w = low_w * _GROWTH if high_w == inf else sqrt(low_w * high_w)
        speed, time_s = self._path(best_w)
        best_j = min(best_j, self._work_j(speed) + best_w * (time_s - running_time_s))
        return max(best_j, 0.0), best_w

    def drive(self, running_time_s: float, multiplier_w: float) -> float:
        """Work in J of a driving that takes the time that is asked for, or less where even that costs no more.

        Of two drivings by a larger and a smaller multiplier, one is too fast and one too slow. Between them, with the
        squared speeds ``(1 - share) fast + share slow``, lie drivings whose forces lie between theirs, but for the
        small curvature of the resistance. One of them takes the time; its work is computed from its own speeds.
        """
        top = (self._top, self._time_s(self._top))
        fast = slow = top
        for spread in _SPREADS:
            fast, slow = (self._path(multiplier_w * factor) for factor in (spread, 1 / spread))
            if fast[1] <= running_time_s <= slow[1]:
                break
        if slow[1] <= running_time_s:
            return self._work_j(slow[0])
        if fast[1] > running_time_s:
            fast, slow = top, fast
        low, high = 0.0, 1.0
        for _ in range(_HALVINGS):
            share = (low + high) / 2
            is_in_time = self._time_s(_mix(fast[0], slow[0], share)) <= running_time_s
            low, high = (share, high) if is_in_time else (low, share)
        return self._work_j(_mix(fast[0], slow[0], low))

    def _path(self, multiplier_w: float) -> tuple[Floats, float]:
        """Speed at each edge (m/s) of the driving by a multiplier, and its time (s)."""
        values = self._solve(multiplier_w)[0]
        speed = np.zeros(self._count + 1)
        for stage in range(self._count):
            ends = self._transitions.ends(stage, speed[stage : stage + 1])
            below, share = self._place(ends.speed_mps, float(self._top[stage + 1]))
            after = values[stage + 1, below] + share * (values[stage + 1, below + 1] - values[stage + 1, below])
            best = int((ends.work_j + multiplier_w * ends.time_s + after)[:, 0].argmin())
            speed[stage + 1] = ends.speed_mps[best, 0]
        return speed, self._time_s(speed)

    def _time_s(self, speed_mps: Floats) -> float:
        return float((2 * self._cells.lengths_m / (speed_mps[1:] + speed_mps[:-1])).sum())

    def _work_j(self, speed_mps: Floats) -> float:
        """Traction work of a driving given by its speeds at the edges."""
        return float(self._transitions.work_j(speed_mps).sum())


def _mix(fast_mps: Floats, slow_mps: Floats, share: float) -> Floats:
    """Speeds between those of two drivings, linear in their squares."""
    return np.asarray(np.sqrt((1 - share) * fast_mps**2 + share * slow_mps**2))
