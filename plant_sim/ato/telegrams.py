"""Makes the train's telegrams from the plant's state."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator
from itertools import cycle
from typing import Final

import numpy as np

from railhil.bus.clock import rate_to_10th, to_time_sync
from railhil.bus.codes import TimeState
from railhil.bus.layout import CHECK_ERRONEOUS, Telegram, flag
from railhil.bus.sdt import SAFE_DATA_VERSION, SafeSource, safe_tick_fields, source_identity
from railhil.bus.telegrams import TimeSync
from railhil.common.floats import rounded
from railhil.common.mypyc import mypyc_attr
from railhil.plant_sim.ato.plant import Plant
from railhil.scenarios.profiles import Profile, profile_value
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.target import Target
from railhil.wire.ato import BalisePassed, PltStat, SimTruth, SpeedSdt, TrkInfo, TrnPos, TrnSpeed, TrnWatch

#: 100 % of a BIPOLAR2.16 value.
_BIPOLAR_FULL: Final = 0x4000
#: The target speed is computed for this many ticks at once: numpy takes as long for one as for a hundred.
_TARGET_TICKS: Final = 1024
# Looking up a member of an enum costs as much as a call on CPython 3.11.
_RUNNING: Final = TimeState.RUNNING


def _highest(telegram: type[Telegram], field: str) -> int:
    """Largest raw number of a field."""
    return dict(telegram.signals())[field].raw_range[1]


@mypyc_attr(allow_interpreted_subclasses=True)
class TrainTelegrams:
    """Makes the plant's periodic telegrams; one life sign counter per port."""

    def __init__(self, scenario: Scenario, plant: Plant, rate: float) -> None:
        self._scenario = scenario
        self._plant = plant
        self._target = Target(scenario.target)
        #: The target's time begins at this tick.
        self._target_start_tick = 0
        self._target_half_mps: list[int] = []
        self._target_from_tick = 0
        #: Limits of the line; place (mm) and time (0.1 s) of the next stop.
        self._limits = scenario.line.speed_limit_mps
        self._aim = rounded(scenario.plan.distance_m * 1000), rounded(scenario.plan.running_time_s * 10)
        self._rate_10th = rate_to_10th(rate)
        self._speed_max = _highest(TrnSpeed, "speed_01mmps")
        # "That far or farther".
        self._distance_max = _highest(TrkInfo, "next_limit_distance_m")
        # Its transducer ends there: a train under a fault may be stronger.
        self._effort_max = _highest(TrnPos, "effort_bipolar2")
        # Life signs of the ports that the train publishes, each with its own modulus.
        self._lives: dict[str, Iterator[int]] = defaultdict(lambda: cycle(range(16)), {TrkInfo.PORT: cycle(range(4))})
        # The life signs of the most frequent ports.
        self._speed_life = self._lives[TrnSpeed.PORT]
        self._position_life = self._lives[TrnPos.PORT]
        self._truth_life = self._lives[SimTruth.PORT]
        self._balise: BalisePassed | None = None
        #: For each published port, the function that makes its telegram.
        self.makers: dict[str, Callable[[], Telegram | None]] = {
            TrnSpeed.PORT: self._speed,
            TimeSync.PORT: self._time,
            TrnPos.PORT: self._position,
            PltStat.PORT: self._status,
            TrkInfo.PORT: self._track,
            TrnWatch.PORT: self.watch,
            SimTruth.PORT: self._truth,
            BalisePassed.PORT: self._repeated_balise,
        }
        if scenario.safety.sdt:
            self._safe = SafeSource(source_identity(SpeedSdt.port().address), SAFE_DATA_VERSION)
            self.makers[SpeedSdt.PORT] = self._safe_speed

    def _speed(self) -> TrnSpeed:
        speed_01mmps = self._plant.speed_01mmps
        if speed_01mmps > self._speed_max:
            # A slipping axle can exceed the range: the reading stays at its end and is marked as erroneous.
            return TrnSpeed(self._speed_max, CHECK_ERRONEOUS, life=next(self._speed_life))
        return TrnSpeed(speed_01mmps, life=next(self._speed_life))

    def _safe_speed(self) -> SpeedSdt | None:
        plant = self._plant
        telegram = SpeedSdt(plant.speed_01mmps, odometer_mm=plant.odometer_mm, **safe_tick_fields(plant.tick))
        try:
            return SpeedSdt.decode(self._safe.secured(telegram.encode()))
        except OverflowError:
            # A slipping axle. This port has no check variable.
            return None

    def _time(self) -> TimeSync:
        return to_time_sync(
            self._plant.tick,
            self._scenario.timing.base_tick_ns,
            rate_10th=self._rate_10th,
            state=_RUNNING,
            life=next(self._lives[TimeSync.PORT]),
        )

    def _position(self) -> TrnPos:
        plant = self._plant
        return TrnPos(
            plant.odometer_mm,
            rounded(min(max(plant.effort_fraction * _BIPOLAR_FULL, -self._effort_max), self._effort_max)),
            rounded(plant.notch_acting / 16),
            life=next(self._position_life),
        )

    def _status(self) -> PltStat:
        status = self._plant.status
        return PltStat(
            power_on=flag(status.power_on),
            pantograph_up=flag(status.pantograph_up),
            main_breaker_closed=flag(status.main_breaker_closed),
            doors_closed_locked=flag(status.doors_closed_locked),
            parking_brake_released=flag(status.parking_brake_released),
            safety_loop_closed=flag(status.safety_loop_closed),
            traction_enabled=flag(status.traction_enabled),
            brake_available=flag(status.brake_available),
            line_voltage_half_percent=rounded(status.line_voltage_percent * 2),
            fault=status.fault,
            life=next(self._lives[PltStat.PORT]),
        )

    def _track(self) -> TrkInfo:
        limits, aim = self._limits, self._aim
        front_m = self._plant.position_01mm / 1e4
        here = _limit_under_train(limits, front_m, self._scenario.train.length_m)
        following = next(((at_m, limit) for at_m, limit in limits if at_m > front_m), None)
        next_at_m, next_limit = following or (front_m, here)
        return TrkInfo(
            target_mm=aim[0],
            target_time_ds=aim[1],
            speed_limit_4mmps=rounded(here * 250),
            next_limit_4mmps=rounded(next_limit * 250),
            next_limit_distance_m=min(max(rounded(next_at_m - front_m), 0), self._distance_max),
            grade_001permil=rounded(self._plant.grade_permil * 100),
            target_speed_half_mps=self._target_speed_half_mps(),
            life=next(self._lives[TrkInfo.PORT]),
        )

    def _target_speed_half_mps(self) -> int:
        tick = self._plant.tick
        if not 0 <= tick - self._target_from_tick < len(self._target_half_mps):
            ticks = np.arange(tick, tick + _TARGET_TICKS, dtype=np.int64) - self._target_start_tick
            speed_mps = self._target.speed_mps(ticks * self._scenario.timing.base_tick_ns / 1e9)
            self._target_half_mps = [max(rounded(2 * value), 0) for value in speed_mps.tolist()]
            self._target_from_tick = tick
        return self._target_half_mps[tick - self._target_from_tick]

    def _truth(self) -> SimTruth:
        plant = self._plant
        return SimTruth(
            plant.position_01mm,
            plant.true_speed_01mmps,
            life=next(self._truth_life),
            accel_01mmps2=rounded(plant.accel_mps2 * 1e4),
            traction_20n=rounded(plant.traction_n / 20),
            brake_20n=rounded(plant.brake_n / 20),
            grade_001permil=rounded(plant.grade_permil * 100),
        )

    def watch(self) -> TrnWatch:
        """State of the train's watch; sent when its level has changed, and on the port's period."""
        plant = self._plant
        return TrnWatch(
            plant.watch_level,
            plant.watch_cause,
            min(plant.command_age_ms, 0xFFFF),
            life=next(self._lives[TrnWatch.PORT]),
        )

    def balise(self, number: int, surveyed_m: float, odometer_mm: int) -> BalisePassed:
        """Telegram of a balise just passed; it is repeated on the port's period from now on."""
        self._balise = BalisePassed(
            number,
            round(surveyed_m * 1000),
            odometer_mm & 0xFFFF,
            life=next(self._lives[BalisePassed.PORT]),
        )
        return self._balise

    def _repeated_balise(self) -> BalisePassed | None:
        return self._balise


def _limit_under_train(limits: Profile, front_m: float, length_m: float) -> float:
    """Lowest limit under the train: a higher one applies only when the rear has passed its board."""
    here = profile_value(limits, front_m)
    rear = profile_value(limits, front_m - length_m)
    between = (limit for at_m, limit in limits if front_m - length_m < at_m <= front_m)
    return min(here, rear, *between)
