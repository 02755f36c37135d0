"""Tables of the forces on a train, made from its scenario.

Masses, coefficients and grades may be arrays over N runs, made by the batch. Therefore mypyc does not compile this
module, while it compiles :mod:`railhil.plant_sim.ato.forces`.
"""

from __future__ import annotations

from math import inf

from railhil.plant_sim.ato.forces import EffortLimit, GradeTable, TrainConstants
from railhil.scenarios.profiles import Profile, grade_rows
from railhil.systems.ato.scenario.model import Effort, Train

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


def grade_table(grade_permil: Profile, length_m: float) -> GradeTable:
    """The table of one run."""
    from_m, permil, slope = grade_rows(grade_permil, length_m)
    return GradeTable(tuple(from_m.tolist()), tuple(permil.tolist()), tuple(slope.tolist()))
