"""The simulated train of the system ``stop``, without a bus."""

from __future__ import annotations

from collections import deque
from math import exp, sqrt
from typing import Any, NamedTuple

from railhil.bus.stopping import MM, SAMPLE_S, SAMPLES
from railhil.plant_sim.high_speed.surroundings import Normals
from railhil.plant_sim.stopping.brake import GRAVITY_MPS2, Motion, moved, time_at_position, time_at_speed
from railhil.plant_sim.stopping.draws import RunDraw, TrainDraw
from railhil.scenarios import streams

_SPEED_RAW_MAX = 0xFFFF


class Passed(NamedTuple):
    """The last balise: id from 1 (0: none yet) and the distance by the wheels at it."""

    balise: int
    odometer_m: float


class Stopped(NamedTuple):
    """A standstill: its instant since the start of the run, and its position."""

    instant_s: float
    position_m: float


class StopTrain:
    """The train at one instant; :meth:`advance` goes on by a tick of five sub-steps.

    :param task: a :class:`railhil.scenarios.stopping.task.StopTask`.
    :param seed, run_number: of the noise, the wander and the balises.
    """

    def __init__(self, task: Any, train: TrainDraw, run: RunDraw, seed: int, run_number: int) -> None:
        self.task, self.run = task, run
        self.gain, self.delay_s, self.lag_s = run.gain, run.delay_s, task.true.lag_s
        #: Lost share of the braking below a speed; share of the wheels' error in every reading.
        self._notch_mps2: float = task.brake.notch_mps2
        self._emergency_mps2: float = -task.emergency_braking_mps2
        self._start_m: float = task.start_m
        self.loss, self.loss_below_mps, self.wheel = task.true.low_speed_loss, task.true.low_speed_mps, train.wheel
        self._bounds_m = tuple(position_m for position_m, _ in task.grade[1:])
        self._grades_mps2 = tuple(
            -GRAVITY_MPS2 * (permil + error) / 1000.0
            for (_, permil), error in zip(task.grade, train.map_errors_permil, strict=True)
        )
        self._piece = sum(bound_m <= task.start_m for bound_m in self._bounds_m)
        steady = -self._grades_mps2[self._piece] if run.start_mps > 0.0 else 0.0
        self.motion = Motion(task.start_m, run.start_mps, steady)
        #: Acceleration of the train, and whether the adhesion limits its brake.
        self.accel_mps2, self.slides = 0.0, False
        #: What has been commanded to act now, and the commands on their way: instant and acceleration.
        self.target_mps2 = steady
        self._coming: deque[tuple[float, float]] = deque()
        #: The emergency brake acts.
        self.emergency = False
        self._braking = False
        self.last_stop: Stopped | None = None
        self.passed = Passed(0, 0.0)
        self._now_s = 0.0
        self._balises = Normals(streams.run_generator(seed, streams.RUN_BALISES, run_number))
        self._left_m = [task.stop_m - before_m for before_m in task.balises_m]
        self._noise = Normals(streams.run_generator(seed, streams.RUN_SPEED_NOISE, run_number))
        self._wander = Normals(streams.run_generator(seed, streams.RUN_WANDER, run_number))
        keep = exp(-SAMPLES * SAMPLE_S / task.wander_time_s)
        self._keep, self._add = keep, task.wander_sigma_mps * sqrt(1.0 - keep * keep)
        self._wander_mps = task.wander_sigma_mps * self._wander()
        #: The last five samples of the speed, mm/s.
        self.samples = [self._sample(run.start_mps) for _ in range(SAMPLES)]
        self._skip_balises()

    # -- commands -------------------------------------------------------------------------------------------------

    def command(self, accel_mps2: float, after_s: float = 0.0) -> None:
        """A target acceleration that is given some time after the present instant; it begins to act after the delay."""
        at_s = self._now_s + after_s + self.delay_s
        while self._coming and self._coming[-1][0] >= at_s:
            self._coming.pop()
        self._coming.append((at_s, accel_mps2))
        self._braking = accel_mps2 < 0.0

    def told_mps2(self) -> float:
        """Braking that the brake should do by now, <= 0: the target after the delay, without gain."""
        return min(self.target_mps2, 0.0)

    def _achieved_mps2(self) -> float:
        """What traction and brake make of the target: braking with its gain and notches."""
        target, notch = self.target_mps2, self._notch_mps2
        if self.emergency:
            return min(target, self._emergency_mps2)
        if target >= 0.0:
            return target
        if notch > 0.0:
            target = notch * round(target / notch)
        return self.gain * target

    # -- motion ---------------------------------------------------------------------------------------------------

    def advance(self) -> None:
        """Simulate one tick."""
        after_mps = self._keep * self._wander_mps + self._add * self._wander()
        wander_mps2 = 0.0 if self._braking else (after_mps - self._wander_mps) / (SAMPLES * SAMPLE_S)
        self._wander_mps = after_mps
        begun_s = self._now_s
        before_mps = self.motion.speed_mps
        self.samples = []
        for step in range(1, SAMPLES + 1):
            self._step(begun_s + step * SAMPLE_S, wander_mps2)
            self.samples.append(self._sample(self.motion.speed_mps))
        self.accel_mps2 = (self.motion.speed_mps - before_mps) / (SAMPLES * SAMPLE_S)

    def _step(self, until_s: float, wander_mps2: float) -> None:
        """Go on to an instant, piece by piece: a command begins to act, the grade changes, the braking fades."""
        while self._now_s < until_s:
            while self._coming and self._coming[0][0] <= self._now_s:
                self.target_mps2 = self._coming.popleft()[1]
            end_s = min(until_s, self._coming[0][0]) if self._coming else until_s
            self._piece_of_step(end_s, wander_mps2)

    def _piece_of_step(self, end_s: float, wander_mps2: float) -> None:
        """Go on with a constant target, at most to an instant."""
        motion, target, left_s = self.motion, self._achieved_mps2(), end_s - self._now_s
        grade = self._grades_mps2[self._piece]
        if motion.speed_mps == 0.0 and not (target > 0.0 and motion.drive_mps2 + grade > 0.0):
            # The brake holds a standing train.
            drive = moved(motion, target, 0.0, 0.0, self.lag_s, left_s).drive_mps2
            self.motion, self._now_s, self.slides = motion._replace(drive_mps2=drive), end_s, False
            return
        fades = motion.drive_mps2 < 0.0 and motion.speed_mps <= self.loss_below_mps
        factor = 1.0 - self.loss if fades else 1.0
        outside = grade + wander_mps2
        limit = self.run.adhesion_mps2
        self.slides = limit > 0.0 and -factor * motion.drive_mps2 > limit
        if self.slides:
            factor, outside = 0.0, outside - limit
        given = (target, factor, outside, self.lag_s)
        after = moved(motion, *given, left_s)
        slow_mps = self.loss_below_mps if self.loss > 0.0 and motion.speed_mps > self.loss_below_mps else 0.0
        if after.speed_mps < slow_mps or after.speed_mps <= 0.0:
            left_s = time_at_speed(motion, *given, left_s, slow_mps)
            after = moved(motion, *given, left_s)._replace(speed_mps=slow_mps)
        if self._piece < len(self._bounds_m) and after.position_m >= self._bounds_m[self._piece]:
            left_s = time_at_position(motion, *given, left_s, self._bounds_m[self._piece])
            after = moved(motion, *given, left_s)
            self._piece += 1
        while self._left_m and after.position_m >= self._left_m[0]:
            self._pass_balise()
        begun_s = self._now_s
        self._now_s = end_s if begun_s + left_s >= end_s else begun_s + left_s
        if after.speed_mps <= 0.0:
            after = after._replace(speed_mps=0.0)
            self.last_stop = Stopped(begun_s + left_s, after.position_m)
        self.motion = after

    # -- readings -------------------------------------------------------------------------------------------------

    @property
    def odometer_m(self) -> float:
        """Distance by the wheels since the start of the run."""
        return (self.motion.position_m - self._start_m) * (1.0 + self.wheel)

    def _sample(self, speed_mps: float) -> int:
        """A sample of the speed in mm/s; standing wheels give 0."""
        read_mps = speed_mps * (1.0 + self.wheel) + self.task.sensors.speed_noise_mps * self._noise()
        return min(max(round(read_mps * MM), 0), _SPEED_RAW_MAX) if speed_mps > 0.0 else 0

    def _skip_balises(self) -> None:
        """Balises behind the start of the run are not read."""
        while self._left_m and self._left_m[0] <= self.task.start_m:
            self._left_m.pop(0)

    def _pass_balise(self) -> None:
        at_m = self._left_m.pop(0)
        error_m = self.task.sensors.balise_sigma_m * self._balises()
        distance_m = (at_m - self.task.start_m + error_m) * (1.0 + self.wheel)
        self.passed = Passed(len(self.task.balises_m) - len(self._left_m), max(0.0, distance_m))
