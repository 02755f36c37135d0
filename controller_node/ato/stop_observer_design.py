"""Offline part of the observer of ``ipfc_plus_stop``: gains along the plan, and the actuator's lag twice, in SI units.

An actuator of time constant 1/p + l behind an additional delay t turns a notch u into a force; with m = u after the
nominal lag p / (s + p), and mm = m after the same lag once more, to the first order in l and t::

    u e^(-t s) / ((1/p + l) s + 1) = m - l p (m - mm) - t m'       p (m - mm) = mm'

Both shift a steadily rising force by l + t, but they differ in how a change of the rise shows, and a train's last
seconds are such a change.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from railhil.controller_node.ato.pfc_model import Matrix


@dataclass(frozen=True)
class StopUncertainty:
    """Assumptions of the observer: standard deviations of the unknowns at the start, a random walk, noise.

    ``gain`` relative, ``lag_s`` of the actuator's time constant, ``delay_s`` of the loop, ``disturbance_mps2``; its
    random walk per square root of a second, and as a share ``drag`` of each change of the planned drag (resistance and
    grade that are not quite those of the plan); ``noise_mps`` of one speed reading.
    """

    gain: float
    lag_s: float
    delay_s: float
    disturbance_mps2: float
    disturbance_walk_mps2: float
    drag: float
    noise_mps: float


def lagged_force(force_mps2: Matrix, pole_per_s: float, period_s: float) -> Matrix:
    """A force that is linear between the control periods, after a lag that begins at rest; shape (periods,)."""
    decay = math.exp(-pole_per_s * period_s)
    lagged = np.zeros_like(force_mps2)
    for k in range(1, force_mps2.size):
        behind = (force_mps2[k] - force_mps2[k - 1]) / (period_s * pole_per_s)
        lagged[k] = force_mps2[k] - behind * (1 - decay) + (lagged[k - 1] - force_mps2[k - 1]) * decay
    return lagged


def stop_observer_gains(
    force_mps2: Matrix, drag_mps2: Matrix, pole_per_s: float, period_s: float, uncertainty: StopUncertainty
) -> Matrix:
    """Kalman gains of [speed, disturbance, relative gain, lag, delay] along the plan; shape (periods, 5).

    Units: 1, 1/s, s/m, s^2/m, s^2/m. As :func:`~railhil.controller_node.ato.ipfc_plus_design.observer_gains`, but
    time constant and delay are two unknowns, and the disturbance wanders where the planned drag changes.

    :param force_mps2: planned force at the beginning of each period, ``drag_mps2`` the drag in it, shape (periods,).
    """
    u = uncertainty
    lagged = lagged_force(force_mps2, pole_per_s, period_s)
    covariance = np.diag([u.noise_mps**2, u.disturbance_mps2**2, u.gain**2, u.lag_s**2, u.delay_s**2])
    gains = np.zeros((force_mps2.size, 5))
    for k in range(force_mps2.size):
        if k > 0:
            change = np.eye(5)
            change[0, 1:] = (
                period_s,
                period_s * (force_mps2[k] + force_mps2[k - 1]) / 2,
                lagged[k - 1] - lagged[k],
                force_mps2[k - 1] - force_mps2[k],
            )
            covariance = change @ covariance @ change.T
            change_mps2 = u.drag * (drag_mps2[k] - drag_mps2[k - 1])
            covariance[1, 1] += u.disturbance_walk_mps2**2 * period_s + change_mps2**2
        gains[k] = covariance[:, 0] / (covariance[0, 0] + u.noise_mps**2)
        covariance = covariance - np.outer(gains[k], covariance[0])
        covariance = (covariance + covariance.T) / 2
    return gains


@dataclass(frozen=True)
class TwiceWeights:
    """The notch after two lags, as weights: ``over_period`` on [itself, lagged notch, notch before, notch now], one
    period later; ``over_delay`` on [itself, lagged notch, notch before], when the notch now begins to act."""

    over_period: tuple[float, float, float, float]
    over_delay: tuple[float, float, float]


def lag_twice(pole_per_s: float, period_s: float, delay_s: float) -> TwiceWeights:
    """Exact for notches that are constant between the instants at which they begin to act."""

    def part(length_s: float) -> tuple[float, float]:
        decay = math.exp(-pole_per_s * length_s)
        return decay, pole_per_s * length_s * decay

    first, first_once = part(delay_s)
    rest, rest_once = part(period_s - delay_s)
    before = rest * (1 - first - first_once) + rest_once * (1 - first)
    once = rest * first_once + rest_once * first
    return TwiceWeights(
        (rest * first, once, before, 1 - rest * first - once - before),
        (first, first_once, 1 - first - first_once),
    )
