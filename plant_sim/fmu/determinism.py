"""Checks whether an FMU is deterministic, and its position at the start."""

from __future__ import annotations

import hashlib
import struct
from typing import NamedTuple, Protocol, cast

from railhil.common.errors import InputError
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.faults.plants import make_plant
from railhil.plant_sim.fmu.model import Fmu
from railhil.plant_sim.fmu.names import Input
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

#: Steps of each of the two runs, and the shares of the command in their equal parts.
TICKS = 4000
_SHARES = (1.0, 0.4, -0.15, 0.6, 0.0, -0.7, -1.0, 0.2)


class FmuPlant(Protocol):
    """A plant with an FMU for its motion, the part ``fmu_plant`` of a system."""

    #: Its FMUs, one for each unit.
    fmus: list[Fmu]


class Twice(NamedTuple):
    """``same``: two equal runs gave the same; None: unknown. ``why``: the reason if they differ or it is unknown."""

    same: bool | None
    why: str


def outputs_sha256(fmu: Fmu) -> str:
    """SHA-256 over all outputs of a new instance after every step, driven by fixed inputs.

    A deterministic FMU gives the same SHA-256 each time.

    :raises PlantError: it refuses a step.
    """
    digest = hashlib.sha256()
    inputs = fmu.quantities.inputs
    for tick in range(TICKS):
        part = tick * len(_SHARES) // TICKS
        values = {name: _value(number, one, part) for number, (name, one) in enumerate(inputs.items())}
        found = fmu.step(values, fmu.step_s)
        digest.update(struct.pack(f"<{len(found)}d", *found.values()))
    return digest.hexdigest()


def _value(number: int, one: Input, part: int) -> float:
    """The command follows its shares; each of the other inputs has its other value in one part."""
    if number == 0:
        return one.other * _SHARES[part]
    return one.other if part == number else one.usual


def twice(scenario: AnyScenario, run: RunSpec) -> Twice:
    """Whether the FMU of a run is deterministic.

    :raises InputError: the FMU cannot be the plant.
    """

    def new() -> Fmu:
        return cast(FmuPlant, make_plant(scenario, run)[0]).fmus[0]

    first = new()
    if first.only_once:
        return Twice(None, "not checked: a process can have only one instance of it")
    try:
        one, other = outputs_sha256(first), outputs_sha256(new())
    except PlantError as error:
        return Twice(None, str(error))
    if one == other:
        return Twice(True, "")
    return Twice(False, f"two equal runs differ (sha256 {one[:16]}, {other[:16]})")


#: Largest difference of a speed at the start, m/s.
_SAME_MPS = 1e-6


def place_of(fmu: Fmu, position_m: float, speed_mps: float) -> float:
    """Position of the train at the FMU's 0, so that it begins at ``position_m``.

    :raises InputError: it does not begin with ``speed_mps``.
    """
    begun = fmu.begun
    if abs(begun["speed_mps"] - speed_mps) > _SAME_MPS:
        variable = fmu.names.outputs["speed_mps"].variable
        allowed = f"{speed_mps:g}, as the run begins: parameters.NAME = 'start_speed_mps' sets it"
        raise InputError(fmu.file, f"{variable}: start", begun["speed_mps"], allowed)
    return position_m - begun["position_m"]
