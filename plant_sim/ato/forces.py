"""Forces on a train from tables: effort limits, Davis resistance, grade under the train.

The batch compiles all functions here (:mod:`railhil.common.compilable` lists the permitted language); the tables are
made in :mod:`railhil.plant_sim.ato.force_tables`.
"""

from __future__ import annotations

from bisect import bisect_right
from typing import NamedTuple

from railhil.common.compilable import compilable_functions
from railhil.common.floats import smaller


class EffortLimit(NamedTuple):
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
    traction: EffortLimit
    brake: EffortLimit


class GradeTable(NamedTuple):
    """Grade averaged over the train by position of its front: exact, as it is linear between these breakpoints."""

    from_m: tuple[float, ...]
    permil: tuple[float, ...]
    permil_per_m: tuple[float, ...]


def mean_grade_permil(table: GradeTable, front_m: float) -> float:
    """Grade averaged over the train with its front at ``front_m``; constant before the first and after the last row."""
    row = bisect_right(table.from_m, front_m) - 1
    if row < 0:
        return table.permil[0]
    return table.permil[row] + table.permil_per_m[row] * (front_m - table.from_m[row])


def effort_limit_n(table: EffortLimit, speed_mps: float) -> float:
    """Largest force at a speed: ``min(F_max, P_max / v, curve(v))``, with the curve constant beyond its ends."""
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
        limit_n = smaller(limit_n, curve_n)
    return limit_n


def resistance_n(constants: TrainConstants, speed_mps: float, grade_permil: float) -> float:
    """Davis resistance and grade force, positive against the motion."""
    running_n = constants.resistance_a_n + speed_mps * (
        constants.resistance_b_n_per_mps + speed_mps * constants.resistance_c_n_per_mps2
    )
    return running_n + constants.grade_n_per_permil * grade_permil


compilable_functions(mean_grade_permil, effort_limit_n, resistance_n)
