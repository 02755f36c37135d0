"""Spectral radius of the closed loop of DelayGPC: train, exact predictor, filter of [v, d] and the law.

The effectiveness is taken as known and the gains of the filter as steady. With one delay for both sides the law is then
linear, and the matrix of the loop consists of its answers to unit vectors.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from railhil.controller_node.high_speed.core import Sample
from railhil.controller_node.high_speed.delay_bank import Found
from railhil.controller_node.high_speed.kalman import Belief
from railhil.controller_node.high_speed.model import Matrix
from railhil.controller_node.high_speed.stability import Train, magnitude, transition

if TYPE_CHECKING:
    from railhil.controller_node.high_speed.laws.delay_gpc import DelayCore

#: No command of a loop of unit vectors is as large, m/s^2.
_UNLIMITED_MPS2 = 1e6
_NO_COVARIANCE = (0.0,) * 6


def loop_radius(core: DelayCore[float], train: Train, gains: tuple[float, float], emergency: bool) -> float:
    """Largest magnitude of a pole; the loop is stable if it is below 1.

    :param core: in float64, with the same delay for traction and braking.
    :param train: with the nominal delay; another one shows what a mismatch does.
    :param gains: of the filter, on speed and disturbance, see :func:`.kalman.steady_gains`.
    :param emergency: with the weights from the trigger of an emergency on.
    """
    period_s = core.unit.sample_period_s
    step, drive = transition(train, period_s)
    queue = max(core.lines.count, len(drive) - 2)
    matrix = [_after(core, step, drive, gains, float(emergency), row, queue) for row in np.eye(queue + 6)]
    return magnitude(np.array(matrix).T)


def _after(
    core: DelayCore[float],
    step: Matrix,
    drive: Matrix,
    gains: tuple[float, float],
    emergency: float,
    state: Matrix,
    queue: int,
) -> list[float]:
    """The state one period later: speed, acceleration, u(k-1), ..., correction, and v, d, acceleration as estimated."""
    speed = float(state[0])
    sent = tuple(map(float, state[2 : 2 + queue]))
    correction, believed, disturbance, lagging = map(float, state[2 + queue :])
    period_s, lines = core.unit.sample_period_s, core.lines
    rolled = lines.roll(lagging, lines.parts(sent), 0)
    predicted = believed + period_s * disturbance + rolled.gained
    error = speed - predicted
    belief = Belief(predicted + gains[0] * error, disturbance + gains[1] * error, 1.0, _NO_COVARIANCE)
    found = Found(belief, rolled.accel, error, 0.0, core.nominal)
    sample = Sample(speed, (0.0,) * (core.horizon + 1), -_UNLIMITED_MPS2, _UNLIMITED_MPS2, emergency)
    command, correction = core.commanded(sent[: lines.count], correction, found, sample)
    moved = step[:2] @ state[: len(drive)] + drive[:2] * command
    return [*map(float, moved), command, *sent[:-1], correction, belief.speed, belief.disturbance, rolled.accel]
