"""Where a train that is an FMU begins."""

from __future__ import annotations

from railhil.common.errors import InputError
from railhil.plant_sim.fmu.model import Fmu

#: Largest difference of a speed at the start, m/s.
_SAME_MPS = 1e-6


def place_of(fmu: Fmu, position_m: float, speed_mps: float) -> float:
    """Position of the train where the FMU says 0, so that it begins at ``position_m``.

    :raises InputError: it does not begin with ``speed_mps``.
    """
    begun = fmu.begun
    if abs(begun["speed_mps"] - speed_mps) > _SAME_MPS:
        variable = fmu.names.outputs["speed_mps"].variable
        allowed = f"{speed_mps:g}, as the run begins: parameters.NAME = 'start_speed_mps' sets it"
        raise InputError(fmu.file, f"{variable}: start", begun["speed_mps"], allowed)
    return position_m - begun["position_m"]
