"""A train that stops at a platform, with faults: of its brake and its rail, its sensors, its traction and brake.

============ ============================================================================================
gain, lag    of the brake, multiplied
delay        longer
adhesion     ``low``: the rail allows a deceleration of coefficient * g
safety_loop  ``off``: the emergency brake, for good
============ ============================================================================================

Faults of traction and brake (:mod:`railhil.faults.actuators`) act on its acceleration: ``slow`` divides its lag by the
factor, ``dead_time`` delays commands. The emergency brake has no faults. Faults of the sensors:
:mod:`railhil.faults.sensors`, :mod:`railhil.plant_sim.faults.readings`; a balise without a valid value is not reported.
The speed sensor is sampled five times a tick, and a telegram in which one of these samples has no value is not valid.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import fsum
from typing import Any, ClassVar

from railhil.bus.layout import CHECK_ERRONEOUS, Telegram
from railhil.faults.activity import Activity, MotionEvents
from railhil.faults.model import Fault
from railhil.plant_sim.faults.acceleration_side import AccelerationSide
from railhil.plant_sim.faults.injections import Injections, SafetyLoop
from railhil.plant_sim.faults.readings import BaliseReport, FaultyReader, FaultySensor, quantity_of
from railhil.plant_sim.stop.brake import GRAVITY_MPS2
from railhil.plant_sim.stop.draws import RunDraw, TrainDraw
from railhil.plant_sim.stop.plant import StopPlant
from railhil.plant_sim.stop.train import Passed, StopTrain
from railhil.wire.stop import BrakeCause, BrakeLevel, Odo, SpeedRaw
from railhil.wire.stop_counts import MM, SAMPLE_S

#: Places of the mutations.
_MUTATIONS = ("gain", "lag", "delay", "adhesion")


class FaultyStopTrain(StopTrain):
    """A train whose parts may have faults."""

    def __init__(
        self,
        task: Any,
        train: TrainDraw,
        run: RunDraw,
        seed: int,
        run_number: int,
        reader: FaultyReader,
        sides: tuple[AccelerationSide, AccelerationSide],
    ) -> None:
        self._reader = reader
        self.sides = sides
        self._most_mps2 = task.brake.traction_max_mps2, task.brake.braking_max_mps2
        super().__init__(task, train, run, seed, run_number)
        self._healthy = self.gain, self.delay_s, self.course
        self._lag_s = self.course.lag_s

    def change(self, mutations: Sequence[Activity]) -> None:
        """Take the faults that have begun or ended."""
        self.gain, self.delay_s, self.course = self._healthy
        self._lag_s = self.course.lag_s
        for one in mutations:
            if not one.active:
                continue
            name = one.fault.place.name
            if name == "gain":
                self.gain *= one.fault.parameter("factor")
            elif name == "lag":
                self._lag_s *= one.fault.parameter("factor")
            elif name == "delay":
                self.delay_s += one.fault.parameter("extra_s")
            else:
                limit_mps2 = one.fault.parameter("coefficient") * GRAVITY_MPS2
                self.course = self.course._replace(adhesion_mps2=limit_mps2)
        for side, most_mps2 in zip(self.sides, self._most_mps2, strict=True):
            side.update(most_mps2)

    def command(self, accel_mps2: float, after_s: float = 0.0) -> None:
        super().command(accel_mps2, after_s + fsum(self.sides[accel_mps2 < 0.0].state.delays_s))

    def achieved_mps2(self) -> float:
        healthy = super().achieved_mps2()
        if self.emergency:
            self.course = self.course._replace(lag_s=self._lag_s)
            return healthy
        pull, push = self.sides
        does = pull.acting_mps2(healthy) + push.acting_mps2(healthy)
        factor = 1.0
        for pole in (push if does < 0.0 else pull).state.poles:
            factor /= pole
        self.course = self.course._replace(lag_s=self._lag_s * factor)
        return does

    def read_balise(self, passed: Passed) -> None:
        for report in self._reader.reported(BaliseReport(passed.balise, passed.odometer_m)):
            if report.valid:
                # By the distance that the wheels count, a balise that lies elsewhere is read there.
                distance_m = report.position_m + self._reader.shift_m(passed.balise)
                super().read_balise(Passed(report.number, max(0.0, distance_m)))
        self._reader.note_shift(passed.balise, passed.odometer_m)


class FaultyStopPlant(StopPlant):
    """See :class:`railhil.plant_sim.faults.plants.FaultyPlant`.

    Faults begin and end at the instants of ticks, and change readings and motion from there on.

    :param faults: with their numbers in the run's list.
    """

    train: FaultyStopTrain
    adopts: ClassVar[bool] = True

    def __init__(
        self,
        scenario: Any,
        seed: int,
        drawn: bool,
        rate: float,
        run_number: int,
        faults: Sequence[tuple[int, Fault]],
    ) -> None:
        self.injections = injected = Injections(faults, seed, scenario.timing.base_tick_ns)
        super().__init__(scenario, seed, drawn, rate, run_number)
        self._motions = MotionEvents()
        self._loop = SafetyLoop(injected)
        self._speed_sensor = FaultySensor(injected, quantity_of(SpeedRaw, "speed1", MM), SAMPLE_S, "speed")
        odometer = quantity_of(Odo, "odometer", MM)
        self._odometer = FaultySensor(injected, odometer, self.tick_ns / 1e9, "position")
        self._inject()

    def made_train(self, train: TrainDraw, run: RunDraw, seed: int, run_number: int) -> StopTrain:
        injected = self.injections
        sides = AccelerationSide((), 1), AccelerationSide((), -1)
        for name, side in zip(("traction", "brake"), sides, strict=True):
            injected.attach(partial(side.take_at, injected, name))
        return FaultyStopTrain(self._task, train, run, seed, run_number, FaultyReader(injected), sides)

    def _inject(self) -> None:
        """Find the faults that are active at this instant."""
        train, injected = self.train, self.injections
        motion = train.motion
        for event in self._motions.seen(motion.speed_mps, train.accel_mps2, max(0.0, motion.drive_mps2)):
            injected.happened(event)
        if injected.look(self.tick, motion.position_m, motion.speed_mps):
            train.change(injected.at("train", *_MUTATIONS))
            self._loop.look()
            if self._loop.opened and self.watch.level is not BrakeLevel.EMERGENCY:
                # The wire has no code for this cause; the log of the faults names it.
                self.watch.level, self.watch.cause = BrakeLevel.EMERGENCY, BrakeCause.NONE
            for one in injected.at("train", *_MUTATIONS):
                (value,) = one.fault.values.values()
                injected.effect(one, one.active, "0" if one.fault.place.name == "delay" else "1", str(value))

    def advance(self) -> None:
        super().advance()
        for side in self.train.sides:
            side.note(self.injections)
        self._inject()

    def milestone(self, kind: str, position_01mm: int, *, once: bool = False, instant_01ms: int | None = None) -> None:
        super().milestone(kind, position_01mm, once=once, instant_01ms=instant_01ms)
        self.injections.happened(kind)

    def _speed(self) -> Telegram:
        made: Any = super()._speed()
        sensor = self._speed_sensor
        if sensor:
            for number, raw in enumerate(self.train.samples, 1):
                sensor.sample(raw)
                reading = sensor.sent()
                setattr(made, f"speed{number}", reading.raw)
                if not reading.valid:
                    made.valid, made.check = 0, CHECK_ERRONEOUS
        return made  # type: ignore[no-any-return]

    def _odo(self) -> Telegram:
        made: Any = super()._odo()
        sensor = self._odometer
        if sensor:
            sensor.sample(made.odometer)
            reading = sensor.sent()
            made.odometer = reading.raw
            if not reading.valid:
                made.check = CHECK_ERRONEOUS
        return made  # type: ignore[no-any-return]
