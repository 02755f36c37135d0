"""Makes the plant of a run: the one with faults only for a run that has any in its plant."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from railhil.common.errors import InputError, Words
from railhil.faults.model import Fault
from railhil.plant_sim.any_plant import AnyPlant
from railhil.plant_sim.faults.injections import Injections
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import System, system_named

#: Levels of the faults that live in the plant.
LEVELS = ("train", "sensor", "actuator", "command")
#: The part of a system that makes its plant with faults, from (scenario, seed, perturbed, rate, numbered faults). Its
#: attribute ``refusal`` is a function of a fault and returns why this plant cannot have it, empty if it can.
PART = "faulty_plant"


class FaultyPlant(AnyPlant, Protocol):
    """A plant with faults."""

    #: Its faults, and what they have changed.
    injections: Injections


def in_plant(faults: Sequence[Fault]) -> list[tuple[int, Fault]]:
    """The faults of a run that live in the plant, with their numbers in its list, from 1."""
    return [(number, fault) for number, fault in enumerate(faults, 1) if fault.place.level in LEVELS]


def check_faults(scenario: AnyScenario, faults: Sequence[Fault]) -> None:
    """Refuse faults that the plant of a scenario cannot have.

    :param faults: all of the run.
    :raises InputError: the first of them.
    """
    system = system_named(scenario.system)
    for number, fault in in_plant(faults):
        found = Words(f"{fault.place.level} {fault.place.name} {fault.what}")
        if PART not in system.own:
            allowed = f"telegram, node, bus or clock: the plant of the system {system.name} takes no faults"
            raise InputError(scenario.name, f"fault {number}", found, allowed)
        if reason := system.part(PART).refusal(fault):
            raise InputError(scenario.name, f"fault {number}", found, reason)


def make_plant(system: System, scenario: AnyScenario, run: RunSpec, faults: Sequence[Fault] = ()) -> AnyPlant:
    """The plant of a run.

    :param faults: all of the run.
    :raises InputError: it cannot have one of them.
    """
    given = scenario, run.seed, run.perturbed, run.wall_rate
    if not (found := in_plant(faults)):
        plant: AnyPlant = system.part("plant")(*given)
        return plant
    check_faults(scenario, faults)
    faulty: FaultyPlant = system.part(PART)(*given, found)
    return faulty
