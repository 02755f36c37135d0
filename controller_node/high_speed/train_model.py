"""Effect of the coming commands on a train: linear predictions of its speed and of its coupler forces.

The units are lags behind their exact delays, traction and braking on ways of their own, joined by springs with dampers
(without slack)::

    lag_i d_i' = u_i(t - T_i) - d_i      m_i v_i' = m_i d_i + F_(i-1) - F_i      F_i = k g_i + c (v_i - v_(i+1))
    g_i' = v_i - v_(i+1)

Effects on all units alike (wind, grade, resistance) are no part of it. All responses are exact for commands that are
held over a sampling period; forces are read twice in each.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from railhil.controller_node.high_speed.model import Matrix, hold_input

#: Steps of the model in a sampling period.
SUBSTEPS = 2


@dataclass(frozen=True)
class UnitModel:
    """A unit: delays of traction and braking, lag (s), mass (t, with its rotating masses)."""

    delays_s: tuple[float, float]
    lag_s: float
    mass_t: float


@dataclass(frozen=True)
class CouplerModel:
    """Spring (kN/m) and damper (kN s/m) between neighbouring units."""

    stiffness_kn_per_m: float
    damping_kn_per_mps: float


class Way(NamedTuple):
    """The way of one side of a unit: whole steps of its delay, and the additions of the older and the newer command to
    the state in a step, each (states,)."""

    whole: int
    older: Matrix
    newer: Matrix


class TrainModel:
    """Model of a train of n units; state: n speeds relative to the train (m/s), n - 1 gaps (m), n lags (m/s^2).

    :param coupler: None for one unit.
    :param period_s: sampling period.
    """

    def __init__(self, units: Sequence[UnitModel], coupler: CouplerModel | None, period_s: float) -> None:
        n = self.units = len(units)
        self.states = 3 * n - 1
        #: Step of the model, s.
        self.step_s = period_s / SUBSTEPS
        masses_t = np.array([unit.mass_t for unit in units])
        #: Speed of the train: mean by mass, (states,).
        self.speed = np.zeros(self.states)
        self.speed[:n] = masses_t / masses_t.sum()
        #: Forces of the couplers in kN, (n - 1, states).
        self.forces = np.zeros((n - 1, self.states))
        dynamics = np.zeros((self.states, self.states))
        for i in range(n - 1):
            assert coupler is not None
            dynamics[n + i, i], dynamics[n + i, i + 1] = 1.0, -1.0
            self.forces[i, n + i] = coupler.stiffness_kn_per_m
            self.forces[i, i], self.forces[i, i + 1] = coupler.damping_kn_per_mps, -coupler.damping_kn_per_mps
            # kN by t is m/s^2.
            dynamics[i] -= self.forces[i] / masses_t[i]
            dynamics[i + 1] += self.forces[i] / masses_t[i + 1]
        for i, unit in enumerate(units):
            lag = 2 * n - 1 + i
            dynamics[i, lag] += 1.0
            dynamics[lag, lag] = -1.0 / unit.lag_s
        self.transition, _ = hold_input(dynamics, np.zeros(self.states), self.step_s)
        self.ways = [
            [self._way(dynamics, 2 * n - 1 + i, unit.lag_s, delay_s) for delay_s in unit.delays_s]
            for i, unit in enumerate(units)
        ]

    def _way(self, dynamics: Matrix, lag: int, lag_s: float, delay_s: float) -> Way:
        whole = math.floor(delay_s / self.step_s + 1e-9)
        rest_s = max(delay_s - whole * self.step_s, 0.0)
        drive = np.zeros(self.states)
        drive[lag] = 1.0 / lag_s
        late, newer = hold_input(dynamics, drive, self.step_s - rest_s)
        return Way(whole, late @ hold_input(dynamics, drive, rest_s)[1], newer)


class Responses(NamedTuple):
    """Responses over a horizon of N samples.

    ``speed``: of the train at the end of each sample, m/s, by cause (columns, N); ``forces``: of the couplers at the
    end of each step, kN, (columns, couplers * steps); ``after``: the state one sample later, (columns, states).
    """

    speed: Matrix
    forces: Matrix
    after: Matrix


class Prediction:
    """Responses of a model to its state and to all commands that act within a horizon.

    ``state``: by the state now. ``commands``: by 1 m/s^2 of a side of a unit in one sample: axes unit, side (traction,
    braking), sample (-``past`` ... horizon - 1), then the axes of :class:`Responses`.

    :param horizon: N. ``past``: number of past commands.
    :raises ValueError: an older command still acts.
    """

    def __init__(self, model: TrainModel, horizon: int, past: int) -> None:
        self.past = past
        span, n, states = past + horizon, model.units, model.states
        rolled = np.zeros((states + n * 2 * span, states))
        rolled[:states] = np.eye(states)
        cells = rolled[states:].reshape(n, 2, span, states)
        speeds, forces = [], []
        for step in range(horizon * SUBSTEPS):
            rolled[:] = rolled @ model.transition.T
            for unit, ways in enumerate(model.ways):
                for side, way in enumerate(ways):
                    for place, what in ((step - way.whole, way.newer), (step - 1 - way.whole, way.older)):
                        sample = place // SUBSTEPS + past
                        if sample < 0:
                            raise ValueError(f"{past} past commands for a delay of {way.whole} steps")
                        cells[unit, side, sample] += what
            forces.append(rolled @ model.forces.T)
            if step % SUBSTEPS == SUBSTEPS - 1:
                speeds.append(rolled @ model.speed)
            if step == SUBSTEPS - 1:
                after = rolled.copy()
        found = Responses(np.stack(speeds, axis=1), np.stack(forces, axis=2).reshape(len(rolled), -1), after)
        self.state = Responses(*(part[:states] for part in found))
        self.commands = Responses(*(part[states:].reshape(n, 2, span, -1) for part in found))
