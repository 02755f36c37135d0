"""Spectral radius of the closed loop, from the law's weights and an exact model of the train (spec D1).

The train is lag and integrator behind the exact transport delay, the input held over a sampling period. The estimator
of the residual, if closed too, is a low-pass (weight ``smoothing`` of the newest residual).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from railhil.controller_node.laws.high_speed.model import Matrix, Sampled, held, lagged
from railhil.controller_node.laws.high_speed.predictor import Weights


@dataclass(frozen=True, slots=True)
class Train:
    """What the law's loop is closed with: transport delay and lag (s), gain of the actuators."""

    delay_s: float
    lag_s: float
    gain: float = 1.0


def transition(train: Train, period_s: float) -> tuple[Matrix, Matrix]:
    """Exact transition over a sampling period; the states are speed, acceleration, u(k-1), u(k-2), ...

    The delay is whole periods and a rest; during the rest the older command still acts.
    """
    whole = math.floor(train.delay_s / period_s + 1e-9)
    rest_s = max(train.delay_s - whole * period_s, 0.0)
    dynamics, drive = lagged(train.lag_s, train.gain)
    early, by_older = held(dynamics, drive, rest_s)
    late, by_newer = held(dynamics, drive, period_s - rest_s)
    size = 3 + whole
    step, command = np.zeros((size, size)), np.zeros(size)
    step[:2, :2] = late @ early
    step[:2, 2 + whole] = late @ by_older
    if whole:
        step[:2, 1 + whole] += by_newer
    else:
        command[:2] = by_newer
    command[2] = 1.0
    for i in range(3, size):
        step[i, i - 1] = 1.0
    return step, command


def spectral_radius(
    train: Train, model: Sampled, weights: Weights[float], period_s: float, smoothing: float | None = None
) -> float:
    """Largest magnitude of a closed-loop pole; the loop is stable if it is below 1.

    :param smoothing: weight of the newest residual in the low-pass; None: the loop without an estimator.
    """
    inner, command = transition(train, period_s)
    states = len(command)
    commands = max(states - 2, len(model.b))
    # Speed, acceleration, past commands, past speeds, estimate.
    past_v = 2 + commands
    xi = past_v + len(model.a)
    step, drive = np.zeros((xi + 1, xi + 1)), np.zeros(xi + 1)
    step[:states, :states], drive[:states] = inner, command
    for i in range(3, past_v):
        step[i, i - 1] = 1.0
    step[past_v, 0] = 1.0
    for i in range(past_v + 1, xi):
        step[i, i - 1] = 1.0
    law = np.zeros(xi + 1)
    law[0] = -weights.f[0]
    law[past_v : past_v + len(weights.f) - 1] = [-x for x in weights.f[1:]]
    law[2 : 2 + len(weights.h)] = [-x for x in weights.h]
    if smoothing is not None:
        step[xi, xi] = 1.0 - smoothing
        step[xi, 0] += smoothing
        step[xi, past_v:xi] += smoothing * np.array(model.a)
        step[xi, 2 : 2 + len(model.b)] -= smoothing * np.array(model.b)
        law[xi] = -weights.xi
    return float(np.abs(np.linalg.eigvals(step + np.outer(drive, law))).max())
