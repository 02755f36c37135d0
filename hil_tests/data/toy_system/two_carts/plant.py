"""Two carts on a spring, on the bus."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from math import isfinite
from typing import Any

from railhil.bus.layout import Telegram
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.timed_run import TimedPlant
from railhil.scenarios import streams
from two_carts.wire import COMMANDS, LAW_STAT, STATS, TRUTH

#: Simulation steps per tick.
_STEPS = 10
_FORCE_LSB_N = 0.01


class Carts(TimedPlant):
    """See railhil.plant_sim.any_plant.AnyPlant."""

    commands: Mapping[str, type[Telegram]] = {kind.PORT: kind for kind in COMMANDS}
    statuses = (LAW_STAT.PORT,)

    def __init__(self, scenario: Any, seed: int, drawn: bool, rate: float) -> None:
        stats = {kind.PORT: partial(self._stat, unit) for unit, kind in enumerate(STATS)}
        super().__init__(scenario, rate, {**stats, TRUTH.PORT: self._truth})
        self._task = scenario.task
        factors = (1.0, 1.0)
        if drawn:
            spread = self._task.mass_spread
            factors = 1 + spread * (2 * streams.generator(seed, streams.PERTURBATION).random(2) - 1)
        self._mass_kg = [float(mass * factor) for mass, factor in zip(self._task.mass_kg, factors, strict=True)]
        self.position_m, self.speed_mps, self._force_n = [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]
        self._step_s = self.tick_ns / 1e9 / _STEPS
        self._noise = streams.generator(seed, streams.SPEED_NOISE)

    @property
    def position_01mm(self) -> int:
        return round(self.position_m[0] * 1e4)

    def _stat(self, unit: int) -> Telegram:
        read_m = self.position_m[unit] + self._task.noise_sigma_m * self._noise.standard_normal()
        return STATS[unit](round(read_m * 1e4), life=self.next_life(STATS[unit].PORT))

    def _truth(self) -> Telegram:
        places = [round(at_m * 1e5) for at_m in self.position_m]
        speeds = [round(mps * 1e4) for mps in self.speed_mps]
        return TRUTH(*places, *speeds, life=self.next_life(TRUTH.PORT))

    def act(self, telegram: Telegram) -> None:
        unit = [kind.PORT for kind in COMMANDS].index(telegram.PORT)
        self._force_n[unit] = telegram.force_001n * _FORCE_LSB_N

    def advance(self) -> None:
        task = self._task
        for _ in range(_STEPS):
            pull_n = task.spring_n_per_m * (self.position_m[1] - self.position_m[0])
            pull_n += task.damping_n_per_mps * (self.speed_mps[1] - self.speed_mps[0])
            for unit, sign in ((0, 1), (1, -1)):
                accel = (self._force_n[unit] + sign * pull_n) / self._mass_kg[unit]
                self.speed_mps[unit] += accel * self._step_s
                self.position_m[unit] += self.speed_mps[unit] * self._step_s
        self.tick += 1
        if not isfinite(sum(self.position_m)) or max(map(abs, self.position_m)) > 100:
            raise PlantError(f"carts have left the track at tick {self.tick}")
        errors_m = [abs(at - to) for at, to in zip(self.position_m, task.target_m, strict=True)]
        if max(errors_m) < task.error_max_m:
            self.milestone("arrived", self.position_01mm, once=True)
