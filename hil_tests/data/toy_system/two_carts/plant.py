"""Two carts on a spring, on the bus."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any

from railhil.bus.clock import rate_to_10th, to_time_sync
from railhil.bus.layout import CHECK_CORRECT, Telegram
from railhil.bus.telegrams import TimeState, TimeSync
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.timed_run import Milestone, TimedEnd
from railhil.scenarios import streams
from two_carts.wire import COMMANDS, LAW_STAT, STATS, TRUTH

#: Steps of the simulation in a tick.
_STEPS = 10
_FORCE_LSB_N = 0.01


class Carts:
    """See railhil.plant_sim.any_plant.AnyPlant."""

    commands: Mapping[str, type[Telegram]] = {kind.PORT: kind for kind in COMMANDS}
    statuses = (LAW_STAT.PORT,)

    def __init__(self, scenario: Any, seed: int, drawn: bool, rate: float) -> None:
        self._task, timing = scenario.task, scenario.timing
        self.tick = 0
        factors = (1.0, 1.0)
        if drawn:
            spread = self._task.mass_spread
            factors = 1 + spread * (2 * streams.generator(seed, streams.PERTURBATION).random(2) - 1)
        self._mass_kg = [float(mass * factor) for mass, factor in zip(self._task.mass_kg, factors, strict=True)]
        self.position_m, self.speed_mps, self._force_n = [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]
        self.refused = {"check_variable": 0}
        self._tick_ns, self._step_s = timing.base_tick_ns, timing.base_tick_ns / 1e9 / _STEPS
        self._noise = streams.generator(seed, streams.SPEED_NOISE)
        self._life: dict[str, int] = {}
        self._events: list[Milestone] = []
        self._arrived = False
        rate_10th = rate_to_10th(rate)
        self.ending = TimedEnd(self._task.duration_s, self._tick_ns)
        self.makers: dict[str, Callable[[], Telegram | None]] = {
            STATS[0].PORT: lambda: self._stat(0),
            STATS[1].PORT: lambda: self._stat(1),
            TRUTH.PORT: self._truth,
            TimeSync.PORT: lambda: to_time_sync(
                self.tick, self._tick_ns, rate_10th=rate_10th, state=TimeState.RUNNING, life=self._next(TimeSync.PORT)
            ),
        }

    @property
    def position_01mm(self) -> int:
        return round(self.position_m[0] * 1e4)

    def _next(self, port: str) -> int:
        self._life[port] = life = (self._life.get(port, -1) + 1) & 0xF
        return life

    def _stat(self, unit: int) -> Telegram:
        read_m = self.position_m[unit] + self._task.noise_sigma_m * self._noise.standard_normal()
        return STATS[unit](round(read_m * 1e4), life=self._next(STATS[unit].PORT))

    def _truth(self) -> Telegram:
        places = [round(at_m * 1e5) for at_m in self.position_m]
        speeds = [round(mps * 1e4) for mps in self.speed_mps]
        return TRUTH(*places, *speeds, life=self._next(TRUTH.PORT))

    def take(self, telegram: Telegram) -> None:
        unit = [kind.PORT for kind in COMMANDS].index(telegram.PORT)
        if telegram.check != CHECK_CORRECT:
            self.refused["check_variable"] += 1
            return
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
        if not self._arrived and max(errors_m) < task.error_max_m:
            self._arrived = True
            self._events.append(Milestone("arrived", self.tick * self._tick_ns // 100_000, self.position_01mm))

    def drain_events(self) -> list[Milestone]:
        events, self._events = self._events, []
        return events

    def telegram_of(self, event: Milestone) -> None:
        return None

    def is_abandoned(self, command_age_ns: int) -> bool:
        return command_age_ns > 1_000_000_000
