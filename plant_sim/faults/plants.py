"""Makes the plant of a run. The plant with faults is used only for a run with faults inside its plant.

Every plant is made here, so the language of faults and their injection are loaded only for runs with faults.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

from railhil.common.errors import InputError, Words
from railhil.plant_sim.any_plant import AnyPlant
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.plant_fmu import OPTION
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    from railhil.faults.model import Fault
    from railhil.plant_sim.faults.injections import Injections

#: Levels of the faults inside the plant.
LEVELS = ("train", "sensor", "actuator")
#: The part of a system that makes its plant with faults, from the arguments of its plant and the numbered faults: a
#: :class:`FaultyPlant`. The system lists the places of these faults in ``injects``; others are refused at load.
PART = "faulty_plant"
#: The part of a system that makes its plant with an FMU for its motion, from the arguments of its plant and the
#: :class:`~railhil.scenarios.plant_fmu.PlantFmu`: a :class:`~railhil.plant_sim.fmu.FmuPlant`. A system
#: without it takes no FMU.
FMU_PART = "fmu_plant"


class FaultyPlant(AnyPlant, Protocol):
    """A plant with faults."""

    #: Its faults, and their changes.
    injections: Injections
    #: Whether all its parts follow a change of the list of its faults (:meth:`Injections.adopt`); missing: no.
    adopts: bool


def in_plant(faults: Sequence[Fault]) -> list[tuple[int, Fault]]:
    """The faults of a run inside the plant, with their numbers in its list, from 1."""
    return [(number, fault) for number, fault in enumerate(faults, 1) if fault.place.level in LEVELS]


def faults_inside(scenario: AnyScenario, seed: int) -> list[tuple[int, Fault]]:
    """The faults of a run inside its plant, with their numbers, distributions drawn."""
    if not scenario.faults:
        return []
    from railhil.scenarios.fault_list import draw_faults

    return in_plant(draw_faults(scenario, seed))


def make_plant(scenario: AnyScenario, run: RunSpec, *, branches: bool = False) -> tuple[AnyPlant, Injections | None]:
    """The plant of a run, and its faults if it has any.

    :param branches: the run may be given other faults: a plant that can take them is the one with faults.
    :raises InputError: the system says that its plant takes faults, and has no such part; the run has a number, and
        those of its system have none.
    """
    run.check_number(scenario)
    system = scenario.installed_system
    given: tuple[Any, ...] = (scenario, run.seed, run.perturbed, run.wall_rate)
    if system.numbered:
        given = (*given, run.run_number)
    found = faults_inside(scenario, run.seed)
    if run.plant_fmu is not None:
        if found:
            where = Words("faults in the plant")
            raise InputError(
                "command line", OPTION, where, "faults of telegrams, nodes and the bus: an FMU has no others"
            )
        if system.fmu_plant is None:
            allowed = f"a system with a part {FMU_PART}: what an FMU exchanges with the plant (docs/howto/fmi.md)"
            raise InputError("command line", OPTION, Words(f"system {system.name}"), allowed)
        return system.part(FMU_PART)(*given, run.plant_fmu), None
    if not found and not (branches and getattr(system.optional_part(PART), "adopts", False)):
        return system.part("plant")(*given), None
    faulty: FaultyPlant = system.part(PART)(*given, found)
    if branches:
        faulty.injections.remember()
    return faulty, faulty.injections


def needs_nodes(scenario: AnyScenario) -> bool:
    """Whether a fault of a scenario needs the nodes of the bench."""
    if not scenario.faults:
        return False
    from railhil.faults.capability import why_not
    from railhil.faults.language import parse

    return any(why_not(parse(text), "batch", "lockstep") for text in scenario.faults)
