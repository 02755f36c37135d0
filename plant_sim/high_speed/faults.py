"""A high-speed train with faults: mutations of its dynamics, faults of its speed sensors, its traction and its brakes.

========== ==============================================================================================
gain       achieved share of the commanded acceleration, multiplied
lag        time constant of traction and brake, multiplied
delay      both delays longer
loop       ``safety_loop off``: all units apply their full brake, for good
========== ==============================================================================================

Faults of traction and brake of a unit (:mod:`railhil.faults.actuators`) act on its acceleration: ``slow`` divides its
lag by the factor, ``dead_time`` adds to the delay of this side. Faults of the sensor: :mod:`railhil.faults.sensors`.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from functools import partial
from math import fsum
from typing import Any, ClassVar

from railhil.bus.layout import CHECK_ERRONEOUS, Telegram
from railhil.faults.activity import Activity, MotionEvents
from railhil.faults.model import Fault
from railhil.plant_sim.faults.acceleration_side import AccelerationSide
from railhil.plant_sim.faults.injections import Injections, SafetyLoop
from railhil.plant_sim.faults.readings import FaultySensor, quantity_of
from railhil.plant_sim.high_speed.dynamics import Drive, UnitLimits, UnitMotion, drive
from railhil.plant_sim.high_speed.plant import HighSpeedPlant
from railhil.plant_sim.high_speed.train import STEP_S, PowerUnit, UnitData
from railhil.wire.high_speed import UnitCause, UnitLevel
from railhil.wire.power_units import SPEED_PER_MPS

#: Places of the mutations.
_MUTATIONS = ("gain", "lag", "delay")


class _Side(AccelerationSide):
    """Traction or brake of one unit, with its drive."""

    def __init__(self, activities: Iterable[Activity], sign: int) -> None:
        super().__init__(activities, sign)
        self.drive = Drive(1.0, 0.0, 0.0)

    def mutate(self, data: UnitData, limits: UnitLimits) -> float:
        """Take the faults that have begun or ended; returns the delay of this side in s."""
        is_traction = self.sign > 0
        self.update(limits.traction_mps2 if is_traction else limits.braking_mps2)
        lag_s, delay_s = data.lag_s, data.traction_delay_s if is_traction else data.braking_delay_s
        for factor in self.state.poles:
            lag_s /= factor
        self.drive = drive(data.gain, lag_s, STEP_S)
        return fsum((delay_s, *self.state.delays_s))


class FaultyUnit(PowerUnit):
    """A unit whose sides may have faults."""

    def __init__(
        self, data: UnitData, motion: UnitMotion, command_mps2: float, number: int, sides: tuple[_Side, _Side]
    ) -> None:
        self.number = number
        self.healthy = data
        self.sides = sides
        self._first_mps2 = command_mps2
        #: All commands of the run: faults delay them by any time.
        self._commands_mps2 = array("d")
        super().__init__(data, motion, command_mps2)

    def change(self, mutations: Sequence[Activity], limits: UnitLimits) -> None:
        """Take the faults that have begun or ended."""
        data = self.healthy
        for one in mutations:
            if not one.active:
                continue
            name = one.fault.place.name
            if name == "delay":
                extra_s = one.fault.parameter("extra_s")
                data = data._replace(
                    traction_delay_s=data.traction_delay_s + extra_s, braking_delay_s=data.braking_delay_s + extra_s
                )
            else:
                factor = one.fault.parameter("factor")
                data = (
                    data._replace(gain=data.gain * factor)
                    if name == "gain"
                    else data._replace(lag_s=data.lag_s * factor)
                )
        traction_s, braking_s = (side.mutate(data, limits) for side in self.sides)
        self.mutate(data._replace(traction_delay_s=traction_s, braking_delay_s=braking_s))

    def delayed_mps2(self, step: int, command_mps2: float) -> tuple[float, float]:
        self._commands_mps2.append(command_mps2)
        traction, braking = (self._sent_mps2(step - steps) for steps in (self.traction_steps, self.braking_steps))
        self.told_mps2 = braking if braking < 0.0 else 0.0
        return traction, braking

    def _sent_mps2(self, step: int) -> float:
        """The command that was sent at a step, also before the run."""
        return self._commands_mps2[step] if step >= 0 else self._first_mps2

    def acting_mps2(self, step: int, command_mps2: float) -> float:
        traction, braking = self.delayed_mps2(step, command_mps2)
        pull, push = self.sides
        acting = pull.acting_mps2(traction) + push.acting_mps2(braking)
        self.drive = push.drive if acting < 0.0 else pull.drive
        return acting


class FaultyHighSpeedPlant(HighSpeedPlant):
    """See :class:`railhil.plant_sim.faults.plants.FaultyPlant`.

    Faults begin and end at the instants of ticks, and change readings and motion from there on.

    :param faults: with their numbers in the run's list.
    """

    adopts: ClassVar[bool] = True

    def __init__(self, scenario: Any, seed: int, drawn: bool, rate: float, faults: Sequence[tuple[int, Fault]]) -> None:
        self.injections = injected = Injections(faults, seed, scenario.timing.base_tick_ns)
        super().__init__(scenario, seed, drawn, rate)
        self._motions = MotionEvents()
        self._loop = SafetyLoop(injected)
        train = self.train
        units = []
        for number, (unit, command_mps2) in enumerate(zip(train.units, train.commands_mps2, strict=True), 1):
            sides = _Side((), 1), _Side((), -1)
            for name, side in zip(("traction", "brake"), sides, strict=True):
                injected.attach(partial(side.take_at, injected, name, number))
            units.append(FaultyUnit(unit.data, unit.motion, command_mps2, number, sides))
        train.units = list(units)
        self._units = units
        for unit in units:
            unit.change((), train.limits)
        quantity = quantity_of(self._wire.feedback[0], "speed", SPEED_PER_MPS)
        tick_s = self.tick_ns / 1e9
        self._sensors = [FaultySensor(injected, quantity, tick_s, "speed", unit=unit.number) for unit in units]
        self._inject()

    def _inject(self) -> None:
        """Find the faults that are active at this instant."""
        train, injected = self.train, self.injections
        for event in self._motions.seen(train.speed_mps, train.accel_mps2, max(0.0, train.drive_mps2)):
            injected.happened(event)
        if injected.look(self.tick, train.position_m, train.speed_mps):
            for unit in self._units:
                unit.change(injected.at("train", *_MUTATIONS, unit=unit.number), train.limits)
            self._loop.look()
            for one in injected.at("train", *_MUTATIONS):
                (value,) = one.fault.values.values()
                injected.effect(one, one.active, "0" if one.fault.place.name == "delay" else "1", str(value))

    def _obey(self, unit: int, command_mps2: float | None) -> None:
        if self._loop.opened:
            # What is left of a brake that has not answered brakes as well: no watch releases it.
            command_mps2 = -self.train.limits.braking_mps2
            watch = self.watches[unit]
            if watch.cause is not UnitCause.BRAKE_NOT_ANSWERING:
                # The wire has no code for this cause; the log of the faults names it.
                watch.level, watch.cause = UnitLevel.SERVICE_BRAKE, UnitCause.NONE
        super()._obey(unit, command_mps2)

    def advance(self) -> None:
        super().advance()
        for unit in self._units:
            for side in unit.sides:
                side.note(self.injections)
        self._inject()

    def milestone(self, kind: str, position_01mm: int, *, once: bool = False, instant_01ms: int | None = None) -> None:
        super().milestone(kind, position_01mm, once=once, instant_01ms=instant_01ms)
        self.injections.happened(kind)

    def _feedback(self, unit: int) -> Telegram:
        made: Any = super()._feedback(unit)
        sensor = self._sensors[unit]
        if sensor:
            sensor.sample(made.speed)
            reading = sensor.sent()
            made.speed = reading.raw
            if not reading.valid:
                made.check = CHECK_ERRONEOUS
        return made  # type: ignore[no-any-return]
