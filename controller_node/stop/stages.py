"""The stages of a run, each from the stage of the last cycle, and the command of the stages before the brake."""

from __future__ import annotations

from typing import Any, Generic

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.stop.interface import Measured
from railhil.controller_node.stop.model import Grades
from railhil.controller_node.stop.numbers import ACCEL_Q, DISTANCE_Q, GAIN_Q, SPEED_Q, Numbers
from railhil.wire.stop import Stage

#: The brake is armed when it will begin within this distance, m.
_ARMED_M = 60.0
#: Speeds at which the train has started, and (below the speed of the approach) has reached it, m/s.
_MOVING_MPS, _REACHED_MPS = 0.5, 0.1


class Stages(Generic[T]):
    """The stages as numbers (Q0): other modules use ``idle``, ``armed``, ``braking``."""

    def __init__(self, numbers: Numbers[T]) -> None:
        self._numbers = numbers
        hold = numbers.hold
        self._all = [hold(f"stage_{stage.name.lower()}", stage, 0, "port table") for stage in Stage]
        self.idle, self.armed, self.braking = (self._all[n] for n in (Stage.IDLE, Stage.ARMED, Stage.BRAKE))
        self._reached = hold("reached", _REACHED_MPS, SPEED_Q, "law")
        self._moving = hold("moving", _MOVING_MPS, SPEED_Q, "law")
        self._armed_m = hold("armed", _ARMED_M, DISTANCE_Q, "law")

    def advance(
        self,
        stage: T,
        measured: Measured[T],
        speed: T,
        cruise: T,
        margin: T,
        refused: T,
        begins: T,
        learned: T,
        arrived: T,
    ) -> T:
        """The stage of this cycle.

        :param stage: of the last one. :param speed: estimated, m/s. :param cruise: that of the approach, m/s.
        :param margin: distance left before the brake has to begin, m. :param refused: 1 while the estimate must not
            start the brake. :param begins: 1 if the brake begins once it is armed. :param learned: 1 once the stop has
            been learned (all Q0). :param arrived: 1 if the train stands and has run (Q0).
        """
        ar, zero = self._numbers.ar, self._numbers.zero
        idle, begun, rising, tracking, armed, braking, stands, learnt = self._all
        moves, still = ar.gt(speed, self._moving), ar.gt(measured.standstill, zero)
        # A law may begin in a run under way, also while the train rolls to its stop or stands there.
        standing = ar.where(ar.gt(arrived, zero), stands, ar.where(ar.gt(measured.doors, zero), idle, begun))
        after = ar.where(moves, tracking, ar.where(still, standing, tracking))
        after = self._at(stage, begun, ar.where(moves, rising, begun), after)
        close = ar.gt(speed, ar.sub(cruise, self._reached))
        due = ar.gt(self._armed_m, margin)
        # A short run brakes before it has reached the speed of the approach.
        after = self._at(stage, rising, ar.where(close, tracking, ar.where(due, tracking, rising)), after)
        near = ar.where(due, armed, tracking)
        after = self._at(stage, tracking, ar.where(ar.gt(refused, zero), tracking, near), after)
        brakes = ar.where(ar.gt(begins, zero), braking, armed)
        after = self._at(stage, armed, ar.where(ar.gt(refused, zero), tracking, brakes), after)
        after = self._at(stage, braking, ar.where(still, stands, braking), after)
        # A train that has been stopped on its way stays as well: its doors open. One wrong telegram, which the speed
        # contradicts, must not stop it there.
        stopped = ar.where(ar.gt(measured.samples[-1], self._moving), after, ar.where(still, stands, after))
        after = self._at(stage, rising, stopped, after)
        after = self._at(stage, stands, ar.where(ar.gt(learned, zero), learnt, stands), after)
        after = ar.where(ar.gt(stage, stands), learnt, after)
        return ar.note("stage_now", after, 0)

    def _at(self, stage: T, which: T, then: T, other: T) -> T:
        """``then`` where the stage is ``which`` or later, else ``other``: applied in the order of the stages."""
        ar = self._numbers.ar
        return ar.where(ar.gt(which, stage), other, then)


#: Deviations of the speed are limited to this while it is held, m/s.
_FAR_MPS = 8.0
#: Acceleration from standstill, m/s2, and the jerk of all commands before the brake, m/s3.
_START_MPS2, _JERK_MPS3 = 0.6, 0.75
_HOLD_Q = GAIN_Q - 4


class Approach(Generic[T]):
    """Before the brake: holds a speed against grade and deviations, with limited jerk.

    It is the speed at which the run began, or the scenario's in a run from standstill.

    :param task: a :class:`railhil.systems.stop.task.StopTask`. :param hold_per_s: gain on a deviation, 1/s.
    """

    def __init__(self, numbers: Numbers[T], grades: Grades[T], task: Any, hold_per_s: float, period_s: float) -> None:
        self._numbers, self._grades = numbers, grades
        hold = numbers.hold
        self._standing = task.start_kmh == 0.0
        self._planned = hold("approach", task.approach_kmh / 3.6, SPEED_Q, "scenario")
        self._hold = hold("hold", hold_per_s, _HOLD_Q, "parameters")
        self._far = [hold("far", _FAR_MPS, SPEED_Q, "law"), hold("minus_far", -_FAR_MPS, SPEED_Q, "law")]
        self._pull = [hold("pull", _START_MPS2, ACCEL_Q, "law"), hold("minus_pull", -_START_MPS2, ACCEL_Q, "law")]
        jerk = _JERK_MPS3 * period_s
        self._jerk = [hold("jerk", jerk, ACCEL_Q, "law"), hold("minus_jerk", -jerk, ACCEL_Q, "law")]

    def start(self, speed: T) -> T:
        """The speed to hold before the first step, m/s, from the measured one."""
        return self._planned if self._standing else speed

    def hold_speed(self, left: T) -> T:
        """The command with which a train that runs keeps its speed, m/s2; 0 for one that stands.

        :param left: distance to the stopping point, m.
        """
        if self._standing:
            return self._numbers.hold("no_accel", 0.0, ACCEL_Q, "law")
        return self._numbers.ar.neg(self._grades.at(left))

    def speed(self, cruise: T, speed: T, before: T, warm: T) -> T:
        """The speed to hold, m/s: the run's speed when the estimate was first warm.

        :param cruise: of the last cycle. :param before, warm: 1 once it has been warm, in the last and this cycle (Q0).
        """
        if self._standing:
            return cruise
        return self._numbers.ar.where(self._numbers.ar.gt(warm, before), speed, cruise)

    def command(self, cruise: T, speed: T, warm: T, left: T, last: T) -> T:
        """Command, m/s2. ``last``: of the last cycle, m/s2; ``left``: distance to the stopping point, m."""
        ar, zero = self._numbers.ar, self._numbers.zero
        far = ar.clip(ar.sub(cruise, speed), *self._far)
        kept = ar.mpy_iqx(far, SPEED_Q, self._hold, _HOLD_Q, ACCEL_Q)
        kept = kept if self._standing else ar.where(ar.gt(warm, zero), kept, zero)
        wanted = ar.sub(ar.clip(kept, *self._pull), self._grades.at(left))
        return ar.add(last, ar.clip(ar.sub(wanted, last), *self._jerk))
