"""Makes the plant of a run: the one with faults only for a run that has any in its plant."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from railhil.faults.model import Fault
from railhil.plant_sim.any_plant import AnyPlant
from railhil.plant_sim.faults.injections import Injections
from railhil.plant_sim.faults.mismatch import Mismatch, is_constant
from railhil.scenarios.fault_list import drawn_faults
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import system_named

#: Levels of the faults that live in the plant.
LEVELS = ("train", "sensor", "actuator")
#: The part of a system that makes its plant with faults, from (scenario, seed, perturbed, rate, numbered faults): a
#: :class:`FaultyPlant`. The system lists the places of these faults in ``injects``; others are refused at load.
PART = "faulty_plant"


class FaultyPlant(AnyPlant, Protocol):
    """A plant with faults."""

    #: Its faults, and what they have changed.
    injections: Injections


def in_plant(faults: Sequence[Fault]) -> list[tuple[int, Fault]]:
    """The faults of a run that live in the plant, with their numbers in its list, from 1."""
    return [(number, fault) for number, fault in enumerate(faults, 1) if fault.place.level in LEVELS]


def make_plant(scenario: AnyScenario, run: RunSpec) -> tuple[AnyPlant, Injections | None]:
    """The plant of a run, and its faults if it has any.

    :raises InputError: the system says that its plant takes faults, and has no such part.
    """
    system = system_named(scenario.system)
    given = scenario, run.seed, run.perturbed, run.wall_rate
    found = in_plant(drawn_faults(scenario.faults, run.seed)) if scenario.faults else []
    if not found:
        return system.part("plant")(*given), None
    faulty: FaultyPlant = system.part(PART)(*given, found)
    return faulty, faulty.injections


def constant_mismatch(scenario: AnyScenario, seed: int) -> Mismatch | None:
    """The faults of a run as a mismatch of its train and line; None: another fault needs the nodes of the bench.

    :param seed: of the run.
    """
    faults = drawn_faults(scenario.faults, seed)
    return Mismatch.of(faults) if all(map(is_constant, faults)) else None
