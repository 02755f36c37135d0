"""The train of the system ``line`` on the bus."""

from __future__ import annotations

from railhil.plant_sim.ato.train import TrainOnBus
from railhil.systems.line.scenario.model import LineScenario


class LineTrain(TrainOnBus):
    """See :class:`railhil.plant_sim.any_plant.AnyPlant`."""

    def __init__(self, scenario: LineScenario, seed: int, drawn: bool = False, rate: float = 0.0) -> None:
        super().__init__(scenario, seed, drawn, rate)
