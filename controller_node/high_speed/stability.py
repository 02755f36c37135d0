"""Stability of the closed loop: its spectral radius with an exact model of the train, refusals at load (spec D1).

The train is lag and integrator behind the exact transport delay, the input held over a sampling period. The estimator
of the residual, if closed too, is a low-pass (weight ``smoothing`` of the newest residual).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from railhil.common.errors import InputError, Words
from railhil.controller_node.high_speed.model import Matrix, Sampled, hold_input, make_lag
from railhil.controller_node.high_speed.predictor import Weights

if TYPE_CHECKING:
    from railhil.controller_node.high_speed.law import LawParameters


@dataclass(frozen=True, slots=True)
class Train:
    """The train in the law's closed loop: transport delay and lag (s), gain of the actuators."""

    delay_s: float
    lag_s: float
    gain: float = 1.0


def transition(train: Train, period_s: float) -> tuple[Matrix, Matrix]:
    """Exact transition over a sampling period; the states are speed, acceleration, u(k-1), u(k-2), ...

    The delay is whole periods and a rest; during the rest the older command still acts.
    """
    whole = math.floor(train.delay_s / period_s + 1e-9)
    rest_s = max(train.delay_s - whole * period_s, 0.0)
    dynamics, drive = make_lag(train.lag_s, train.gain)
    early, by_older = hold_input(dynamics, drive, rest_s)
    late, by_newer = hold_input(dynamics, drive, period_s - rest_s)
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


def open_loop(train: Train, period_s: float, commands: int, speeds: int) -> tuple[Matrix, Matrix]:
    """:func:`transition` with past commands and speeds as states: speed, acceleration, u(k-1), ..., v(k-1), ...

    :param commands: smallest number of past commands; ``speeds``: of past speeds.
    :returns: matrix of shape (n, n), the command's column of shape (n,).
    """
    inner, command = transition(train, period_s)
    states = len(command)
    past_v = 2 + max(states - 2, commands)
    size = past_v + speeds
    step, drive = np.zeros((size, size)), np.zeros(size)
    step[:states, :states], drive[:states] = inner, command
    for i in range(3, size):
        step[i, i - 1] = 1.0
    step[past_v, 0], step[past_v, past_v - 1] = 1.0, 0.0
    return step, drive


def feedback_radius(train: Train, period_s: float, on_speeds: Sequence[float], on_commands: Sequence[float]) -> float:
    """Largest magnitude of a pole with u(k) = sum on_speeds[i] v(k-i) + sum on_commands[i] u(k-1-i).

    :param on_speeds: at least two.
    """
    step, drive = open_loop(train, period_s, len(on_commands), len(on_speeds) - 1)
    law = np.zeros(len(drive))
    law[2 : 2 + len(on_commands)] = on_commands
    law[0] = on_speeds[0]
    law[len(law) - len(on_speeds) + 1 :] = on_speeds[1:]
    return magnitude(step + np.outer(drive, law))


def magnitude(matrix: Matrix) -> float:
    """Largest magnitude of an eigenvalue."""
    return float(np.abs(np.linalg.eigvals(matrix)).max())


def spectral_radius(
    train: Train, model: Sampled, weights: Weights[float], period_s: float, smoothing: float | None = None
) -> float:
    """Largest magnitude of a closed-loop pole; the loop is stable if it is below 1.

    :param smoothing: weight of the newest residual in the low-pass; None: the loop without an estimator.
    """
    on_speeds, on_commands = ([-x for x in row] for row in (weights.f, weights.h))
    if smoothing is None:
        return feedback_radius(train, period_s, on_speeds, on_commands)
    inner, command = open_loop(train, period_s, len(model.b), len(model.a))
    xi = len(command)
    past_v = xi - len(model.a)
    step, drive, law = np.zeros((xi + 1, xi + 1)), np.zeros(xi + 1), np.zeros(xi + 1)
    step[:xi, :xi], drive[:xi] = inner, command
    law[0], law[2 : 2 + len(on_commands)] = on_speeds[0], on_commands
    law[past_v : past_v + len(on_speeds) - 1] = on_speeds[1:]
    step[xi, xi] = 1.0 - smoothing
    step[xi, 0] += smoothing
    step[xi, past_v:xi] += smoothing * np.array(model.a)
    step[xi, 2 : 2 + len(model.b)] -= smoothing * np.array(model.b)
    law[xi] = -weights.xi
    return magnitude(step + np.outer(drive, law))


class Spanning(Protocol):
    """Parameters of a law with a horizon."""

    @property
    def horizon(self) -> int: ...

    @property
    def sample_period_s(self) -> float: ...

    @property
    def override(self) -> bool: ...


_HINT = "parameter override = true runs it"


def refuse_short_horizon(law: str, parameters: Spanning, delay_s: float) -> None:
    """Refuse N * T0 <= T: within such a horizon no command has any effect, or the wrong one.

    :param delay_s: the longest delay.
    :raises InputError: the horizon is too short and ``parameters.override`` is not set.
    """
    span_s = parameters.horizon * parameters.sample_period_s
    if span_s <= delay_s + 1e-9 and not parameters.override:
        found = Words(f"horizon {parameters.horizon} * sample_period_s {parameters.sample_period_s:g} = {span_s:g} s")
        raise InputError("controller", law, found, f"more than the longest delay, {delay_s:g} s", _HINT)


def refuse_unstable(law: str, parameters: LawParameters, radii: Mapping[str, float]) -> None:
    """Refuse a closed loop with a spectral radius of 1 or more.

    :param radii: of each mode of the train, in words (``traction``, ``braking``).
    :raises InputError: one of them is 1 or more and ``parameters.override`` is not set.
    """
    mode, radius = max(radii.items(), key=lambda pair: pair[1])
    if radius >= 1.0 and not parameters.override:
        found = Words(f"a closed loop with the spectral radius {radius:.3f} in {mode}")
        raise InputError("controller", law, found, "a spectral radius below 1", _HINT)
