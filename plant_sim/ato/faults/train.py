"""The train of the system ``ato`` with faults of its sensors, actuators and equipment."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace
from math import nan
from typing import Any, ClassVar

from railhil.bus.layout import CHECK_ERRONEOUS, Telegram
from railhil.faults.activity import MotionEvents
from railhil.faults.capability import MISMATCHES
from railhil.faults.model import Fault
from railhil.plant_sim.ato import force_tables
from railhil.plant_sim.ato.faults.equipment import FaultyEquipment
from railhil.plant_sim.ato.faults.forces import Demand, FaultyForces, FeltChecks
from railhil.plant_sim.ato.faults.mismatch import Mismatch
from railhil.plant_sim.ato.forces import TrainConstants
from railhil.plant_sim.ato.plant import EventKind
from railhil.plant_sim.ato.train import TrainOnBus
from railhil.plant_sim.faults.injections import Injections
from railhil.plant_sim.faults.readings import BaliseReport, FaultyReader, FaultySensor, quantity_of
from railhil.systems.ato.scenario.model import Balise, Scenario
from railhil.systems.ato.scenario.perturb import find_actual
from railhil.wire.ato import BalisePassed, CtlMode, NotchCmd, SpeedSdt, TrnPos, TrnSpeed, WatchLevel

#: Modes of the controller as events.
_MODES = {int(mode): mode.name.lower() for mode in CtlMode}


class UnreadBalise(Balise):
    """A balise of which the reader has only the number: its telegram's check variable is erroneous."""


class FaultyTrain(TrainOnBus):
    """A train with faults (:class:`railhil.plant_sim.faults.plants.FaultyPlant`).

    Faults begin and end at the instants of ticks, and change readings and motion from there on.
    Several faults act in the order of their numbers.

    A plant that is made of another train has its own :meth:`_assemble`, ``OWN_PLACES`` and :meth:`_read_balise`.

    :cvar OWN_PLACES: interlocks whose faults it takes by itself.
    :param faults: of the levels in :data:`railhil.plant_sim.faults.plants.LEVELS`, with their numbers.
    """

    OWN_PLACES: ClassVar[tuple[str, ...]] = ()
    adopts: ClassVar[bool] = True

    def __init__(
        self, scenario: Scenario, seed: int, drawn: bool, rate: float, faults: Sequence[tuple[int, Fault]]
    ) -> None:
        tick_ns = scenario.timing.base_tick_ns
        tick_s = tick_ns * 1e-9
        self.injections = faulty = Injections(faults, seed, tick_ns, scenario.noise)
        faulty.look(0, 0.0, 0.0)
        self._equipment = FaultyEquipment(faulty, self.OWN_PLACES)
        self._reader = FaultyReader(faulty)
        self._speed_sensor = FaultySensor(faulty, quantity_of(TrnSpeed, "speed_01mmps", 1e4), tick_s, "speed")
        self._position_sensor = FaultySensor(faulty, quantity_of(TrnPos, "odometer_mm", 1e3), tick_s, "position")
        self._forces = FaultyForces(faulty, tick_s)
        faulty.attach(self._take)
        self._extra_n = 0.0
        self._shifts_m: dict[int, float] = {}
        self._mode: int = CtlMode.INITIALISING
        self._applied_mismatch = self._mismatch()
        self._assemble(scenario, seed, drawn, rate)
        self._actual_train = self._train
        self._base = self._constants
        self._own_checks = FeltChecks(self._applied_mismatch.applied(self._healthy), self._constants, self._forces)
        self._changed = True
        self._equipment.change(self.status)
        self._read()
        self._motions = MotionEvents()
        for telegram, sensor in ((TrnSpeed, self._speed_sensor), (TrnPos, self._position_sensor)):
            self.makers[telegram.PORT] = _sent(self.makers[telegram.PORT], sensor)
        if SpeedSdt.PORT in self.makers:
            self.makers[SpeedSdt.PORT] = self._safe_reading(self.makers[SpeedSdt.PORT])

    def _assemble(self, scenario: Scenario, seed: int, drawn: bool, rate: float) -> None:
        """Make the train, with the mismatch from the start on."""
        # As in the plant without faults; the mismatch of a fault is applied to the drawn scenario.
        self._healthy = find_actual(scenario, seed, drawn)
        super().__init__(self._applied_mismatch.applied(self._healthy), seed, False, rate)

    def _take(self) -> None:
        faulty = self.injections
        self._models = faulty.at("train", "model")
        self._mismatches = [one for one in faulty.at("train") if (one.fault.place.name, one.fault.what) in MISMATCHES]

    # -- when faults begin and end ------------------------------------------------------------------------------------

    def _mismatch(self) -> Mismatch:
        return Mismatch.of(one.fault for one in self._mismatches if one.active)

    def _change(self) -> None:
        """Take the faults that have begun or ended, for the train and its forces from this tick on."""
        self._changed = False
        mismatch = self._mismatch()
        if mismatch != self._applied_mismatch:
            self._applied_mismatch = mismatch
            self._take_mismatch()
        for one in self._mismatches:
            (value,) = one.fault.values.values()
            self.injections.effect(one, one.active, "0" if one.fault.what == "offset" else "1", str(value))
        self._motion = self._forces.change(self._actual_train, self._motion, self._applied_n)
        self._shift_balises()

    def _take_mismatch(self) -> None:
        """Take train and line with their present mismatch."""
        actual = self._applied_mismatch.applied(self._healthy)
        self._actual_train = actual.train
        self._base = force_tables.train_constants(actual.train)
        self._grades = force_tables.grade_table(actual.line.grade_permil, actual.train.length_m)

    def _shift_balises(self) -> None:
        """Move the balises ahead that lie elsewhere; one that is moved behind the front is not read."""
        before, after = self._shifts_m, {one.number: self._reader.shift_m(one.number) for one in self._balises}
        if after == before or not (any(after.values()) or any(before.values())):
            return
        self._shifts_m = after
        moved = [_moved(one, after[one.number] - before.get(one.number, 0.0)) for one in self._balises]
        ahead = [one for one in moved if one.true_m > self._motion.position_m]
        self._balises = deque(sorted(ahead, key=lambda one: (one.true_m, one.number)))

    # -- time ---------------------------------------------------------------------------------------------------------

    def advance(self) -> None:
        """Simulate one base tick, then find the faults that are active at its end."""
        if self._changed:
            self._change()
        for one in self._models:
            if one.active:
                self.injections.effect(one, True, "a number", "nan")
                self._motion = self._motion._replace(position_m=nan)
        super().advance()
        self._forces.moved(self._motion, self._acting_code)
        motion = self._motion
        for event in self._motions.seen(motion.speed_mps, self.accel_mps2, self.traction_n):
            self.injections.happened(event)
        if self.injections.look(self.tick, motion.position_m, motion.speed_mps):
            # The readings of this instant still show the forces before it, and the status after it.
            self._changed = True
            self._equipment.change(self.status)
        self._read()

    def _protect(self) -> None:
        """The forces that watch and interlocks allow, changed by the faults."""
        super()._protect()
        demand = Demand(self._acting_code, self._motion.speed_mps, self.status.traction_enabled, self.is_emergency)
        self._constants, self._window, self._extra_n = self._forces.allowed(
            self._healthy_constants, self._window, demand
        )

    @property
    def is_emergency(self) -> bool:
        """Whether the emergency brake is applied."""
        return self.watch_level is WatchLevel.EMERGENCY

    @property
    def _healthy_constants(self) -> TrainConstants:
        """The constants of this tick without faults of traction, brake and adhesion."""
        return self._base

    def _move(self, from_tick: float, ticks: float) -> None:
        """Simulate a tick or a part of it with the force per notch and the pole of the acting side."""
        self._train, self._full_lag = self._forces.mover(self.notch_acting, self._motion.actuator_n)
        if self._constants.pole_per_s != self._train.actuator_pole_per_s:
            self._constants = self._constants._replace(pole_per_s=self._train.actuator_pole_per_s)
        super()._move(from_tick, ticks)

    # -- readings -----------------------------------------------------------------------------------------------------

    def _read(self) -> None:
        """Sample the sensors that have faults."""
        if self._speed_sensor:
            self._speed_sensor.sample(self._axle_speed_01mmps)
        if self._position_sensor:
            self._position_sensor.sample(self._axle_odometer_mm)

    def _safe_reading(self, make: Callable[[], Telegram | None]) -> Callable[[], Telegram | None]:
        """A maker of SPEED_SDT. The port has no check variable, so it is not sent without valid readings."""
        sensors = self._speed_sensor, self._position_sensor
        return lambda: make() if all(sensor.reading.valid for sensor in sensors) else None

    @property
    def _axle_speed_01mmps(self) -> int:
        return self._sensors.speed_01mmps(max(0.0, self._motion.speed_mps + self._forces.axle.slip_mps), self.tick)

    @property
    def _axle_odometer_mm(self) -> int:
        return self._sensors.odometer_mm(self._motion.position_m + self._forces.axle.slip_m)

    @property
    def speed_01mmps(self) -> int:
        """Speed measured by the axle sensor, in 0.1 mm/s."""
        return self._speed_sensor.reading.raw if self._speed_sensor else self._axle_speed_01mmps

    @property
    def odometer_mm(self) -> int:
        """Odometer in mm since the start."""
        return self._position_sensor.reading.raw if self._position_sensor else self._axle_odometer_mm

    @property
    def notch_acting(self) -> int:
        """Notch acting on the actuators now, in 1/256."""
        code = self._forces.acting(self._acting_code)
        return code if self._window.traction else min(code, 0)

    @property
    def _applied_n(self) -> float:
        return super()._applied_n + self._extra_n

    def _pass_balise(self, balise: Balise, after_s: float) -> None:
        odometer_mm = (
            self._sensors.odometer_between_mm(balise.true_m + self._forces.axle.slip_m) + self._position_sensor.error
        )
        self._reader.note_shift(balise.number, balise.true_m)
        for report in self._reader.reported(BaliseReport(balise.number, balise.surveyed_m)):
            read = Balise if report.valid else UnreadBalise
            self._read_balise(read(report.number, report.position_m, balise.true_m), after_s, odometer_mm)

    def _read_balise(self, balise: Balise, after_s: float, odometer_mm: int) -> None:
        """Note a balise as the reader reports it."""
        self._event("balise", after_s, balise.true_m, balise, odometer_mm)

    # -- commands and events ------------------------------------------------------------------------------------------

    def take(self, telegram: Telegram) -> None:
        """Take a command; the controller's level is an event for faults that wait for it."""
        if isinstance(telegram, NotchCmd) and telegram.mode != self._mode:
            self._mode = telegram.mode
            self.injections.happened(_MODES.get(telegram.mode, ""))
        super().take(telegram)

    def _event(self, kind: EventKind, *given: Any) -> None:
        super()._event(kind, *given)
        if kind == "watch":
            self.injections.happened(self.watch_level.name.lower())
        elif kind != "balise":
            self.injections.happened(kind)

    def telegram_of(self, event: Any) -> Telegram | None:
        """The telegram of an event. A balise telegram without a valid value is marked as erroneous."""
        telegram = super().telegram_of(event)
        if isinstance(telegram, BalisePassed) and isinstance(event.balise, UnreadBalise):
            telegram.check = CHECK_ERRONEOUS
        return telegram


def _moved(balise: Balise, by_m: float) -> Balise:
    """A balise elsewhere; marks of other kinds stay."""
    return replace(balise, true_m=balise.true_m + by_m) if by_m and type(balise) is Balise else balise


def _sent(make: Callable[[], Telegram | None], sensor: FaultySensor) -> Callable[[], Telegram | None]:
    """A maker of a telegram that carries the sensor's reading: an invalid one has an erroneous check variable."""

    def made() -> Telegram | None:
        reading = sensor.sent()
        telegram = make()
        if not reading.valid:
            telegram.check = CHECK_ERRONEOUS  # type: ignore[union-attr]
        return telegram

    return made
