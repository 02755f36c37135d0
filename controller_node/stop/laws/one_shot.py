"""One brake command without filter and learning: the train holds its speed, and brakes at the point given by the model.

::

    m = (S - s) - f(v)      f(v) = v^2 / (2 a) + v (delay + lag) - a lag^2 / 2      brake at the first cycle with m <= 0
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.vector.law import Answer, VectorLaw
from railhil.controller_node.vector.reals import Reals
from railhil.wire.stop import Stage
from railhil.wire.stop_counts import MM, SAMPLES

#: Feedback of the speed while it is held.
_TRACK_PER_S = 0.4
_ODOMETER, _STANDSTILL = 8, 13


@dataclass(frozen=True)
class OneShotParameters:
    """None: the scenario gives all numbers."""


class OneShotState(NamedTuple):
    """The speed to hold (m/s), and whether the brake has been commanded."""

    held: Any
    brakes: Any


class OneShot(VectorLaw[T, OneShotState]):
    """See the module."""

    name = "one_shot"
    parameters_type = OneShotParameters
    floating = True

    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: Any = None) -> None:
        self.re = re = Reals(arithmetic)
        task, brake = scenario.task, scenario.task.brake
        self._mean = re.number("mean", 1.0 / (SAMPLES * MM), "port table")
        self._metres = re.number("metres", 1.0 / MM, "port table")
        self._counts = re.number("counts", MM, "port table")
        self._track = re.number("track", _TRACK_PER_S, "law")
        self._most = re.number("most", brake.traction_max_mps2, "scenario")
        self._brake = re.number("brake", -brake.braking_mps2, "scenario")
        self._run = re.number("run", task.stop_m - task.start_m, "scenario")
        self._square = re.number("square", 0.5 / brake.braking_mps2, "scenario")
        self._linear = re.number("linear", brake.delay_s + brake.lag_s, "scenario")
        self._fixed = re.number("fixed", -0.5 * brake.braking_mps2 * brake.lag_s**2, "scenario")
        self._stages = re.numbers("stage", (Stage.TRACK, Stage.BRAKE, Stage.STANDSTILL), "port table")

    @property
    def constants(self) -> tuple[Constant, ...]:
        return tuple(self.re.constants)

    def _speed(self, readings: Sequence[T]) -> T:
        return self.re.mul(self.re.add(*readings[:SAMPLES]), self._mean)

    def start(self, readings: Sequence[T]) -> OneShotState:
        return OneShotState(self._speed(readings), self.re.zero)

    def step(self, state: OneShotState, readings: Sequence[T]) -> tuple[OneShotState, Answer[T]]:
        re, ar = self.re, self.re.ar
        speed = ar.note("speed", self._speed(readings), 16, "m/s")
        left = re.sub(self._run, re.mul(readings[_ODOMETER], self._metres))
        distance = re.add(re.mul(re.mul(speed, speed), self._square), re.mul(speed, self._linear), self._fixed)
        margin = ar.note("left", re.sub(left, distance), 16, "m")
        brakes = ar.maximum(state.brakes, ar.where(re.gt(margin, re.zero), re.zero, re.one))
        track = re.clip(re.mul(re.sub(state.held, speed), self._track), self._brake, self._most)
        accel = ar.where(re.gt(brakes, re.zero), self._brake, track)
        moving, braking, standing = self._stages
        stage = ar.where(re.gt(brakes, re.zero), braking, moving)
        stage = ar.where(re.gt(readings[_STANDSTILL], re.zero), standing, stage)
        notes = (stage, *(re.mul(value, self._counts) for value in (margin, distance, re.zero, speed)))
        answer = Answer((re.mul(accel, self._counts), re.zero, re.one), (*notes, *(re.zero,) * 5))
        return OneShotState(state.held, brakes), answer
