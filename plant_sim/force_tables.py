"""Tables of the forces on a train, made from its scenario.

Masses, coefficients and grades may be arrays over N runs, made by the batch. Therefore mypyc does not compile this
module, while it compiles :mod:`railhil.plant_sim.forces`.
"""

from __future__ import annotations

from math import inf

import numpy as np

from railhil.plant_sim.forces import EffortLimit, GradeTable, TrainConstants
from railhil.systems.ato.scenario.model import Effort, Profile, Train
from railhil.systems.ato.scenario.profiles import Floats, MeanGrade

_KMH = 3.6


def effort_table(effort: Effort) -> EffortLimit:
    """Table of a force limit."""
    power_w = inf if effort.power_max_w is None else effort.power_max_w
    return EffortLimit(
        effort.force_max_n,
        power_w,
        tuple(speed for speed, _ in effort.curve),
        tuple(force for _, force in effort.curve),
    )


def train_constants(train: Train) -> TrainConstants:
    """Constants of a train; Davis coefficients are converted from N/kN and km/h to N and m/s."""
    weight_kn = train.mass_kg * train.gravity_mps2 / 1000.0
    return TrainConstants(
        train.inertial_mass_kg,
        weight_kn * train.davis_a_n_per_kn,
        weight_kn * train.davis_b_n_per_kn_kmh * _KMH,
        weight_kn * train.davis_c_n_per_kn_kmh2 * _KMH**2,
        weight_kn,
        train.actuator_pole_per_s,
        effort_table(train.traction),
        effort_table(train.brake),
    )


def grade_rows(grade_permil: Profile, length_m: float) -> tuple[Floats, Floats, Floats]:
    """Breakpoints of ``(height(x) - height(x - length)) / length``, where height is the integral of the grade.

    :returns: the fields of a :class:`GradeTable` as arrays of shape (rows,); all except the first of shape (N, rows)
        when the grades of the profile are arrays over N runs.
    """
    mean = MeanGrade(grade_permil, length_m)
    from_m = mean.breakpoints_m
    permil = mean(from_m)
    slope = np.diff(permil) / np.diff(from_m)
    return from_m, permil, np.concatenate((slope, np.zeros((*slope.shape[:-1], 1))), axis=-1)


def grade_table(grade_permil: Profile, length_m: float) -> GradeTable:
    """The table of one run."""
    from_m, permil, slope = grade_rows(grade_permil, length_m)
    return GradeTable(tuple(from_m.tolist()), tuple(permil.tolist()), tuple(slope.tolist()))
