"""A train and a line that differ from the controller's data in mass and gradient."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.common.errors import InputError, Words
from railhil.faults.capability import MISMATCHES
from railhil.faults.language import parse
from railhil.faults.model import Fault
from railhil.plant_sim.faults.plants import needs_nodes
from railhil.scenarios.fault_list import draw_each
from railhil.systems.ato.scenario.model import Line, Scenario, Train


@dataclass(frozen=True, slots=True)
class Mismatch:
    """Factors on both masses, on the Davis coefficients and on the grade, and an addition to the grade.

    Each is a number, or an array over N trains.
    """

    mass: Any = 1.0
    resistance: Any = 1.0
    grade: Any = 1.0
    grade_permil: Any = 0.0

    @classmethod
    def of(cls, faults: Iterable[Fault]) -> Mismatch:
        """The faults of :data:`railhil.faults.capability.MISMATCHES` among some, together and in their order."""
        mass, resistance, grade, permil = 1.0, 1.0, 1.0, 0.0
        for fault in faults:
            key = fault.place.name, fault.what
            if fault.place.level != "train" or key not in MISMATCHES:
                continue
            if fault.what == "offset":
                permil += fault.parameter("permil")
            elif key[0] == "mass":
                mass *= fault.parameter("factor")
            elif key[0] == "resistance":
                resistance *= fault.parameter("factor")
            else:
                grade, permil = grade * fault.parameter("factor"), permil * fault.parameter("factor")
        return cls(mass, resistance, grade, permil)

    @classmethod
    def over(cls, mismatches: Sequence[Mismatch]) -> Mismatch:
        """The mismatches of N trains as arrays of shape (N,)."""
        return cls(*(np.array([getattr(one, item.name) for one in mismatches]) for item in fields(cls)))

    def applied(self, scenario: Scenario) -> Scenario:
        """The scenario with this mismatch; ``sha256`` stays, as for a perturbed run."""
        healthy = scenario.train
        train: Train = replace(
            healthy,
            mass_kg=healthy.mass_kg * self.mass,
            inertial_mass_kg=healthy.inertial_mass_kg * self.mass,
            davis_a_n_per_kn=healthy.davis_a_n_per_kn * self.resistance,
            davis_b_n_per_kn_kmh=healthy.davis_b_n_per_kn_kmh * self.resistance,
            davis_c_n_per_kn_kmh2=healthy.davis_c_n_per_kn_kmh2 * self.resistance,
        )
        rows = scenario.line.grade_permil
        grades = tuple((from_m, permil * self.grade + self.grade_permil) for from_m, permil in rows)
        line: Line = replace(scenario.line, grade_permil=grades)
        return replace(scenario, train=train, line=line)


def constant_mismatches(
    scenario: Scenario, seeds: Sequence[int], draws: NDArray[np.float64] | None = None
) -> list[Mismatch]:
    """The faults of runs without nodes, as a mismatch of train and line for each seed.

    :param draws: of these runs, shape (seeds, draws), instead of those of the scenario.
    :raises InputError: one of them needs the nodes.
    """
    if needs_nodes(scenario):
        allowed = "mass, gradient or resistance from the start to the end: other faults need the nodes of the bench"
        raise InputError(scenario.name, "fault", Words("; ".join(scenario.faults)), allowed)
    faults = [parse(text) for text in scenario.faults]
    rows = [scenario.draws] * len(seeds) if draws is None else draws.tolist()
    return [Mismatch.of(draw_each(faults, seed, row)) for seed, row in zip(seeds, rows, strict=True)]
