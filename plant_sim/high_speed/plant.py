"""A high-speed train on the bus: its units, the wayside, and the truth for the bench."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from math import isfinite
from typing import Any

from railhil.bus.codes import Event
from railhil.bus.layout import CHECK_CORRECT, CHECK_ERRONEOUS, Telegram
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.brake_watch import STALE_PERIODS
from railhil.plant_sim.high_speed.dynamics import available_of
from railhil.plant_sim.high_speed.train import SPEED_RAW_MAX, HighSpeedTrain, Wayside
from railhil.plant_sim.high_speed.watch import UnitWatch
from railhil.plant_sim.timed_run import TimedEnd, TimedPlant
from railhil.wire.high_speed import UnitLevel
from railhil.wire.power_units import ACCEL_PER_MPS2, TRUE_PER_UNIT, wire

#: The train has arrived when it stands and the target is below this speed.
ARRIVED_MPS = 0.5
_MM, _CM = 1000.0, 100.0
_GAP_MAX_MM = 0x7F


class HighSpeedPlant(TimedPlant):
    """See :class:`railhil.plant_sim.any_plant.AnyPlant`.

    Each unit has a watch (:class:`railhil.plant_sim.high_speed.watch.UnitWatch`). A train whose controller is lost goes
    on until it stands, or until the run is over.
    """

    def __init__(self, scenario: Any, seed: int, drawn: bool, rate: float) -> None:
        task = scenario.task
        self._task = task
        self._wire = contract = wire(len(task.unit))
        numbers = range(len(task.unit))
        makers: dict[str, Callable[[], Telegram]] = {
            contract.feedback[unit].PORT: partial(self._feedback, unit) for unit in numbers
        }
        makers |= {contract.forces[unit].PORT: partial(self._force, unit) for unit in numbers}
        makers |= {
            contract.reference.PORT: self._reference,
            contract.event.PORT: self._event,
            contract.place.PORT: self._place,
            contract.truth.PORT: self._truth,
            contract.mutation.PORT: self._mutation,
        }
        super().__init__(scenario, rate, makers)
        tick_s = self.tick_ns / 1e9
        self.train = HighSpeedTrain(task, seed, tick_s)
        self.wayside = Wayside(task, tick_s)
        self._commands = {kind.PORT: kind for kind in contract.commands}
        self._unit_of = {kind.PORT: unit for unit, kind in enumerate(contract.commands)}
        periods_ns = {port.name: port.period_ns for port in contract.contract.ports} | dict(
            scenario.timing.port_period_ns
        )
        alone = (UnitLevel.TRACTION_CUT, 0.0)
        if task.stale_command == "brake":
            alone = (UnitLevel.SERVICE_BRAKE, -task.stale_braking_mps2)
        self.watches = [
            UnitWatch(STALE_PERIODS * periods_ns[kind.PORT] // self.tick_ns, alone, tick_s, unit.lag_s)
            for kind, unit in zip(contract.commands, task.unit, strict=True)
        ]
        self.ending = _HighSpeedEnd(task.duration_s, self.tick_ns, self.train)
        self._samples = 0
        self._has_moved = False
        self._look()

    @property
    def commands(self) -> Mapping[str, type[Telegram]]:
        return self._commands

    @property
    def statuses(self) -> tuple[str, ...]:
        return (self._wire.status.PORT,)

    @property
    def position_01mm(self) -> int:
        return round(self.train.position_m * 1e4)

    # -- telegrams ------------------------------------------------------------------------------------------------

    def _feedback(self, unit: int) -> Telegram:
        kind = self._wire.feedback[unit]
        speed = self.train.read_speed_raw(unit)
        # A reading at the end of its range is marked as erroneous.
        return kind(speed, CHECK_CORRECT if speed < SPEED_RAW_MAX else CHECK_ERRONEOUS, self.next_life(kind.PORT))

    def _force(self, unit: int) -> Telegram:
        kind, motion = self._wire.forces[unit], self.train.units[unit].motion
        available = available_of(self.train.limits, motion.speed_mps)
        coupler = gap = 0
        if unit < len(self.train.couplers_n):
            coupler = round(self.train.couplers_n[unit] / 100.0)
            rear = self.train.units[unit + 1].motion
            # Units without couplers drift apart, and the record is limited to its range.
            gap = min(max(round((motion.position_m - rear.position_m) * _MM), -_GAP_MAX_MM), _GAP_MAX_MM)
        return kind(
            round(motion.drive_mps2 * ACCEL_PER_MPS2),
            coupler,
            gap,
            available=round(available * ACCEL_PER_MPS2),
            life=self.next_life(kind.PORT),
        )

    def _reference(self) -> Telegram:
        kind = self._wire.reference
        now, *ahead = self.wayside.preview_raw(self.tick)
        index, self._samples = self._samples & 0xFF, self._samples + 1
        points = {f"ref{step}": raw for step, raw in enumerate(ahead, 1)}
        return kind(**points, ref0=now, index=index, life=self.next_life(kind.PORT))

    def _event(self) -> Telegram:
        kind = self._wire.event
        return kind(int(self.wayside.emergency), life=self.next_life(kind.PORT))

    def _place(self) -> Telegram:
        kind = self._wire.place
        return kind(
            round(self.train.position_m * _CM), round(self.tick * self.tick_ns / 1e7), life=self.next_life(kind.PORT)
        )

    def _truth(self) -> Telegram:
        kind, train = self._wire.truth, self.train
        counts = (train.speed_mps, train.accel_mps2, train.drive_mps2, self.wayside.target_mps(self.tick))
        more = [unit.motion.speed_mps for unit in train.units] if len(train.units) > 1 else []
        couplers = (round(force_n / 10.0) for force_n in train.couplers_n)
        made: Telegram = kind(
            round(train.position_m * _MM),
            *(round(value * TRUE_PER_UNIT) for value in (*counts, *more)),
            *couplers,
            *(state for watch in self.watches for state in (watch.level, watch.cause)),
            life=self.next_life(kind.PORT),
        )
        return made

    def _mutation(self) -> Telegram:
        kind, train = self._wire.mutation, self.train
        gain, lag, traction_delay, braking_delay = (round(value * 1000.0) for value in train.units[0].data)
        grade, wind = round(train.grade_permil * 100.0), round(train.wind.accel_mps2 * TRUE_PER_UNIT)
        return kind(gain, lag, traction_delay, braking_delay, grade, wind, life=self.next_life(kind.PORT))

    # -- commands and time ----------------------------------------------------------------------------------------

    def act(self, telegram: Any) -> None:
        unit = self._unit_of[telegram.PORT]
        self._obey(unit, self.watches[unit].command(self.tick, telegram.accel / ACCEL_PER_MPS2, telegram.mode))

    def _obey(self, unit: int, command_mps2: float | None) -> None:
        if command_mps2 is not None:
            self.train.commands_mps2[unit] = command_mps2

    def advance(self) -> None:
        for number, (watch, unit) in enumerate(zip(self.watches, self.train.units, strict=True)):
            self._obey(number, watch.look(self.tick, unit.told_mps2, unit.motion.drive_mps2))
        self.train.advance()
        self.tick += 1
        if not isfinite(self.train.speed_mps):
            raise PlantError(f"speed is not finite at tick {self.tick}")
        self._look()

    def _look(self) -> None:
        """Events of this instant besides the motion."""
        if self.wayside.look(self.tick, self.train.position_m):
            self.milestone("emergency_called", self.position_01mm)
        if self.train.speed_mps > 0.0:
            self._has_moved = True
        elif self._has_moved and self.wayside.target_mps(self.tick) < ARRIVED_MPS:
            self.milestone("arrived", self.position_01mm, once=True)


class _HighSpeedEnd(TimedEnd):
    """The run ends after its duration, or when the train stands if the controller is lost."""

    def __init__(self, duration_s: float, tick_ns: int, train: HighSpeedTrain) -> None:
        super().__init__(duration_s, tick_ns)
        self._train = train

    def reached(self, tick: int, controller_lost: bool) -> Event | None:
        """The event that ends the run at this tick, None if the run continues."""
        if controller_lost and tick < self.due_tick and self._train.speed_mps > 0.0:
            return None
        return super().reached(tick, controller_lost)
