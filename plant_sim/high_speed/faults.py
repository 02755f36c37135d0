"""A high-speed train with faults: mutations of its dynamics, faults of its speed sensors, its traction and its brakes.

========== ==============================================================================================
gain       achieved share of the commanded acceleration, multiplied
lag        time constant of traction and brake, multiplied
delay      both delays longer
loop       ``safety_loop off``: all units brake with all that they have, for good
========== ==============================================================================================

Words of traction and brake of a unit: ``weak``, ``scale``, ``off``: a share of its acceleration; ``stuck``: that of
the fault's first instant stays; ``full``: all that it has; ``slow``: its lag, divided by the factor; ``dead_time``: a
longer delay of this side. Words of the sensor: :mod:`railhil.plant_sim.faults.readings`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from railhil.bus.high_speed import SPEED_PER_MPS, UnitCause, UnitLevel
from railhil.bus.injector.activity import Activity
from railhil.bus.layout import CHECK_ERRONEOUS, Telegram
from railhil.faults.model import Fault
from railhil.plant_sim.faults.injections import Injections, MotionEvents, number_of
from railhil.plant_sim.faults.readings import FaultySensor, Quantity
from railhil.plant_sim.faults.safety_loop import SafetyLoop
from railhil.plant_sim.high_speed.dynamics import Drive, UnitLimits, UnitMotion, drive
from railhil.plant_sim.high_speed.plant import HighSpeedPlant
from railhil.plant_sim.high_speed.train import STEP_S, PowerUnit, UnitData

#: A side whose acceleration differs by more than this from the healthy one shows its fault.
_NOTICED_MPS2 = 0.001
#: Places of the mutations.
_MUTATIONS = ("gain", "lag", "delay")


class _Side:
    """Traction (``sign`` 1) or brake (-1) of one unit: share, acceleration instead of the commanded one, drive."""

    def __init__(self, sign: int) -> None:
        self.sign = sign
        self.faults: list[Activity] = []
        self.share = 1.0
        self.instead_mps2: float | None = None
        self.drive = Drive(1.0, 0.0, 0.0)
        #: The last acceleration without faults.
        self.healthy_mps2 = 0.0

    def change(self, data: UnitData, limits: UnitLimits) -> float:
        """Look which faults are active; returns the delay of this side."""
        stays, self.share, self.instead_mps2 = self.instead_mps2, 1.0, None
        lag_s = data.lag_s
        delay_s = data.traction_delay_s if self.sign > 0 else data.braking_delay_s
        for one in self.faults:
            if not one.active:
                continue
            what = one.fault.what
            if what in ("weak", "scale"):
                self.share *= number_of(one.fault, "share" if what == "weak" else "factor")
            elif what == "off":
                self.share = 0.0
            elif what == "full":
                self.instead_mps2 = limits.traction_mps2 if self.sign > 0 else -limits.braking_mps2
            elif what == "stuck":
                self.instead_mps2 = self.healthy_mps2 if stays is None else stays
            elif what == "slow":
                lag_s /= number_of(one.fault, "factor")
            elif what == "dead_time":
                delay_s += number_of(one.fault, "delay_s")
        self.drive = drive(data.gain, lag_s, STEP_S)
        return delay_s

    def acting_mps2(self, delayed_mps2: float) -> float:
        """What this side does when it is told something."""
        self.healthy_mps2 = delayed_mps2 if delayed_mps2 * self.sign > 0.0 else 0.0
        return self.healthy_mps2 * self.share if self.instead_mps2 is None else self.instead_mps2


class FaultyUnit(PowerUnit):
    """A unit whose sides may have faults."""

    def __init__(self, data: UnitData, motion: UnitMotion, command_mps2: float, number: int) -> None:
        self.number = number
        self.healthy = data
        self.sides = (_Side(1), _Side(-1))
        super().__init__(data, motion, command_mps2)

    def change(self, mutations: Sequence[Activity], limits: UnitLimits) -> None:
        """Faults have begun or ended."""
        data = self.healthy
        for one in mutations:
            if not one.active:
                continue
            name = one.fault.place.name
            if name == "delay":
                extra_s = number_of(one.fault, "extra_s")
                data = data._replace(
                    traction_delay_s=data.traction_delay_s + extra_s, braking_delay_s=data.braking_delay_s + extra_s
                )
            else:
                factor = number_of(one.fault, "factor")
                data = (
                    data._replace(gain=data.gain * factor)
                    if name == "gain"
                    else data._replace(lag_s=data.lag_s * factor)
                )
        traction_s, braking_s = (side.change(data, limits) for side in self.sides)
        self.mutate(data._replace(traction_delay_s=traction_s, braking_delay_s=braking_s))

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

    def __init__(self, scenario: Any, seed: int, drawn: bool, rate: float, faults: Sequence[tuple[int, Fault]]) -> None:
        self.injections = injected = Injections(faults, seed, scenario.timing.base_tick_ns)
        super().__init__(scenario, seed, drawn, rate)
        self._motions = MotionEvents()
        self._loop = SafetyLoop(injected)
        train = self.train
        units = [
            FaultyUnit(unit.data, unit.motion, command, number)
            for number, (unit, command) in enumerate(zip(train.units, train.commands_mps2, strict=True), 1)
        ]
        train.units = list(units)
        self._units = units
        for unit in units:
            for side, name in zip(unit.sides, ("traction", "brake"), strict=True):
                side.faults = injected.at("actuator", name, unit=unit.number)
            unit.change((), train.limits)
        quantity = Quantity.of(self._wire.feedback[0], "speed", SPEED_PER_MPS)
        tick_s = self.tick_ns / 1e9
        self._sensors = [FaultySensor(injected, quantity, tick_s, "speed", unit=unit.number) for unit in units]
        self._inject()

    def _inject(self) -> None:
        """Look which faults are active at this instant."""
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
        watch = self.watches[unit]
        if self._loop.opened and watch.cause is not UnitCause.BRAKE_NOT_ANSWERING:
            # The wire has no cause for it; the log of the faults has.
            watch.level, watch.cause = UnitLevel.SERVICE_BRAKE, UnitCause.NONE
            command_mps2 = -self.train.limits.braking_mps2
        super()._obey(unit, command_mps2)

    def advance(self) -> None:
        super().advance()
        for unit in self._units:
            for side in unit.sides:
                for one in side.faults:
                    self._note(one, side)
        self._inject()

    def _note(self, one: Activity, side: _Side) -> None:
        """Whether a fault of a side changes what it does."""
        if one.fault.what in ("slow", "dead_time"):
            self.injections.effect(one, one.active, "1", str(*one.fault.values.values()))
            return
        healthy = side.healthy_mps2
        does = side.acting_mps2(healthy)
        self.injections.effect(
            one, one.active and abs(does - healthy) > _NOTICED_MPS2, f"{healthy:.3f} m/s2", f"{does:.3f} m/s2"
        )

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
