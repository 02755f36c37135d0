"""The train on its line: dynamics, actuator with loop delay, sensors, interlocks and the train's own watch.

Events have their exact instants within a tick.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import inf, isfinite, sqrt
from typing import Final, TypeAlias

from railhil.common.mypyc import mypyc_attr
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.ato import dynamics, force_tables
from railhil.plant_sim.ato.dynamics import Lag, Motion, Window
from railhil.plant_sim.ato.plant_readings import AxleSensors, PlantReadings, TrainStatus
from railhil.plant_sim.ato.train_checks import OwnChecks
from railhil.plant_sim.ato.train_watch import TrainWatch
from railhil.scenarios.profiles import Profile, find_lowest, profile_value
from railhil.systems.ato.scenario.model import STOP_LEG_MIN_M, Balise, Line, Scenario
from railhil.wire.ato import WatchCause, WatchLevel

#: One of those of :class:`PlantEvent`; a plant that is made of this one may have more.
EventKind: TypeAlias = str


@dataclass(frozen=True, slots=True)
class PlantEvent:
    """Something that happened inside a tick, at its exact instant and true position of the train's front.

    ``departed``: first motion; ``stopped``: standstill after at least :data:`STOP_LEG_MIN_M`;
    ``emergency``: the emergency brake was applied; ``watch``: the level of the train's watch changed; ``balise``: the
    front passed ``balise`` with the odometer at ``odometer_mm``.
    """

    kind: EventKind
    instant_01ms: int
    position_01mm: int
    balise: Balise | None = None
    odometer_mm: int = 0


def passing_s(before: Motion, after: Motion, at_m: float, moving_s: float) -> float:
    """Time from the first motion of a step to the passing of ``at_m``, with constant acceleration in between."""
    distance_m = at_m - before.position_m
    if distance_m <= 0.0 or moving_s <= 0.0:
        return 0.0
    accel_mps2 = (after.speed_mps - before.speed_mps) / moving_s
    root_mps = sqrt(max(0.0, before.speed_mps**2 + 2 * accel_mps2 * distance_m))
    return min(moving_s, 2 * distance_m / (before.speed_mps + root_mps))


#: Notch codes per notch.
NOTCH_LSB_PER_NOTCH: Final = 256
#: Grade up to which an applied parking brake holds the train.
PARKING_BRAKE_PERMIL: Final = 40.0

# Looking up a member of an enum costs as much as a call on CPython 3.11, and these are needed in every tick.
_NOTHING: Final = WatchCause.NONE
_OVERSPEED: Final = WatchCause.OVERSPEED
_SAFETY_LOOP: Final = WatchCause.SAFETY_LOOP
_TRACTION_CUT: Final = WatchLevel.TRACTION_CUT
_EMERGENCY: Final = WatchLevel.EMERGENCY

#: Parts of a tick shorter than this are not simulated as a separate step.
SLIVER_TICKS: Final = 1e-9


@mypyc_attr(allow_interpreted_subclasses=True)
class Plant(PlantReadings):
    """One train on one run, advanced tick by tick (``scenario.timing.base_tick_ns``) from standstill at position 0.

    All readings are those of the instant ``tick * base_tick``, before :meth:`advance`. ``seed`` is the run's; the noise
    of the speed sensor depends only on the seed and the tick, not on the number of readings.
    """

    def __init__(self, scenario: Scenario, seed: int) -> None:
        train, timing = scenario.train, scenario.timing
        self.tick = 0
        self.status = TrainStatus()
        self.events: list[PlantEvent] = []
        self._train = train
        self._constants = force_tables.train_constants(train)
        self._step_s = timing.base_tick_ns * 1e-9
        self._full_lag = dynamics.lag(train.actuator_pole_per_s, self._step_s)
        self._motion = dynamics.AT_REST
        #: The train one step later; another plant may have its own.
        self._moved = dynamics.step
        self._departed = False
        #: Where the train has stood since it last began to move.
        self._stood_m = 0.0
        self._leg_from_m = 0.0

        self._notch_max_code = round(train.notch_max * NOTCH_LSB_PER_NOTCH)
        self._delay_ticks = timing.loop_delay_s * 1e9 / timing.base_tick_ns
        self._staged: deque[tuple[float, int]] = deque()
        self._staged_code = 0
        self._acting_code = 0

        self._overspeed_margin_mps = scenario.watch.overspeed_margin_mps
        self._watch = TrainWatch(scenario.watch, timing.base_tick_ns, train.service_braking_mps2)
        #: Cause of the present level of the watch.
        self.watch_cause = self._watch.cause
        self._own_checks = OwnChecks(scenario, self._constants)
        self._look_ticks = self._own_checks.every_ticks
        self._parking_brake_n = train.mass_kg * train.gravity_mps2 * PARKING_BRAKE_PERMIL / 1000
        self._window = Window(False, train.service_braking_mps2 * train.inertial_mass_kg)
        self._applied_of: tuple[Motion, Window] | tuple[None, None] = (None, None)
        self._applied = 0.0
        self._enter(scenario.line)

        self._sensors = AxleSensors(scenario.sensors, seed, noise=scenario.noise)
        if scenario.noise_change is not None:
            self.renew_noise(*scenario.noise_change)
        self._balises = deque(sorted(scenario.line.balises, key=lambda balise: (balise.true_m, balise.number)))
        # The balise under the waiting train was read when it arrived.
        while self._balises and self._balises[0].true_m <= 0.0:
            self._pass_balise(self._balises.popleft(), 0.0)

    # -- commands -------------------------------------------------------------------------------------------------

    def command(self, notch_code: int, emergency: bool) -> None:
        """An accepted NOTCH_CMD at the current tick.

        ``notch_code`` in 1/256 notch is clamped to the train's range and acts ``loop_delay_s`` after the current
        tick's instant. ``emergency`` is latched and acts from the current instant on.
        """
        code = min(max(notch_code, -self._notch_max_code), self._notch_max_code)
        self._watch.command(emergency)
        if code != self._staged_code:
            self._staged_code = code
            self._staged.append((self.tick + self._delay_ticks, code))

    def suspect(self, cause: WatchCause) -> None:
        """Take the gate's finding in a NOTCH_CMD of the current tick; the strongest of several counts."""
        self._watch.suspect(cause)

    def _enter(self, line: Line) -> None:
        """Take the profiles of a line for the train where it is now."""
        train = self._train
        self._grades = force_tables.grade_table(line.grade_permil, train.length_m)
        self._front_limit = find_lowest(line.speed_limit_mps, train.length_m, train.speed_limit_mps)
        self._limit_mps, self._limit_to_m = _limit_from(self._front_limit, self._motion.position_m)

    def renew_noise(self, tick: int, seed: int) -> None:
        """From a tick on, read with the noise of another seed."""
        self._sensors.renew(tick, seed)

    # -- time -----------------------------------------------------------------------------------------------------

    def advance(self) -> None:
        """Simulate one base tick.

        :raises PlantError: the state is no longer finite.
        """
        self._protect()
        staged = self._staged
        now, end = float(self.tick), self.tick + 1
        while staged and staged[0][0] <= end:
            due, code = staged.popleft()
            if due - now > SLIVER_TICKS:
                self._move(now, due - now)
                now = due
            self._acting_code = code
        if end - now > SLIVER_TICKS:
            self._move(now, end - now)
        self.tick = end
        position_m, speed_mps, actuator_n, _ = self._motion
        if not isfinite(position_m + speed_mps + actuator_n):
            raise PlantError(
                f"plant state is not finite at tick {end}: position {position_m} m, speed {speed_mps} m/s, "
                f"actuator {actuator_n} N"
            )

    def drain_events(self) -> list[PlantEvent]:
        """Events since the last call, in order of their instants."""
        events, self.events = self.events, []
        return events

    def _protect(self) -> None:
        """Let the watch and the interlocks determine the allowed forces of the coming tick."""
        position_m, speed_mps, actuator_n, _ = self._motion
        if position_m >= self._limit_to_m:
            self._limit_mps, self._limit_to_m = _limit_from(self._front_limit, position_m)
        moving = speed_mps > 0.0
        status, watch = self.status, self._watch
        emergency: WatchCause = _NOTHING
        if self.tick % self._look_ticks == 0:
            emergency = self._own_checks.finding(self.tick, self._acting_code, self._motion, self._window.brake_min_n)
        if speed_mps > self._limit_mps + self._overspeed_margin_mps:
            emergency = _OVERSPEED
        if not status.safety_loop_closed:
            emergency = _SAFETY_LOOP
        before = watch.state.level
        watch.step(moving, speed_mps < self._limit_mps, emergency)
        level = watch.state.level
        if level != before:
            self.watch_cause = self._cause()
            self._event("watch", 0.0, position_m)
        traction = status.traction_enabled and level < _TRACTION_CUT
        if traction and watch.brake_mps2 == 0.0:
            self._window = dynamics.FREE
            return
        if level is _EMERGENCY and before is not _EMERGENCY:
            self._event("emergency", 0.0, position_m)
        mass_kg = self._constants.mass_kg
        applied_n = dynamics.applied_n(self._constants, self._window, self._motion)
        watch.brake(max(0.0, -applied_n / mass_kg), moving, self._train.service_braking_mps2)
        brake_min_n = watch.brake_mps2 * mass_kg
        if not status.parking_brake_released:
            brake_min_n = max(brake_min_n, self._parking_brake_n)
        self._window = Window(traction, brake_min_n)
        if not traction and actuator_n > 0.0:
            # The contactors are open. When they close again, traction builds up from zero.
            self._motion = self._motion._replace(actuator_n=0.0)

    def _cause(self) -> WatchCause:
        """Cause for which the watch has just entered its level."""
        return self._watch.cause

    def _move(self, from_tick: float, ticks: float) -> None:
        """Simulate a tick or a part of it with the present notch."""
        before = self._motion
        full = self._full_lag
        lag_step: Lag = full if ticks == 1.0 else dynamics.lag(self._train.actuator_pole_per_s, ticks * self._step_s)
        steady_n = self.notch_acting * self._train.force_per_notch_n / NOTCH_LSB_PER_NOTCH
        motion, moving_from_s, moving_to_s = self._moved(
            self._constants, self._grades, self._window, before, steady_n, lag_step
        )
        self._motion = motion
        position_m = motion.position_m
        if not self._departed and position_m > self._stood_m:
            self._departed = True
            self._start((from_tick - self.tick) * self._step_s + moving_from_s, before.position_m)
        while self._balises and self._balises[0].true_m <= position_m:
            passed_s = passing_s(before, motion, self._balises[0].true_m, moving_to_s - moving_from_s)
            self._pass_balise(
                self._balises.popleft(), (from_tick - self.tick) * self._step_s + moving_from_s + passed_s
            )
        # The speed decides, not the distance: far from 0, the floating-point position of a creeping train no longer
        # changes in a step.
        if motion.speed_mps <= 0.0 < before.speed_mps:
            self._stand((from_tick - self.tick) * self._step_s + moving_to_s, position_m)

    def _start(self, after_s: float, position_m: float) -> None:
        """Note the first motion, ``after_s`` after the current tick."""
        self._event("departed", after_s, position_m)

    def _stand(self, after_s: float, position_m: float) -> None:
        """Note a standstill."""
        if position_m - self._leg_from_m >= STOP_LEG_MIN_M:
            self._leg_from_m = position_m
            self._event("stopped", after_s, position_m)

    def _event(
        self,
        kind: EventKind,
        after_s: float,
        position_m: float,
        balise: Balise | None = None,
        odometer_mm: int = 0,
    ) -> None:
        """Note an event ``after_s`` after the current tick."""
        instant_01ms = round((self.tick * self._step_s + after_s) * 1e4)
        self.events.append(PlantEvent(kind, instant_01ms, round(position_m * 1e4), balise, odometer_mm))

    def _pass_balise(self, balise: Balise, after_s: float) -> None:
        odometer_mm = self._sensors.odometer_between_mm(balise.true_m)
        self._event("balise", after_s, balise.true_m, balise, odometer_mm)


def _limit_from(profile: Profile, position_m: float) -> tuple[float, float]:
    """Speed limit at a position, and the position up to which it applies."""
    return profile_value(profile, position_m), next((at_m for at_m, _ in profile if at_m > position_m), inf)
