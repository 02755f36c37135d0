"""Before the brake: the speed of the approach is held against grade and deviations, with limited jerk."""

from __future__ import annotations

from typing import Any, Generic

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.stop.model import Grades
from railhil.controller_node.stop.numbers import ACCEL_Q, GAIN_Q, SPEED_Q, Numbers

#: Deviations of the speed are limited to this while it is held, m/s.
_FAR_MPS = 8.0
#: Acceleration from standstill, m/s2, and the jerk of all commands before the brake, m/s3.
_START_MPS2, _JERK_MPS3 = 0.6, 0.75
_HOLD_Q = GAIN_Q - 4


class Approach(Generic[T]):
    """Holds a speed: that at which the run began, or in a run from standstill that of the scenario.

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

    def steady(self, left: T) -> T:
        """The command with which a train that runs keeps its speed, m/s2; 0 for one that stands.

        :param left: distance to the stopping point, m.
        """
        if self._standing:
            return self._numbers.hold("no_accel", 0.0, ACCEL_Q, "law")
        return self._numbers.ar.neg(self._grades.at(left))

    def speed(self, cruise: T, speed: T, before: T, warm: T) -> T:
        """The speed to hold, m/s: that of the run when the estimate was first warm.

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
