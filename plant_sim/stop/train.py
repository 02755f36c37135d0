"""The simulated train of the system ``stop``, without a bus."""

from __future__ import annotations

from collections import deque
from math import exp, sqrt
from typing import Any, NamedTuple

from railhil.plant_sim.stop.brake import GRAVITY_MPS2, Course, Going, Motion, achieved, gone_on
from railhil.plant_sim.stop.draws import RunDraw, TrainDraw
from railhil.scenarios import streams
from railhil.wire.stop import SpeedRaw
from railhil.wire.stop_counts import CONTRACT, MM, SAMPLE_S, SAMPLES

TICK_S = SAMPLES * SAMPLE_S
SPEED_RAW_MAX = CONTRACT.port(SpeedRaw.PORT).signal("Speed5").raw_range[1]


class Passed(NamedTuple):
    """The last balise: id from 1 (0: none yet) and the distance by the wheels at it."""

    balise: int
    odometer_m: float


def course_of(task: Any, train: TrainDraw, run: RunDraw) -> Course:
    """Constants of a run.

    :param task: a :class:`railhil.systems.stop.task.StopTask`.
    """
    errors = zip(task.grade, train.map_errors_permil, strict=True)
    return Course(
        task.true.lag_s,
        task.true.low_speed_loss,
        task.true.low_speed_mps,
        run.adhesion_mps2,
        tuple(position_m for position_m, _ in task.grade[1:]),
        tuple(-GRAVITY_MPS2 * (permil + error) / 1000.0 for (_, permil), error in errors),
    )


def start_of(task: Any, course: Course, run: RunDraw) -> Going:
    """The train at the start of a run: it keeps its speed on the grade."""
    piece = sum(bound_m <= task.start_m for bound_m in course.bounds_m)
    steady = -course.grades_mps2[piece] if run.start_mps > 0.0 else 0.0
    return Going(0.0, Motion(task.start_m, run.start_mps, steady), piece, False, -1.0)


def wander_of(task: Any) -> tuple[float, float]:
    """Factors of the wander's last value and of a new normal number, for a step of a tick."""
    keep = exp(-TICK_S / task.wander_time_s)
    return keep, task.wander_sigma_mps * sqrt(1.0 - keep * keep)


class StopTrain:
    """The train at one instant; :meth:`advance` simulates a tick of five sub-steps.

    :param task: a :class:`railhil.systems.stop.task.StopTask`.
    :param seed, run_number: of the noise, the wander and the balises.
    """

    def __init__(self, task: Any, train: TrainDraw, run: RunDraw, seed: int, run_number: int) -> None:
        self.task, self.run = task, run
        self.gain, self.delay_s, self.wheel = run.gain, run.delay_s, train.wheel
        self.course = course_of(task, train, run)
        self.going = start_of(task, self.course, run)
        #: Its motion to an instant.
        self.gone_on = gone_on
        #: Mean acceleration of the train in the last tick.
        self.accel_mps2 = 0.0
        #: The command that acts now, and the commands on their way: instant and acceleration.
        self.target_mps2 = self.motion.drive_mps2
        self._coming: deque[tuple[float, float]] = deque()
        #: The emergency brake acts.
        self.emergency = False
        self._braking = False
        self.passed = Passed(0, 0.0)
        self._notch_mps2: float = task.brake.notch_mps2
        self._emergency_mps2: float = -task.emergency_braking_mps2
        self._start_m: float = task.start_m
        self._noise_mps: float = task.sensors.speed_noise_mps
        self._balises = streams.NormalSequence(streams.run_generator(seed, streams.RUN_BALISES, run_number))
        # Balises before the start of the run are not read.
        self._left_m = [at_m for before_m in task.balises_m if (at_m := task.stop_m - before_m) > task.start_m]
        self._noise = streams.NormalSequence(streams.run_generator(seed, streams.RUN_SPEED_NOISE, run_number))
        self._wander = streams.NormalSequence(streams.run_generator(seed, streams.RUN_WANDER, run_number))
        self._keep, self._add = wander_of(task)
        self._wander_mps: float = task.wander_sigma_mps * self._wander()
        #: The last five samples of the speed, mm/s.
        self.samples = [self._sample(run.start_mps) for _ in range(SAMPLES)]

    @property
    def motion(self) -> Motion:
        """Position, speed and acceleration by traction and brake."""
        return self.going.motion

    @property
    def slides(self) -> bool:
        """Whether the adhesion limits the brake."""
        return self.going.slides

    @property
    def stopped_s(self) -> float | None:
        """Instant at which the train last came to a stand, since the start of the run; None: it has not."""
        return self.going.stopped_s if self.going.stopped_s >= 0.0 else None

    # -- commands -------------------------------------------------------------------------------------------------

    def command(self, accel_mps2: float, after_s: float = 0.0) -> None:
        """Give a target acceleration some time after the present instant; it begins to act after the delay."""
        at_s = self.going.now_s + after_s + self.delay_s
        while self._coming and self._coming[-1][0] >= at_s:
            self._coming.pop()
        self._coming.append((at_s, accel_mps2))
        self._braking = accel_mps2 < 0.0

    def told_mps2(self) -> float:
        """Braking that the brake should do by now, <= 0: the target after the delay, without gain."""
        return min(self.target_mps2, 0.0)

    def achieved_mps2(self) -> float:
        """Acceleration of traction and brake for the target."""
        if self.emergency:
            return min(self.target_mps2, self._emergency_mps2)
        return achieved(self.target_mps2, self.gain, self._notch_mps2)

    # -- motion ---------------------------------------------------------------------------------------------------

    def advance(self) -> None:
        """Simulate one tick."""
        after_mps = self._keep * self._wander_mps + self._add * self._wander()
        wander_mps2 = 0.0 if self._braking else (after_mps - self._wander_mps) / TICK_S
        self._wander_mps = after_mps
        begun_s, before_mps = self.going.now_s, self.motion.speed_mps
        self.samples = []
        for step in range(1, SAMPLES + 1):
            self._step(begun_s + step * SAMPLE_S, wander_mps2)
            self.samples.append(self._sample(self.motion.speed_mps))
        self.accel_mps2 = (self.motion.speed_mps - before_mps) / TICK_S

    def _step(self, until_s: float, wander_mps2: float) -> None:
        """Move to an instant, piece by piece: a command begins to act, the grade changes, the braking fades."""
        while self.going.now_s < until_s:
            while self._coming and self._coming[0][0] <= self.going.now_s:
                self.target_mps2 = self._coming.popleft()[1]
            end_s = min(until_s, self._coming[0][0]) if self._coming else until_s
            self.going = self.gone_on(self.course, self.going, self.achieved_mps2(), wander_mps2, end_s)
            while self._left_m and self.motion.position_m >= self._left_m[0]:
                self._pass_balise()

    # -- readings -------------------------------------------------------------------------------------------------

    @property
    def odometer_m(self) -> float:
        """Distance by the wheels since the start of the run."""
        return (self.motion.position_m - self._start_m) * (1.0 + self.wheel)

    def _sample(self, speed_mps: float) -> int:
        """A sample of the speed in mm/s; standing wheels give 0."""
        read_mps = speed_mps * (1.0 + self.wheel) + self._noise_mps * self._noise()
        return min(max(round(read_mps * MM), 0), SPEED_RAW_MAX) if speed_mps > 0.0 else 0

    def _pass_balise(self) -> None:
        at_m = self._left_m.pop(0)
        error_m = self.task.sensors.balise_sigma_m * self._balises()
        distance_m = (at_m - self._start_m + error_m) * (1.0 + self.wheel)
        self.read_balise(Passed(len(self.task.balises_m) - len(self._left_m), max(0.0, distance_m)))

    def read_balise(self, passed: Passed) -> None:
        """Note a balise that the reader has passed."""
        self.passed = passed
