"""Readings of the train at an instant: its axle sensors, the status of its equipment, and the truth.

The batch compiles the readings of the axle sensors (:mod:`railhil.common.compilable` lists the permitted language).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from railhil.common.compilable import compilable_functions
from railhil.common.floats import rounded
from railhil.common.mypyc import mypyc_attr
from railhil.plant_sim.ato import dynamics, forces
from railhil.plant_sim.ato.dynamics import Motion, Window
from railhil.plant_sim.ato.train_watch import TrainWatch
from railhil.scenarios import streams
from railhil.scenarios.streams import Chain, chain_normals, chain_of, keys_of
from railhil.systems.ato.scenario.model import Sensors, Train
from railhil.wire.ato import WatchLevel

#: Speed noise is drawn in blocks of this many ticks.
_NOISE_BLOCK: Final = 4096


def speed_reading_01mmps(speed_mps: float, noise_mps: float, wheel_factor: float, lsb_mps: float) -> int:
    """Reading of a true speed >= 0, in 0.1 mm/s. A standing axle reads 0, and the reading is never negative."""
    if speed_mps <= 0.0:
        return 0
    counts = rounded((speed_mps * wheel_factor + noise_mps) / lsb_mps)
    return rounded(counts * lsb_mps * 1e4) if counts > 0 else 0


def odometer_reading_mm(position_m: float, wheel_factor: float, lsb_m: float) -> int:
    """Odometer at a true position, in mm, to its resolution."""
    return rounded(rounded(position_m * wheel_factor / lsb_m) * lsb_m * 1000)


class AxleSensors:
    """Readings of one run. Each tick has its own speed noise, independent of the number of readings.

    :param stream: of the noise; another axle of the train has its own.
    :param noise: the sequences whose sum the noise is; empty: that of the seed.
    :raises ValueError: a negative seed.
    """

    def __init__(self, sensors: Sensors, seed: int, stream: int = streams.AXLE_NOISE, noise: Chain = ()) -> None:
        self.sensors = sensors
        self._keyed = keys_of(chain_of(seed, noise), stream)
        self._stream = stream
        self._renewed, self._renewed_tick = self._keyed, 0
        self._first_tick = 0
        self._block_mps: list[float] = []

    def renew(self, tick: int, seed: int) -> None:
        """From a tick on, have the noise of another seed."""
        self._renewed, self._renewed_tick = keys_of(chain_of(seed), self._stream), tick
        self._block_mps = []

    def speed_01mmps(self, speed_mps: float, tick: int) -> int:
        """Reading of a true speed >= 0 at a tick, in 0.1 mm/s."""
        sensors = self.sensors
        return speed_reading_01mmps(speed_mps, self.noise_mps(tick), sensors.wheel_factor, sensors.speed_lsb_mps)

    def noise_mps(self, tick: int) -> float:
        """Noise of the speed at a tick."""
        index = tick - self._first_tick
        if not 0 <= index < len(self._block_mps):
            index = tick % _NOISE_BLOCK
            self._first_tick = tick - index
            draws = chain_normals(self._keyed, self._first_tick, _NOISE_BLOCK)
            before = self._renewed_tick - self._first_tick
            if self._renewed is not self._keyed and before < _NOISE_BLOCK:
                before = max(before, 0)
                draws[before:] = chain_normals(self._renewed, self._first_tick + before, _NOISE_BLOCK - before)
            self._block_mps = (draws * self.sensors.speed_noise_sigma_mps).tolist()
        return self._block_mps[index]

    def odometer_mm(self, position_m: float) -> int:
        """Odometer at a true position, in mm, to its resolution."""
        return odometer_reading_mm(position_m, self.sensors.wheel_factor, self.sensors.odometer_lsb_m)

    def odometer_between_mm(self, position_m: float) -> int:
        """Odometer at a true position, in mm, interpolated between its counts as a balise reader does."""
        return round(position_m * self.sensors.wheel_factor * 1000)


compilable_functions(speed_reading_01mmps, odometer_reading_mm)


#: Lowest permanent line voltage in % of nominal: 1000 V of 1500 V, 500 V of 750 V (EN 50163, table 1).
LINE_VOLTAGE_MIN_PERCENT: Final = 200 / 3


@dataclass(slots=True)
class TrainStatus:
    """State of the train's equipment; a healthy train by default. Setting a field takes effect from the next step on.

    ``line_voltage_percent`` is of nominal, ``fault`` the code 0..15 of PLT_STAT (0 = none).
    """

    power_on: bool = True
    pantograph_up: bool = True
    main_breaker_closed: bool = True
    doors_closed_locked: bool = True
    parking_brake_released: bool = True
    safety_loop_closed: bool = True
    brake_available: bool = True
    line_voltage_percent: float = 100.0
    fault: int = 0

    @property
    def traction_enabled(self) -> bool:
        """True when no interlock of the train blocks traction."""
        return (
            self.power_on
            and self.pantograph_up
            and self.main_breaker_closed
            and self.doors_closed_locked
            and self.parking_brake_released
            and self.safety_loop_closed
            and self.brake_available
            and self.line_voltage_percent >= LINE_VOLTAGE_MIN_PERCENT
        )


@mypyc_attr(allow_interpreted_subclasses=True)
class PlantReadings:
    """Properties of :class:`railhil.plant_sim.ato.plant.Plant`, computed from its state when they are read."""

    #: Base ticks simulated.
    tick: int
    _train: Train
    _constants: forces.TrainConstants
    _grades: forces.GradeTable
    _step_s: float
    _motion: Motion
    _window: Window
    _watch: TrainWatch
    _acting_code: int
    _sensors: AxleSensors
    #: State and window of the force that was computed last, and that force.
    _applied_of: tuple[Motion, Window] | tuple[None, None]
    _applied: float

    # -- sensor readings ------------------------------------------------------------------------------------

    @property
    def speed_01mmps(self) -> int:
        """Speed measured by the axle sensor, in 0.1 mm/s."""
        return self._sensors.speed_01mmps(self._motion.speed_mps, self.tick)

    @property
    def odometer_mm(self) -> int:
        """Odometer in mm since the start, with wheel factor and resolution."""
        return self._sensors.odometer_mm(self._motion.position_m)

    @property
    def effort_fraction(self) -> float:
        """Force as a fraction of the maximum traction (positive) or braking force (negative) at standstill."""
        force_n = self._applied_n
        effort = self._train.traction if force_n >= 0.0 else self._train.brake
        return force_n / effort.force_max_n

    @property
    def notch_acting(self) -> int:
        """Notch acting on the actuator now, in 1/256; never a traction notch while traction is blocked."""
        return self._acting_code if self._window.traction else min(self._acting_code, 0)

    @property
    def watch_level(self) -> WatchLevel:
        """Level of the train's watch over the last tick."""
        return self._watch.state.level

    @property
    def command_age_ms(self) -> int:
        """Age of the last accepted command, in ms."""
        return round(self._watch.state.age_ticks * self._step_s * 1000)

    # -- truth ----------------------------------------------------------------------------------------------------

    @property
    def position_01mm(self) -> int:
        """True position of the front in 0.1 mm."""
        return rounded(self._motion.position_m * 1e4)

    @property
    def true_speed_01mmps(self) -> int:
        """True speed in 0.1 mm/s."""
        return rounded(self._motion.speed_mps * 1e4)

    @property
    def accel_mps2(self) -> float:
        """Acceleration at this instant in m/s2."""
        return dynamics.acceleration_mps2(self._constants, self._grades, self._window, self._motion)

    @property
    def traction_n(self) -> float:
        """Traction force at this instant in N, >= 0."""
        return max(0.0, self._applied_n)

    @property
    def brake_n(self) -> float:
        """Braking force at this instant in N, >= 0."""
        return max(0.0, -self._applied_n)

    @property
    def grade_permil(self) -> float:
        """Grade averaged over the train, in permil."""
        return forces.mean_grade_permil(self._grades, self._motion.position_m)

    @property
    def _applied_n(self) -> float:
        # Three readings of a tick use this force; state and window are immutable, so identical objects give the same
        # force.
        of = self._motion, self._window
        if of[0] is not self._applied_of[0] or of[1] is not self._applied_of[1]:
            self._applied_of, self._applied = of, dynamics.applied_n(self._constants, self._window, self._motion)
        return self._applied
