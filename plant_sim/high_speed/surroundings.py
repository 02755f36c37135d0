"""Surroundings of a high-speed train: grades drawn for the run, wind, noise of its readings, each with its random
stream."""

from __future__ import annotations

from math import exp, sqrt

import numpy as np

from railhil.plant_sim.high_speed.dynamics import Grades
from railhil.scenarios import streams
from railhil.scenarios.profiles import grade_rows

#: The grades continue behind the stopping point for a train that overruns it.
_BEYOND_M = 10_000.0


class Wind:
    """Acceleration by the wind: first-order autoregressive, with a given standard deviation and correlation time.

    :param step_s: time between two values; the first is drawn from the steady distribution.
    """

    def __init__(self, seed: int, sigma_mps2: float, time_s: float, step_s: float) -> None:
        self._normals = streams.NormalSequence(streams.generator(seed, streams.WIND))
        self.keep = exp(-step_s / time_s)
        self.add = sigma_mps2 * sqrt(1.0 - self.keep * self.keep)
        #: The present value.
        self.accel_mps2 = sigma_mps2 * self._normals()

    def step(self) -> None:
        """Advance to the next value."""
        self.accel_mps2 = self.keep * self.accel_mps2 + self.add * self._normals()


def drawn_grades(seed: int, permil_max: float, piece_m: tuple[float, float], end_m: float, length_m: float) -> Grades:
    """Grades of one run: pieces of uniformly distributed length and grade, averaged over the train's length.

    :param piece_m: shortest and longest piece.
    :param end_m: the stopping point.
    """
    if permil_max == 0.0:
        return Grades((0.0,), (0.0,), (0.0,))
    source = streams.generator(seed, streams.GRADES)
    profile, at_m = [], 0.0
    while at_m < end_m + _BEYOND_M:
        length, permil = source.random(2)
        profile.append((at_m, permil_max * (2.0 * permil - 1.0)))
        at_m += piece_m[0] + (piece_m[1] - piece_m[0]) * length
    rows = grade_rows(tuple((float(at), float(grade)) for at, grade in profile), length_m)
    return Grades(*(tuple(np.asarray(row, dtype=np.float64).tolist()) for row in rows))
