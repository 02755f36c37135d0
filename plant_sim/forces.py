"""Forces on a train as tables and pure functions: effort limits, Davis resistance, grade under the train."""

from __future__ import annotations

from bisect import bisect_right
from math import inf
from typing import NamedTuple

import numpy as np

from railhil.scenarios.model import Effort, Profile, Train
from railhil.scenarios.profiles import Floats, MeanGrade

_KMH = 3.6


class EffortTable(NamedTuple):
    """Force limit over speed; ``power_max_w`` is infinite and the curve empty when there is none."""

    force_max_n: float
    power_max_w: float
    curve_mps: tuple[float, ...]
    curve_n: tuple[float, ...]


class TrainConstants(NamedTuple):
    """Constants of one train in SI units; resistance in N is ``a + b v + c v^2 + grade_n_per_permil * grade``."""

    mass_kg: float
    resistance_a_n: float
    resistance_b_n_per_mps: float
    resistance_c_n_per_mps2: float
    grade_n_per_permil: float
    pole_per_s: float
    traction: EffortTable
    brake: EffortTable


class GradeTable(NamedTuple):
    """Grade averaged over the train by position of its front: exact, as it is linear between these breakpoints."""

    from_m: tuple[float, ...]
    permil: tuple[float, ...]
    permil_per_m: tuple[float, ...]


def effort_table(effort: Effort) -> EffortTable:
    """Table of a force limit."""
    power_w = inf if effort.power_max_w is None else effort.power_max_w
    return EffortTable(
        effort.force_max_n,
        power_w,
        tuple(speed for speed, _ in effort.curve),
        tuple(force for _, force in effort.curve),
    )


def train_constants(train: Train) -> TrainConstants:
    """Constants of a train; Davis coefficients are turned from N/kN and km/h into N and m/s."""
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
    """Breakpoints of ``(height(x) - height(x - length)) / length``, height being the integral of the grade.

    :returns: the fields of a :class:`GradeTable` as arrays of shape (rows,); all but the first of shape (N, rows) when
        the grades of the profile are arrays over N runs.
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


def mean_grade_permil(table: GradeTable, front_m: float) -> float:
    """Grade averaged over the train with its front at ``front_m``; held before the first and after the last row."""
    row = bisect_right(table.from_m, front_m) - 1
    if row < 0:
        return table.permil[0]
    return table.permil[row] + table.permil_per_m[row] * (front_m - table.from_m[row])


def effort_limit_n(table: EffortTable, speed_mps: float) -> float:
    """Greatest force at a speed: ``min(F_max, P_max / v, curve(v))``, the curve held at both ends."""
    limit_n = table.force_max_n
    if limit_n * speed_mps > table.power_max_w:
        limit_n = table.power_max_w / speed_mps
    speeds = table.curve_mps
    if len(speeds):
        row = bisect_right(speeds, speed_mps)
        forces = table.curve_n
        if row == 0:
            curve_n = forces[0]
        elif row == len(speeds):
            curve_n = forces[-1]
        else:
            share = (speed_mps - speeds[row - 1]) / (speeds[row] - speeds[row - 1])
            curve_n = forces[row - 1] + share * (forces[row] - forces[row - 1])
        limit_n = min(limit_n, curve_n)
    return limit_n


def resistance_n(constants: TrainConstants, speed_mps: float, grade_permil: float) -> float:
    """Davis resistance and grade force, positive against the motion."""
    running_n = constants.resistance_a_n + speed_mps * (
        constants.resistance_b_n_per_mps + speed_mps * constants.resistance_c_n_per_mps2
    )
    return running_n + constants.grade_n_per_permil * grade_permil
