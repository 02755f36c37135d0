"""The train of the system ``stop`` on the bus, and the truth for the bench."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from railhil.bus.codes import Event
from railhil.bus.layout import CHECK_CORRECT, CHECK_ERRONEOUS, Telegram
from railhil.common.errors import InputError
from railhil.plant_sim.any_plant import BRAKING_MAX_NS, PlantError
from railhil.plant_sim.stop.draws import RunDraw, TrainDraw, drawn_run, drawn_train
from railhil.plant_sim.stop.train import SPEED_RAW_MAX, StopTrain
from railhil.plant_sim.stop.watch import StopWatch
from railhil.plant_sim.timed_run import TimedEnd, TimedPlant
from railhil.wire.stop import (
    AtoState,
    BrakeCommand,
    BrakeLevel,
    BrakeStatus,
    IlcStatus,
    Odo,
    SpeedRaw,
    StopReport,
    TrainState,
    TrueData,
    Truth,
)
from railhil.wire.stop_counts import CONTRACT, MM, START_PER_S, TRUE_PER_UNIT

TICK_NS = 16_000_000
#: The doors open this long after the standstill.
DOORS_NS = 1_000_000_000
#: Readings stay at the end of their range, and the telegram is then marked as erroneous.
ODO_MAX = CONTRACT.port(Odo.PORT).signal("OdoDistance").raw_range[1]
_WHEEL_PER_UNIT = 1e6


class StopPlant(TimedPlant):
    """See :class:`railhil.plant_sim.any_plant.AnyPlant`.

    The train has a watch (:class:`railhil.plant_sim.stop.watch.StopWatch`). A train whose controller is lost brakes
    by itself until it stands.

    :param run_number: of the run in its sequence, from 1.
    :raises InputError: the scenario has another base tick than 16 ms.
    """

    def __init__(self, scenario: Any, seed: int, drawn: bool, rate: float, run_number: int) -> None:
        task = scenario.task
        self._task = task
        self._run_number = run_number
        makers = {
            BrakeStatus.PORT: self._brake_status,
            SpeedRaw.PORT: self._speed,
            Odo.PORT: self._odo,
            TrainState.PORT: self._state,
            StopReport.PORT: self._report,
            Truth.PORT: self._truth,
            TrueData.PORT: self._data,
        }
        super().__init__(scenario, rate, makers)
        if self.tick_ns != TICK_NS:
            # The samples of the speed are part of the telegram's layout.
            raise InputError(scenario.name, "timing.base_tick_ms", self.tick_ns / 1e6, f"{TICK_NS / 1e6:g}")
        train = drawn_train(task, seed)
        self.train = self.made_train(train, drawn_run(task, train, seed, run_number), seed, run_number)
        period_ns = scenario.timing.port_period_ns.get(BrakeCommand.PORT, CONTRACT.port(BrakeCommand.PORT).period_ns)
        self.watch = StopWatch(self.tick_ns, period_ns, task.service_braking_mps2, task.brake.lag_s)
        self.ending = _StopEnd(task.duration_s, task.after_stop_s, self.tick_ns, self.train)
        self._stop_tick: int | None = None
        self._samples = 0

    def made_train(self, train: TrainDraw, run: RunDraw, seed: int, run_number: int) -> StopTrain:
        """The train of the run."""
        return StopTrain(self._task, train, run, seed, run_number)

    @property
    def commands(self) -> Mapping[str, type[Telegram]]:
        return {BrakeCommand.PORT: BrakeCommand}

    @property
    def statuses(self) -> tuple[str, ...]:
        return AtoState.PORT, IlcStatus.PORT

    @property
    def position_01mm(self) -> int:
        return round(self.train.motion.position_m * 1e4)

    # -- telegrams ------------------------------------------------------------------------------------------------

    def _brake_status(self) -> Telegram:
        return BrakeStatus(self.watch.level, self.watch.cause, life=self.next_life(BrakeStatus.PORT))

    def _speed(self) -> Telegram:
        train, count = self.train, self._samples
        self._samples = (count + 1) & 0xFFFF
        slide = int(train.slides and train.run.slide_seen)
        first, second, third, fourth, last = train.samples
        check = CHECK_CORRECT if max(train.samples) < SPEED_RAW_MAX else CHECK_ERRONEOUS
        return SpeedRaw(first, second, third, fourth, last, count, 1, slide, check, self.next_life(SpeedRaw.PORT))

    def _odo(self) -> Telegram:
        passed = self.train.passed
        odometer, at_balise = (
            min(max(int(metres * MM), 0), ODO_MAX) for metres in (self.train.odometer_m, passed.odometer_m)
        )
        check = CHECK_CORRECT if odometer < ODO_MAX else CHECK_ERRONEOUS
        return Odo(odometer, passed.balise, at_balise, check, self.next_life(Odo.PORT))

    def _state(self) -> Telegram:
        stop_tick = self._stop_tick
        doors = stop_tick is not None and (self.tick - stop_tick) * self.tick_ns >= DOORS_NS
        run = self.train.run
        return TrainState(
            round(run.load_percent),
            int(run.wet),
            int(self.train.motion.speed_mps == 0.0),
            int(doors),
            self._run_number,
            life=self.next_life(TrainState.PORT),
        )

    def _report(self) -> Telegram:
        life = self.next_life(StopReport.PORT)
        if self._stop_tick is None:
            return StopReport(0, 0, life=life)
        error_m = self.train.motion.position_m - self._task.stop_m + self.train.run.mark_error_m
        return StopReport(self._run_number, round(error_m * MM), life=life)

    def _truth(self) -> Telegram:
        train, motion = self.train, self.train.motion
        speed, accel, drive = (
            round(value * TRUE_PER_UNIT) for value in (motion.speed_mps, train.accel_mps2, motion.drive_mps2)
        )
        return Truth(self.position_01mm, speed, int(train.slides), accel, drive, life=self.next_life(Truth.PORT))

    def _data(self) -> Telegram:
        train, run = self.train, self.train.run
        gain, delay, lag = (round(value * TRUE_PER_UNIT) for value in (train.gain, train.delay_s, train.course.lag_s))
        return TrueData(
            gain,
            delay,
            lag,
            round(train.wheel * _WHEEL_PER_UNIT),
            self._run_number,
            round(run.start_mps * MM),
            round(train.course.adhesion_mps2 * MM),
            life=self.next_life(TrueData.PORT),
        )

    # -- commands and time ----------------------------------------------------------------------------------------

    def act(self, telegram: Any) -> None:
        accel_mps2 = self.watch.command(self.tick, telegram.accel / MM, bool(telegram.valid))
        if accel_mps2 is not None:
            self._obey(accel_mps2, telegram.start / START_PER_S)

    def _obey(self, accel_mps2: float, after_s: float = 0.0) -> None:
        brake = self._task.brake
        lowest, highest = -max(brake.braking_max_mps2, self._task.service_braking_mps2), brake.traction_max_mps2
        accel_mps2 = min(max(accel_mps2, lowest), highest)
        self.train.command(accel_mps2, after_s)

    def advance(self) -> None:
        train = self.train
        stood = train.motion.speed_mps == 0.0
        own = self.watch.look(self.tick, train.told_mps2(), train.motion.drive_mps2, stood)
        if own is not None:
            self._obey(own)
        train.emergency = self.watch.level is BrakeLevel.EMERGENCY
        slid = train.slides
        train.advance()
        self.tick += 1
        if not isfinite(train.motion.speed_mps):
            raise PlantError(f"speed is not finite at tick {self.tick}")
        now_s = self.tick * self.tick_ns / 1e9
        if train.slides and not slid:
            self._happened("slide_begun", now_s, once=True)
        stands = train.motion.speed_mps == 0.0
        if stood and not stands:
            self._stop_tick = None
            self._happened("departed", now_s, once=True)
        elif stands and not stood and train.stopped_s is not None:
            self._stop_tick = self.tick
            self._happened("stopped", train.stopped_s, once=True)

    def _happened(self, kind: str, instant_s: float, *, once: bool) -> None:
        self.milestone(kind, self.position_01mm, once=once, instant_01ms=round(instant_s * 1e4))


class _StopEnd(TimedEnd):
    """The run ends some time after the standstill, at the latest after its duration."""

    def __init__(self, duration_s: float, after_stop_s: float, tick_ns: int, train: StopTrain) -> None:
        super().__init__(duration_s, tick_ns)
        self._after_ticks = round(after_stop_s * 1e9 / tick_ns)
        self._braking_ticks = BRAKING_MAX_NS // tick_ns
        self._has_stopped = False
        self._train = train

    def happened(self, kind: str, tick: int) -> None:
        """Note a stop before this tick."""
        if kind == "stopped" and not self._has_stopped:
            self._has_stopped, self.due_tick = True, tick + self._after_ticks

    def reached(self, tick: int, controller_lost: bool) -> Event | None:
        """The event that ends the run at this tick, None if the run continues."""
        if self._has_stopped:
            return Event.ENDED_COMPLETE if tick >= self.due_tick else None
        brakes = controller_lost and self._train.motion.speed_mps > 0.0 and tick < self.due_tick + self._braking_ticks
        return None if tick < self.due_tick or brakes else Event.ENDED_NOT_STOPPED
