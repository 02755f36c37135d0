"""A train that stops at a platform, with faults: of its brake and its rail, its sensors, its traction and brake.

============ ============================================================================================
gain, lag    of the brake, multiplied
delay        longer
adhesion     ``low``: the rail allows a deceleration of coefficient * g
safety_loop  ``off``: the emergency brake, for good
============ ============================================================================================

Words of traction and brake: ``weak``, ``scale``, ``off``: a share of its acceleration; ``stuck``: that of the fault's
first instant stays; ``full``: all that it has; ``slow``: its lag, divided by the factor; ``dead_time``: commands act
later. The emergency brake has no faults. Words of the sensors: :mod:`railhil.plant_sim.faults.readings`,
:mod:`railhil.plant_sim.faults.balises`; a balise without a valid value is not reported. The speed sensor is sampled
five times a tick, and a telegram in which one of these samples has no value is not valid.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from railhil.bus.injector.activity import Activity
from railhil.bus.layout import CHECK_ERRONEOUS, Telegram
from railhil.bus.stopping import MM, SAMPLE_S, BrakeCause, BrakeLevel, Odo, SpeedRaw
from railhil.faults.model import Fault
from railhil.plant_sim.faults.balises import FaultyReader, UnreadBalise
from railhil.plant_sim.faults.injections import Injections, MotionEvents, number_of
from railhil.plant_sim.faults.readings import FaultySensor, Quantity
from railhil.plant_sim.faults.safety_loop import SafetyLoop
from railhil.plant_sim.stop.brake import GRAVITY_MPS2
from railhil.plant_sim.stop.draws import RunDraw, TrainDraw
from railhil.plant_sim.stop.plant import StopPlant
from railhil.plant_sim.stop.train import Passed, StopTrain
from railhil.scenarios.model import Balise

#: A side whose acceleration differs by more than this from the healthy one shows its fault.
_NOTICED_MPS2 = 0.001
#: Places of the mutations.
_MUTATIONS = ("gain", "lag", "delay", "adhesion")


class _Side:
    """Traction (``sign`` 1) or brake (-1): share, acceleration instead of the healthy one, lag factor, dead time."""

    def __init__(self, sign: int, most_mps2: float) -> None:
        self.sign = sign
        self.faults: list[Activity] = []
        self.share, self.lag_factor, self.dead_s = 1.0, 1.0, 0.0
        self.instead_mps2: float | None = None
        #: The last acceleration without faults.
        self.healthy_mps2 = 0.0
        self._most_mps2 = most_mps2

    def change(self) -> None:
        """Look which faults are active."""
        stays, self.share, self.instead_mps2, self.lag_factor, self.dead_s = self.instead_mps2, 1.0, None, 1.0, 0.0
        for one in self.faults:
            if not one.active:
                continue
            what = one.fault.what
            if what in ("weak", "scale"):
                self.share *= number_of(one.fault, "share" if what == "weak" else "factor")
            elif what == "off":
                self.share = 0.0
            elif what == "full":
                self.instead_mps2 = self.sign * self._most_mps2
            elif what == "stuck":
                self.instead_mps2 = self.healthy_mps2 if stays is None else stays
            elif what == "slow":
                self.lag_factor /= number_of(one.fault, "factor")
            elif what == "dead_time":
                self.dead_s += number_of(one.fault, "delay_s")

    def does_mps2(self, healthy_mps2: float) -> float:
        """What this side makes of a target."""
        self.healthy_mps2 = healthy_mps2 if healthy_mps2 * self.sign > 0.0 else 0.0
        return self.healthy_mps2 * self.share if self.instead_mps2 is None else self.instead_mps2


class FaultyStopTrain(StopTrain):
    """A train whose parts may have faults."""

    def __init__(
        self, task: Any, train: TrainDraw, run: RunDraw, seed: int, run_number: int, reader: FaultyReader
    ) -> None:
        self._reader = reader
        brake = task.brake
        self.sides = (_Side(1, brake.traction_max_mps2), _Side(-1, brake.braking_max_mps2))
        super().__init__(task, train, run, seed, run_number)
        self._healthy = self.gain, self.delay_s, self.course
        self._lag_s = self.course.lag_s

    def change(self, mutations: Sequence[Activity]) -> None:
        """Faults have begun or ended."""
        self.gain, self.delay_s, self.course = self._healthy
        self._lag_s = self.course.lag_s
        for one in mutations:
            if not one.active:
                continue
            name = one.fault.place.name
            if name == "gain":
                self.gain *= number_of(one.fault, "factor")
            elif name == "lag":
                self._lag_s *= number_of(one.fault, "factor")
            elif name == "delay":
                self.delay_s += number_of(one.fault, "extra_s")
            else:
                limit_mps2 = number_of(one.fault, "coefficient") * GRAVITY_MPS2
                self.course = self.course._replace(adhesion_mps2=limit_mps2)
        for side in self.sides:
            side.change()

    def command(self, accel_mps2: float, after_s: float = 0.0) -> None:
        super().command(accel_mps2, after_s + self.sides[accel_mps2 < 0.0].dead_s)

    def achieved_mps2(self) -> float:
        healthy = super().achieved_mps2()
        if self.emergency:
            self.course = self.course._replace(lag_s=self._lag_s)
            return healthy
        pull, push = self.sides
        does = pull.does_mps2(healthy) + push.does_mps2(healthy)
        self.course = self.course._replace(lag_s=self._lag_s * (push if does < 0.0 else pull).lag_factor)
        return does

    def read_balise(self, passed: Passed) -> None:
        read = self._reader.reported(Balise(passed.balise, passed.odometer_m, passed.odometer_m))
        for report in read:
            if not isinstance(report, UnreadBalise):
                super().read_balise(Passed(report.number, max(0.0, report.surveyed_m)))


class FaultyStopPlant(StopPlant):
    """See :class:`railhil.plant_sim.faults.plants.FaultyPlant`.

    Faults begin and end at the instants of ticks, and change readings and motion from there on.

    :param faults: with their numbers in the run's list.
    """

    train: FaultyStopTrain

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
        for side, name in zip(self.train.sides, ("traction", "brake"), strict=True):
            side.faults = injected.at("actuator", name)
        self._speed_sensor = FaultySensor(injected, Quantity.of(SpeedRaw, "speed1", MM), SAMPLE_S, "speed")
        odometer = Quantity.of(Odo, "odometer", MM)
        self._odometer = FaultySensor(injected, odometer, self.tick_ns / 1e9, "position")
        self._inject()

    def made_train(self, train: TrainDraw, run: RunDraw, seed: int, run_number: int) -> StopTrain:
        return FaultyStopTrain(self._task, train, run, seed, run_number, FaultyReader(self.injections))

    def _inject(self) -> None:
        """Look which faults are active at this instant."""
        train, injected = self.train, self.injections
        motion = train.motion
        for event in self._motions.seen(motion.speed_mps, train.accel_mps2, max(0.0, motion.drive_mps2)):
            injected.happened(event)
        if injected.look(self.tick, motion.position_m, motion.speed_mps):
            train.change(injected.at("train", *_MUTATIONS))
            self._loop.look()
            if self._loop.opened and self.watch.level is not BrakeLevel.EMERGENCY:
                # The wire has no cause for it; the log of the faults has.
                self.watch.level, self.watch.cause = BrakeLevel.EMERGENCY, BrakeCause.NONE
            for one in injected.at("train", *_MUTATIONS):
                (value,) = one.fault.values.values()
                injected.effect(one, one.active, "0" if one.fault.place.name == "delay" else "1", str(value))

    def advance(self) -> None:
        super().advance()
        for side in self.train.sides:
            for one in side.faults:
                self._note(one, side)
        self._inject()

    def _note(self, one: Activity, side: _Side) -> None:
        """Whether a fault of a side changes what it does."""
        if one.fault.what in ("slow", "dead_time"):
            self.injections.effect(one, one.active, "1", str(*one.fault.values.values()))
            return
        healthy = side.healthy_mps2
        does = side.does_mps2(healthy)
        self.injections.effect(
            one, one.active and abs(does - healthy) > _NOTICED_MPS2, f"{healthy:.3f} m/s2", f"{does:.3f} m/s2"
        )

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
