"""The train protection as one object: it sees readings and gives demands.

NORMAL, INDICATION, OVERSPEED (above the permitted speed), WARNING (traction cut), service brake, emergency brake.
Traction is cut and the service brake applied until the speed is permitted again, or the train stands. The emergency
brake stays until the end of the run.

Choices where the specification leaves one: doors that lose their lock in motion cut traction at any speed; below
5 km/h the service brake stops the train, from 5 km/h on the emergency brake. The last authority stays valid for 1 s
without another one; then the service brake applies, as before a red signal. An unknown position holds the train until a
balise confirms it. Before ceilings and targets the EBI lies behind the service brake; for the other causes the
emergency brake follows a service brake that does not slow the train down.
"""

from __future__ import annotations

from typing import Final

from railhil.plant_sim.atp import readings as codes
from railhil.plant_sim.atp.own_checks import SelfTest
from railhil.plant_sim.atp.position import PositionInterval
from railhil.plant_sim.atp.readings import Authority, Demands, Readings, Track, TrainData
from railhil.plant_sim.atp.supervision import ABOVE_EMERGENCY, ABOVE_SERVICE, ABOVE_WARNING, NOTHING, Supervision
from railhil.systems.line.braking.curve import GradeNotHeldError
from railhil.systems.line.braking.limits import Braking
from railhil.systems.line.braking.track import TrackLimits
from railhil.systems.line.scenario.protection import Protection

#: Time between two looks.
PERIOD_S: Final = 0.1
#: Times are whole ticks, but for rounding.
_ROUNDING_S: Final = 1e-6
#: The acceleration is the slope of the speed over this number of looks.
_SLOPE_LOOKS: Final = 5
_ROLL_AWAY_M: Final = 0.5
_DOORS_SERVICE_MPS: Final = 5 / 3.6
_AUTHORITY_AGE_MAX_S: Final = 1.0
_IGNORED_MAX: Final = 2
#: From this time on the service brake has slowed the train down by this rate at least: a third of the expected one.
_SERVICE_LOOK_S: Final = 3.0
_SERVICE_LEAST_MPS2: Final = 0.3


class TrainProtection:
    """Supervises one train (the package says what it is modelled after).

    It sees its axle sensor, balises, authority and doors, and nothing of a controller.

    :param start_m: where the front stands, in run positions, with the odometer at ``odometer_m``.
    :raises GradeNotHeldError: the emergency brake does not hold a grade before a lower limit.
    """

    def __init__(
        self, settings: Protection, train: TrainData, track: Track, start_m: float, odometer_m: float = 0.0
    ) -> None:
        self.demands = Demands()
        self.place = PositionInterval(settings.over_reading, settings.under_reading, settings.balise_accuracy_m)
        self._settings, self._train = settings, train
        self._checks = SelfTest()
        self._speeds_mps: list[float] = []
        self._next_s = 0.0
        self._authority: Authority | None = None
        self._authority_s = 0.0
        self._held_odometer_m: float | None = None
        self._service_cause = codes.NONE
        self._is_service_until_stop = False
        self._service_from: tuple[float, float] | None = None
        self._cut_cause = codes.NONE
        self._emergency_cause = codes.NONE
        self.place.refer(start_m, odometer_m, settings.balise_accuracy_m)
        self._take(track)

    def enter(self, track: Track, odometer_m: float, position_m: float) -> None:
        """Another leg begins, at standstill, with the front at a position of it.

        The interval keeps its width; the authority of the leg before ends.

        :raises GradeNotHeldError: see the class.
        """
        self.place.update(odometer_m)
        self.place.refer(position_m, odometer_m, 0.5 * (self.place.most_m - self.place.least_m))
        self._take(track)

    def _take(self, track: Track) -> None:
        train, settings = self._train, self._settings
        brake = settings.brake_model(train.gravity_mps2)
        braking = Braking(brake, brake.gradient_steps(track.grade_permil, train.length_m), train.speed_limit_mps)
        self._limits = TrackLimits(
            braking, settings.increments_mps, track.speed_limit_mps, train.length_m, train.speed_limit_mps
        )
        self._supervision = Supervision(self._limits)
        self._authority = None
        self.place.survey(track.balises)

    def step(self, readings: Readings) -> Demands:
        """Take the readings of a tick. The result is one object, which changes every 100 ms."""
        for number, odometer_m in readings.balises:
            self.place.read(number, odometer_m)
        if readings.authority is not None:
            self._authority_s = readings.time_s
            if readings.authority is not self._authority:
                self._authorise(readings.authority)
        if readings.time_s >= self._next_s - _ROUNDING_S:
            self._next_s = readings.time_s + PERIOD_S
            self._supervise(readings)
        return self.demands

    def _authorise(self, authority: Authority) -> None:
        if authority != self._authority:
            settings = self._settings
            try:
                end = self._limits.end_target(
                    authority.eoa_m, authority.svl_m, settings.d_trip_m, settings.v_release_mps
                )
            except GradeNotHeldError:
                # An authority that no brake can keep to.
                self._apply_emergency(codes.SELF_TEST)
                return
            self._supervision.authorise(end, codes.RED_SIGNAL if authority.red_signal else codes.TARGET)
        self._authority = authority

    def _supervise(self, readings: Readings) -> None:
        speed_mps, place = readings.speed_mps, self.place
        if not self._checks.is_healthy(readings.time_s, speed_mps, readings.odometer_m):
            self._apply_emergency(codes.SELF_TEST)
            self._write()
            return
        place.update(readings.odometer_m)
        supervision = self._supervision
        if speed_mps <= 0.0:
            supervision.indicated.clear()
        supervision.look(place, speed_mps, self._acceleration(speed_mps))
        self._brake_for_speed(readings, supervision.excess, supervision.cause)
        self._brake_for_others(readings)
        self._check_service_brake(readings.time_s, speed_mps)
        self._write()

    def _acceleration(self, speed_mps: float) -> float:
        speeds_mps = self._speeds_mps
        speeds_mps.append(speed_mps)
        if len(speeds_mps) <= _SLOPE_LOOKS:
            return (speed_mps - speeds_mps[0]) / (_SLOPE_LOOKS * PERIOD_S)
        return (speed_mps - speeds_mps.pop(0)) / (_SLOPE_LOOKS * PERIOD_S)

    def _brake_for_speed(self, readings: Readings, excess: int, cause: int) -> None:
        """Latch what ceilings, targets and release speed demand; release what is permitted again.

        A train that has moved with an open door is held until the doors are locked.
        """
        if excess == NOTHING:
            self._cut_cause = codes.NONE
        is_held = self._service_cause == codes.DOORS and not readings.doors_locked
        may_release = readings.speed_mps <= 0.0 or (excess == NOTHING and not self._is_service_until_stop)
        if may_release and not is_held:
            self._service_cause = codes.NONE
            self._is_service_until_stop = False
        if excess >= ABOVE_WARNING:
            self._cut_cause = self._cut_cause or cause
        if excess >= ABOVE_SERVICE:
            self._service_cause = self._service_cause or cause
        if excess == ABOVE_EMERGENCY:
            self._apply_emergency(cause)
        if self._supervision.is_tripped:
            self._apply_emergency(codes.TRIP)

    def _brake_for_others(self, readings: Readings) -> None:
        """What position, doors, a held train and a missing authority demand."""
        is_moving = readings.speed_mps > 0.0
        age_s = readings.time_s - self._authority_s
        if self._authority is None or age_s > _AUTHORITY_AGE_MAX_S + _ROUNDING_S:
            self._cut_cause = self._cut_cause or codes.RED_SIGNAL
            if is_moving:
                self._stop(codes.RED_SIGNAL)
        if self.place.ignored_in_a_row >= _IGNORED_MAX:
            self._stop(codes.POSITION)
        if is_moving and not readings.doors_locked:
            self._cut_cause = self._cut_cause or codes.DOORS
            if readings.speed_mps < _DOORS_SERVICE_MPS:
                self._stop(codes.DOORS)
            else:
                self._apply_emergency(codes.DOORS)
        if not readings.train_held:
            self._held_odometer_m = None
        elif self._held_odometer_m is None:
            self._held_odometer_m = None if is_moving else readings.odometer_m
        elif abs(readings.odometer_m - self._held_odometer_m) > _ROLL_AWAY_M:
            self._apply_emergency(codes.ROLL_AWAY)

    def _stop(self, cause: int) -> None:
        """The service brake until the train stands."""
        self._service_cause = self._service_cause or cause
        self._is_service_until_stop = True

    def _check_service_brake(self, time_s: float, speed_mps: float) -> None:
        """The emergency brake for a train that the service brake has not slowed down."""
        if not self._is_service_until_stop or speed_mps <= 0.0:
            self._service_from = None
        elif self._service_from is None:
            self._service_from = time_s, speed_mps
        else:
            from_s, from_mps = self._service_from
            braking_s = time_s - from_s
            if braking_s > _SERVICE_LOOK_S and from_mps - speed_mps < _SERVICE_LEAST_MPS2 * braking_s:
                self._apply_emergency(self._service_cause)

    def _apply_emergency(self, cause: int) -> None:
        self._emergency_cause = self._emergency_cause or cause

    def _write(self) -> None:
        supervision, place, demands = self._supervision, self.place, self.demands
        emergency, service = self._emergency_cause != codes.NONE, self._service_cause != codes.NONE
        demands.emergency_brake, demands.service_brake = emergency, service
        demands.traction_cut = emergency or service or self._cut_cause != codes.NONE
        demands.cause = self._emergency_cause or self._service_cause or self._cut_cause or supervision.cause
        if emergency or service:
            demands.status = codes.INTERVENTION
        elif demands.traction_cut:
            demands.status = codes.WARNING
        elif supervision.excess > NOTHING:
            demands.status = codes.OVERSPEED
        else:
            demands.status = codes.INDICATION if supervision.indicated else codes.NORMAL
        if supervision.is_released:
            demands.monitoring = codes.RELEASE_MONITORING
        else:
            demands.monitoring = codes.TARGET_MONITORING if supervision.indicated else codes.CEILING_MONITORING
        levels = supervision.levels
        demands.permitted_mps, demands.warning_mps = levels.permitted_mps, levels.warning_mps
        demands.sbi_mps, demands.ebi_mps = levels.service_mps, levels.emergency_mps
        end = supervision.end
        target = supervision.lowest_target or (None if end is None else end.target)
        demands.target_distance_m = 0.0 if target is None else target.place_m - place.estimated_m
        demands.target_speed_mps = 0.0 if target is None else target.floor.permitted_mps
        demands.release_mps = 0.0 if supervision.release is None else supervision.release.speed_mps
        demands.uncertainty_m = 0.5 * (place.most_m - place.least_m)
