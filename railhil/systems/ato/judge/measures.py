"""The terms of the scores, sample by sample: pure functions on numbers or on arrays.

These functions, and the order in which their results are added (:func:`total`), determine every digit of a score. A
compiled loop over many trains gives the same digits by using them in the same order: the batch compiles the marked ones
for single numbers (:mod:`railhil.common.compilable` lists the permitted language).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy import inf, minimum

from railhil.common.compilable import chosen, compilable
from railhil.scenarios.profiles import Profile
from railhil.systems.ato.scenario.model import Energy

KMH = 3.6


def total(values: Any) -> Any:
    """Sum along the last axis, from the first to the last value (``sum`` of numpy adds in another order)."""
    array = np.asarray(values)
    return np.cumsum(array, axis=-1)[..., -1] if array.shape[-1] else np.zeros(array.shape[:-1])


@compilable
def error_kmh(wanted_mps: Any, speed_mps: Any) -> Any:
    """Magnitude of a speed error in km/h."""
    return abs(wanted_mps - speed_mps) * KMH


@compilable
def work_j(seconds: Any, first_w: Any, last_w: Any) -> Any:
    """Work between two samples of a power: trapezoidal rule."""
    return seconds * (last_w + first_w) / 2.0


@compilable
def limits_under_train(limits: Profile, front_m: Any, length_m: float) -> Any:
    """Speed limit in force for the whole train at each front position, m/s, shape of ``front_m``.

    A lower limit applies when the front has passed, a higher one when the rear has passed.
    """
    allowed: Any = inf
    for index in range(len(limits)):
        end_m = limits[index + 1][0] if index + 1 < len(limits) else inf
        begin_m = -inf if index == 0 else limits[index][0]
        touched = (front_m >= begin_m) & (front_m - length_m < end_m)
        allowed = chosen(touched, minimum(allowed, limits[index][1]), allowed)
    return allowed


def itae_kmh_s2(sums_kmh: Any, counts: Any, period_s: float, shares: Any) -> Any:
    """Eq. (4): sum of k Tc^2 times the mean |e| of cycle k, from the sum over the samples of each cycle.

    :param sums_kmh: shape (..., cycles); cycle 1 comes first.
    :param counts: samples of each cycle, shape (cycles,).
    :param shares: of each cycle that lies in the timetable, shape (cycles,); the last cycle may be cut off by its end.
    """
    cycles = np.arange(1, counts.size + 1)
    return total(cycles * period_s**2 * sums_kmh / np.maximum(counts, 1) * shares)


def comfort_mps2_per_km(accel_mps2: Any, distance_m: float) -> Any:
    """Eq. (6): sum of |a_k - a_(k-1)| over control ticks, with the last drop to zero, per km of the plan.

    :param accel_mps2: at the control ticks, shape (..., n). Repeating the last one changes nothing.
    """
    return (total(np.abs(np.diff(accel_mps2))) + abs(accel_mps2[..., -1])) / (distance_m / 1000)


def energy_kj(energy: Energy, traction_j: Any, brake_j: Any, seconds: Any) -> Any:
    """Eq. (5): traction work / xi_M + auxiliary power * time + xi_B * brake work."""
    return (traction_j / energy.xi_m + energy.auxiliary_power_w * seconds + energy.xi_b * brake_j) / 1000
