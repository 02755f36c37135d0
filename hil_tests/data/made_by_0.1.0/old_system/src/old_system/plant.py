"""The simulated cart on the bus."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from railhil.bus.layout import Telegram
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.timed_run import TimedPlant
from railhil.scenarios import streams

from old_system.wire import COMMAND, LAW_STAT, STAT, TRUTH

#: Distance from 0 at which the cart leaves its track, m.
TRACK_M = 100.0
_FORCE_LSB_N = 0.01


class Cart(TimedPlant):
    """A railhil.plant_sim.any_plant.AnyPlant. ``drawn``: the mass is drawn with the seed (``--perturbed``)."""

    commands: Mapping[str, type[Telegram]] = {COMMAND.PORT: COMMAND}
    #: Ports of the controller that are polled only for the record.
    statuses = (LAW_STAT.PORT,)

    def __init__(self, scenario: Any, seed: int, drawn: bool, rate: float) -> None:
        super().__init__(scenario, rate, {STAT.PORT: self._stat, TRUTH.PORT: self._truth})
        self._task = scenario.task
        self._mass_kg = self._task.mass_kg
        if drawn:
            draw = streams.generator(seed, streams.PERTURBATION).uniform(-1, 1)
            self._mass_kg *= 1 + self._task.mass_spread * draw
        self._noise = streams.generator(seed, streams.SPEED_NOISE)
        self._force_n = 0.0
        self.position_m = 0.0
        self.speed_mps = 0.0

    @property
    def position_01mm(self) -> int:
        """Position reported with the milestones."""
        return round(self.position_m * 1e4)

    def _stat(self) -> Telegram:
        read_m = self.position_m + self._task.noise_sigma_m * self._noise.standard_normal()
        return STAT(round(read_m * 1e4), life=self.next_life(STAT.PORT))

    def _truth(self) -> Telegram:
        return TRUTH(round(self.position_m * 1e5), round(self.speed_mps * 1e4), life=self.next_life(TRUTH.PORT))

    def act(self, telegram: Telegram) -> None:
        """Carry out a command; its life sign is new and its check variable correct."""
        assert isinstance(telegram, COMMAND)
        self._force_n = telegram.force_001n * _FORCE_LSB_N

    def advance(self) -> None:
        """Simulates one base tick."""
        task, step_s = self._task, self.tick_ns / 1e9
        self.speed_mps += (self._force_n - task.friction_n_per_mps * self.speed_mps) / self._mass_kg * step_s
        self.position_m += self.speed_mps * step_s
        self.tick += 1
        if not isfinite(self.position_m) or abs(self.position_m) > TRACK_M:
            raise PlantError(f"the cart has left its track at tick {self.tick}")
        if abs(self.position_m - task.target_m) < task.error_max_m:
            self.milestone("arrived", self.position_01mm, once=True)
