"""What the ideal train can do in one cell: its drivings, with work, time and the speed behind the cell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from railhil.scenarios.profiles import Floats
from railhil.systems.ato.energy.ideal_train import Cells, Driving, Forces

#: Shares of the traction force that are tried beside holding, coasting and braking.
_SHARES = (1.0, 0.75, 0.5, 0.25)
#: Number of drivings: the shares, hold, coast, brake.
DRIVINGS = len(_SHARES) + 3
#: A train that is slower than this between its stops has stopped (chosen).
_SLOWEST_MPS = 0.1
#: Work and time of a driving that stops between the stops.
IMPOSSIBLE = 1e15


@dataclass(frozen=True, slots=True)
class Ends:
    """Speed behind the cell (m/s), traction work (J) and time (s) of each driving, shape (drivings, ...)."""

    speed_mps: Floats
    work_j: Floats
    time_s: Floats


class Transitions:
    """The drivings of each cell of a section.

    Each is one of: a share of the traction force, hold the speed, coast, brake. One that would pass the speed of the
    fastest run is held to it, so that driving to this ceiling is among them.
    """

    def __init__(self, cells: Cells, top_mps: Floats, forces: Forces, driving: Driving) -> None:
        self._forces, self._braking_mps2 = forces, driving.braking_mps2
        self._length_m, self._grade_n = cells.lengths_m, forces.weight_kn * cells.grade_permil
        self._top_squared = top_mps[1:] ** 2

    def ends(self, cell: int | slice, speed_mps: Floats) -> Ends:
        """The drivings from given speeds.

        :param cell: number of the cell, or several cells.
        :param speed_mps: at the begin of the cell: shape (m,), or (cells, m) for several cells.
        """
        length_m, grade_n, top = self._length_m[cell], self._grade_n[cell], self._top_squared[cell]
        if isinstance(cell, slice):
            length_m, grade_n, top = length_m[:, None], grade_n[:, None], top[:, None]
        forces = self._forces
        before = speed_mps**2
        pull_n = self._pull_n(speed_mps)
        resistance_n = self._resistance_n(speed_mps) + grade_n
        after = np.empty((DRIVINGS, *speed_mps.shape))
        for row, share in enumerate((*_SHARES, 0.0)):
            middle = np.sqrt(np.maximum(before + (share * pull_n - resistance_n) / forces.mass_kg * length_m, 0.0))
            net_n = share * self._pull_n(middle) - self._resistance_n(middle) - grade_n
            after[row] = before + 2 * length_m * net_n / forces.mass_kg
        after[-2] = np.minimum(before, after[0])
        after[-1] = before - 2 * self._braking_mps2 * length_m
        # The deceleration of coasting is not limited by the comfort of braking.
        np.minimum(after, top, out=after)
        is_stopped = (after < _SLOWEST_MPS**2) & (top > 0.0)
        np.maximum(after, 0.0, out=after)
        speed = np.sqrt(after)
        middle = np.sqrt((before + after) / 2)
        work_j = forces.mass_kg * (after - before) / 2 + (self._resistance_n(middle) + grade_n) * length_m
        np.maximum(work_j, 0.0, out=work_j)
        work_j[len(_SHARES)] = 0.0
        with np.errstate(divide="ignore"):
            time_s = np.minimum(2 * length_m / (speed + speed_mps), IMPOSSIBLE)
        time_s[is_stopped] = IMPOSSIBLE
        return Ends(speed, work_j, time_s)

    def work_j(self, speed_mps: Floats) -> Floats:
        """Traction work of each cell, J, for a driving given by its speeds at the edges, shape (cells + 1,)."""
        before, after = speed_mps[:-1] ** 2, speed_mps[1:] ** 2
        resistance_n = self._resistance_n(np.sqrt((before + after) / 2)) + self._grade_n
        return np.asarray(np.maximum(self._forces.mass_kg * (after - before) / 2 + resistance_n * self._length_m, 0.0))

    def _pull_n(self, speed_mps: Floats) -> Floats:
        return np.asarray(np.interp(speed_mps, self._forces.speed_mps, self._forces.traction_n))

    def _resistance_n(self, speed_mps: Floats) -> Floats:
        return np.asarray(np.interp(speed_mps, self._forces.speed_mps, self._forces.resistance_n))
