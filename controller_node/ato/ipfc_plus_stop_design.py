"""Offline part of the end phase of IPFC+: gains of the last seconds before the stop, in SI units.

Between two control periods the deviations from the plan obey, with actuator pole p, acting force f and demanded force u
(all as accelerations), for a period h::

    f' = e f + (1 - e) u      v' = v + A f + (h - A) u      x' = x + h v + B f + (h^2 / 2 - B) u
    e = exp(-p h)             A = (1 - e) / p               B = (h - A) / p

The commands already on their way are inside f. Where the train stops depends on x, v and f at the aim alone, so the
gains follow backwards from the stop by the finite-horizon linear quadratic regulator (Riccati recursion, e.g. Bryson
and Ho 1975, section 2.6).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from railhil.controller_node.ato.pfc_model import Matrix


@dataclass(frozen=True)
class StopWeights:
    """Deviations that count as much as each other: position and speed at the planned stop, demand held for 1 s."""

    position_m: float
    speed_mps: float
    demand_mps2: float


def stop_gains(pole_per_s: float, left_s: Matrix, weights: StopWeights) -> Matrix:
    """Gains on the deviations of position, speed and acting force; shape (periods, 3), units 1/s^2, 1/s and 1.

    :param left_s: time left to the planned stop when the notch of each period begins to act, falling, above 0.
    """
    cost = np.diag([weights.position_m**-2, weights.speed_mps**-2, 0.0])
    gains = np.zeros((left_s.size, 3))
    until_s = np.append(left_s[1:], 0.0)
    for k in range(left_s.size - 1, -1, -1):
        h = float(left_s[k] - until_s[k])
        decay = math.exp(-pole_per_s * h)
        once = (1 - decay) / pole_per_s
        twice = (h - once) / pole_per_s
        free = np.array([[1.0, h, twice], [0.0, 1.0, once], [0.0, 0.0, decay]])
        forced = np.array([h * h / 2 - twice, h - once, 1 - decay])
        by_demand = forced @ cost
        gains[k] = by_demand @ free / (h * weights.demand_mps2**-2 + by_demand @ forced)
        cost = free.T @ cost @ (free - np.outer(forced, gains[k]))
        cost = (cost + cost.T) / 2
    return gains
