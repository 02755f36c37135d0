"""What the train says of itself at an instant: readings of its sensors, and the truth."""

from __future__ import annotations

from railhil.common.floats import rounded
from railhil.common.mypyc import mypyc_attr
from railhil.plant_sim import forces
from railhil.plant_sim.ato import dynamics
from railhil.plant_sim.ato.command_watch import CommandWatchState
from railhil.plant_sim.ato.dynamics import Motion, Window
from railhil.plant_sim.ato.sensors import AxleSensors
from railhil.systems.ato.scenario.model import Train
from railhil.wire.ato import WatchLevel


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
    _watch: CommandWatchState
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
        return self._watch.level

    @property
    def command_age_ms(self) -> int:
        """Age of the last accepted command, in ms."""
        return round(self._watch.age_ticks * self._step_s * 1000)

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
