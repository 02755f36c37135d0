"""Force limits and resistance of a train in N, shared by the target curve generator and other modules."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from railhil.systems.ato.scenario.model import Effort, Train

Floats: TypeAlias = NDArray[np.float64]


def force_limit_n(effort: Effort, speed_mps: ArrayLike) -> Floats:
    """``min(force_max_n, power_max_w / v, curve(v))`` in N, speed scalar or array in m/s (0 allowed)."""
    speed = np.abs(np.asarray(speed_mps, dtype=np.float64))
    force = np.full_like(speed, effort.force_max_n)
    if effort.power_max_w is not None:
        with np.errstate(divide="ignore"):
            force = np.minimum(force, effort.power_max_w / speed)
    if effort.curve:
        table = np.array(effort.curve)
        force = np.minimum(force, np.interp(speed, table[:, 0], table[:, 1]))
    return force


def resistance_n(train: Train, speed_mps: ArrayLike, grade_permil: ArrayLike) -> Floats:
    """Running and grade resistance in N: ``weight_kn (a + b V + c V^2 + grade)``, V in km/h."""
    kmh = 3.6 * np.asarray(speed_mps, dtype=np.float64)
    weight_kn = train.mass_kg * train.gravity_mps2 / 1000
    davis = train.davis_a_n_per_kn + kmh * (train.davis_b_n_per_kn_kmh + kmh * train.davis_c_n_per_kn_kmh2)
    return np.asarray(weight_kn * (davis + np.asarray(grade_permil, dtype=np.float64)))
