"""A high-speed train of one or several power units, and the wayside that gives it its speeds, without a bus."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

from railhil.plant_sim.high_speed.dynamics import (
    GRAVITY_MPS2,
    Coupler,
    Drive,
    UnitLimits,
    UnitMotion,
    coupler_n,
    drive,
    grade_mps2,
    joined,
    moved,
    resistance_of,
)
from railhil.plant_sim.high_speed.surroundings import Wind, drawn_grades
from railhil.scenarios import streams
from railhil.systems.high_speed.target import GRID_S, SpeedCurve, emergency_curve, journey_curve
from railhil.systems.high_speed.task import HighSpeedTask, UnitTable
from railhil.wire.power_units import PREVIEW, PREVIEW_STEP_S, SPEED_PER_MPS

#: Simulation step.
STEP_S = 0.01
#: Commands that are remembered, in steps: delays up to 10 s.
REMEMBERED = 1024
_STRIDE = round(PREVIEW_STEP_S / GRID_S)
#: Shares of an interval of the curve below this are rounding errors of a time.
_NEAR = 1e-6
SPEED_RAW_MAX = 0xFFFF
_KMH = 3.6


class UnitData(NamedTuple):
    """Quantities that a mutation changes: gain, lag, delays of traction and braking."""

    gain: float
    lag_s: float
    traction_delay_s: float
    braking_delay_s: float

    @classmethod
    def of(cls, unit: UnitTable) -> UnitData:
        """The data of the scenario."""
        return cls(unit.gain, unit.lag_s, unit.traction_delay_s, unit.braking_delay_s)


class PowerUnit:
    """One unit: its state, and its commands on their way.

    :param command_mps2: the command that has acted for long.
    """

    def __init__(self, data: UnitData, motion: UnitMotion, command_mps2: float) -> None:
        self.motion = motion
        #: Its motion in a step.
        self.moved = moved
        #: Braking that should act in the present step, <= 0.
        self.told_mps2 = 0.0
        self._sent = [command_mps2] * REMEMBERED
        self.mutate(data)

    def mutate(self, data: UnitData) -> None:
        """Give the unit these data from now on; its state and the commands on their way stay."""
        self.data = data
        self.drive: Drive = drive(data.gain, data.lag_s, STEP_S)
        self.traction_steps = round(data.traction_delay_s / STEP_S)
        self.braking_steps = round(data.braking_delay_s / STEP_S)

    def acting_mps2(self, step: int, command_mps2: float) -> float:
        """The delayed traction and the delayed braking, added, when a command is sent at a step."""
        traction, braking = self.delayed_mps2(step, command_mps2)
        return joined(traction, braking)

    def delayed_mps2(self, step: int, command_mps2: float) -> tuple[float, float]:
        """The delayed commands of traction and braking when one is sent at a step."""
        sent = self._sent
        sent[step % REMEMBERED] = command_mps2
        traction = sent[(step - self.traction_steps) % REMEMBERED]
        braking = sent[(step - self.braking_steps) % REMEMBERED]
        self.told_mps2 = braking if braking < 0.0 else 0.0
        return traction, braking


class HighSpeedTrain:
    """The simulated train at one instant; :meth:`advance` simulates a tick.

    ``speed_mps``, ... of the train are means over its units, by mass for ``drive_mps2``.

    :param seed: of grades, wind and noise.
    :param tick_s: duration of a tick, a multiple of :data:`STEP_S`.
    """

    def __init__(self, task: HighSpeedTask, seed: int, tick_s: float) -> None:
        self._steps_per_tick = round(tick_s / STEP_S)
        self._step = 0
        curve = journey_curve(task)
        self.grades = drawn_grades(
            seed, task.gradient_permil, task.gradient_piece_m, task.curve.distance_km * 1000.0, task.length_m
        )
        self.wind = Wind(seed, task.wind_sigma_mps2, task.wind_time_s, tick_s)
        self._noise = streams.NormalSequence(streams.generator(seed, streams.SPEED_NOISE))
        self.noise_sigma_mps = task.noise_sigma_mps
        a, b, c = (value / 1000.0 for value in task.davis_n_per_t)
        self.limits = UnitLimits(
            task.traction_max_mps2, task.braking_max_mps2, task.power_w_per_kg, a, b * _KMH, c * _KMH * _KMH
        )
        speed_mps, position_m = curve.speed_mps(task.start_s), curve.position_m(task.start_s)
        steady = 0.0
        if speed_mps > 0.0:
            slope_mps2 = (curve.speed_mps(task.start_s + GRID_S) - speed_mps) / GRID_S
            steady = slope_mps2 + resistance_of(self.limits, speed_mps) + grade_mps2(self.grades, position_m)
        start = UnitMotion(position_m, speed_mps, steady, 0.0)
        self.units = [PowerUnit(UnitData.of(unit), start, steady / unit.gain) for unit in task.unit]
        self.commands_mps2 = [steady / unit.gain for unit in task.unit] if speed_mps > 0.0 else [0.0] * len(task.unit)
        between = task.between_units
        self.coupler = (
            None
            if between is None
            else Coupler(
                between.stiffness_kn_per_m * 1000.0, between.damping_kn_per_mps * 1000.0, between.slack_mm / 2000.0
            )
        )
        #: Force of each coupler in the last step, tension positive.
        self.couplers_n = [0.0] * (len(task.unit) - 1)
        self.mass_kg = [unit.mass_t * 1000.0 * (1.0 + task.rotating_mass_share) for unit in task.unit]

    def advance(self) -> None:
        """Simulate one tick with the present commands."""
        limits, grades, wind_mps2 = self.limits, self.grades, self.wind.accel_mps2
        outside_mps2 = [wind_mps2] * len(self.units)
        for _ in range(self._steps_per_tick):
            step = self._step
            if self.coupler is not None:
                outside_mps2 = self._coupled_mps2(self.coupler, wind_mps2)
            for unit, command_mps2, outside in zip(self.units, self.commands_mps2, outside_mps2, strict=True):
                acting = unit.acting_mps2(step, command_mps2)
                unit.motion = unit.moved(limits, unit.drive, grades, unit.motion, acting, outside, STEP_S)
            self._step = step + 1
        self.wind.step()

    def _coupled_mps2(self, coupler: Coupler, wind_mps2: float) -> list[float]:
        """Acceleration of each unit by wind and couplers."""
        motions = [unit.motion for unit in self.units]
        self.couplers_n = forces_n = [coupler_n(coupler, *pair, STEP_S) for pair in pairwise(motions)]
        pushed_n, pulled_n = [0.0, *forces_n], [*forces_n, 0.0]
        rows = zip(pushed_n, pulled_n, self.mass_kg, strict=True)
        return [wind_mps2 + (front - rear) / mass_kg for front, rear, mass_kg in rows]

    def read_speed_raw(self, unit: int) -> int:
        """A new reading of a unit's speed (0.01 km/h), with noise: 0 and above."""
        read_mps = self.units[unit].motion.speed_mps + self.noise_sigma_mps * self._noise()
        return min(max(round(read_mps * SPEED_PER_MPS), 0), SPEED_RAW_MAX)

    @property
    def position_m(self) -> float:
        """Position of the leading unit."""
        return self.units[0].motion.position_m

    @property
    def speed_mps(self) -> float:
        """Mean speed of the units."""
        return _total(unit.motion.speed_mps for unit in self.units) / len(self.units)

    @property
    def accel_mps2(self) -> float:
        """Mean acceleration of the units in the last step."""
        return _total(unit.motion.accel_mps2 for unit in self.units) / len(self.units)

    @property
    def drive_mps2(self) -> float:
        """Acceleration of the train by traction and brake."""
        pairs = zip(self.units, self.mass_kg, strict=True)
        return _total(unit.motion.drive_mps2 * mass for unit, mass in pairs) / _total(self.mass_kg)

    @property
    def grade_permil(self) -> float:
        """Mean grade under the leading unit."""
        return grade_mps2(self.grades, self.position_m) / (GRAVITY_MPS2 / 1000.0)


def _total(values: Iterable[float]) -> float:
    """The sum from left to right: from CPython 3.12 on ``sum`` compensates rounding errors, which gives other bits."""
    total = 0.0
    for value in values:
        total += value
    return total


class Wayside:
    """The speeds to follow: the target curve, from the trigger on the emergency profile.

    :param tick_s: duration of a tick.
    """

    def __init__(self, task: HighSpeedTask, tick_s: float) -> None:
        self._task = task
        self._tick_s = tick_s
        self._curve: SpeedCurve = journey_curve(task)
        self._raw = _raw_speeds(self._curve.speeds_mps)
        self._from_s = -task.start_s
        self.emergency = False

    def look(self, tick: int, position_m: float) -> bool:
        """Whether the emergency is triggered at this tick, by the position of the train."""
        wanted = self._task.emergency
        if wanted is None or self.emergency or position_m < wanted.at_km * 1000.0:
            return False
        now_s = tick * self._tick_s
        self._curve = emergency_curve(wanted, self.target_mps(tick))
        self._raw = _raw_speeds(self._curve.speeds_mps)
        self._from_s = now_s
        self.emergency = True
        return True

    def target_mps(self, tick: int) -> float:
        """Target speed at a tick."""
        return self._curve.speed_mps(tick * self._tick_s - self._from_s)

    def preview_raw(self, tick: int) -> list[int]:
        """Target speeds now and at the points of the preview, 0.01 km/h, linear between points of the curve.

        An emergency is triggered at any tick, so the instants of its profile are not those of the grid.

        :returns: ``PREVIEW + 1`` numbers, the present one first.
        """
        place = (tick * self._tick_s - self._from_s) / GRID_S
        # The addition corrects a quotient just below a whole number.
        first = int(place + _NEAR)
        found = self._raw[first : first + PREVIEW * _STRIDE + 1 : _STRIDE]
        share = place - first
        if share > _NEAR:
            speeds_mps = self._curve.speeds_mps
            now = speeds_mps[first : first + PREVIEW * _STRIDE + 1 : _STRIDE]
            later = speeds_mps[first + 1 : first + PREVIEW * _STRIDE + 2 : _STRIDE]
            found = _raw_speeds([a + (b - a) * share for a, b in zip(now, later, strict=False)])
        return found + [self._raw[-1]] * (PREVIEW + 1 - len(found))


def _raw_speeds(speeds_mps: Iterable[float]) -> list[int]:
    return [round(speed_mps * SPEED_PER_MPS) for speed_mps in speeds_mps]
