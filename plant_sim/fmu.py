"""Plants whose motion is an FMU: its instance, whether it is deterministic, and its position at the start."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Protocol, cast

from railhil.common.errors import InputError
from railhil.fmu.determinism import Twice, outputs_sha256, twice
from railhil.fmu.instance import Fmu, FmuError
from railhil.fmu.names import Quantities
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.faults.plants import make_plant
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.plant_fmu import OPTION, PlantFmu
from railhil.scenarios.run_spec import RunSpec


class TrainFmu(Fmu):
    """One instance of the FMU of a train; ``train``: values of the train's keys. See :class:`Fmu`."""

    def __init__(
        self, named: PlantFmu, quantities: Quantities, train: Mapping[str, float], step_s: float, several: str = ""
    ) -> None:
        file, names = Path(named.file), Path(named.map)
        super().__init__(f"railhil {OPTION}", file, names, quantities, train, step_s, several=several)

    def step(self, inputs: Mapping[str, float], step_s: float, time_s: float | None = None) -> dict[str, float]:
        """Set the inputs, make a step, and read the outputs.

        :raises PlantError: the FMU refuses it.
        """
        try:
            return super().step(inputs, step_s, time_s)
        except FmuError as error:
            raise PlantError(f"{self.file.name}: {error}") from None


class FmuPlant(Protocol):
    """A plant with an FMU for its motion, the part ``fmu_plant`` of a system."""

    #: Its FMUs, one for each unit.
    fmus: list[TrainFmu]


def plant_twice(scenario: AnyScenario, run: RunSpec) -> Twice:
    """Whether the FMU of a run is deterministic.

    :raises InputError: the FMU cannot be the plant.
    """

    def new() -> TrainFmu:
        return cast(FmuPlant, make_plant(scenario, run)[0]).fmus[0]

    first = new()
    if first.only_once:
        return Twice(None, "not checked: a process can have only one instance of it")
    return twice([partial(_outputs_sha256, fmu) for fmu in (first, new())], PlantError)


def _outputs_sha256(fmu: TrainFmu) -> str:
    return outputs_sha256(lambda values: fmu.step(values, fmu.step_s).values(), fmu.quantities.inputs)


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
