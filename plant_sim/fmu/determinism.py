"""Whether an FMU does the same twice."""

from __future__ import annotations

import hashlib
import struct

from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.fmu.train import FmuTrain
from railhil.scenarios.model import Scenario
from railhil.scenarios.plant_fmu import PlantFmu

#: Ticks of each of the two runs, and the notches (1/256) that they go through, each for an equal part.
TICKS = 4000
_NOTCHES = (1792, 700, -256, 1000, 0, -1200, -1792, 300)


def motion_sha256(scenario: Scenario, named: PlantFmu) -> str:
    """SHA-256 over position, speed and force after every tick of a new instance, driven by fixed notches.

    An FMU that is deterministic gives the same one each time.

    :raises InputError: the FMU cannot be the plant.
    :raises PlantError: it refuses a step, or its state is not finite.
    """
    train = FmuTrain(scenario, 0, False, 0.0, named)
    digest = hashlib.sha256()
    for tick in range(TICKS):
        train.command(_NOTCHES[tick * len(_NOTCHES) // TICKS], False)
        train.advance()
        digest.update(struct.pack("<3d", *train.motion[:3]))
    return digest.hexdigest()


def twice(scenario: Scenario, named: PlantFmu) -> str:
    """Why an FMU is not deterministic; empty if it is."""
    try:
        first, second = (motion_sha256(scenario, named) for _ in range(2))
    except PlantError as error:
        return str(error)
    return "" if first == second else f"two equal runs differ (sha256 {first[:16]}, {second[:16]})"
