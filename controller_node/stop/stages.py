"""The stages of a run (``Stage``), each from that of the last cycle: at most one change."""

from __future__ import annotations

from typing import Generic

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.stop.numbers import DISTANCE_Q, SPEED_Q, Numbers
from railhil.controller_node.stop.readings import Measured
from railhil.wire.stop import Stage

#: The brake is armed when it will begin within this distance, m.
_ARMED_M = 60.0
#: Speeds at which the train has started, and (below that of the approach) has reached it, m/s.
_MOVING_MPS, _REACHED_MPS = 0.5, 0.1


class Stages(Generic[T]):
    """The stages as numbers (Q0): ``idle``, ``armed``, ``braking`` are asked for elsewhere."""

    def __init__(self, numbers: Numbers[T]) -> None:
        self._numbers = numbers
        hold = numbers.hold
        self._all = [hold(f"stage_{stage.name.lower()}", stage, 0, "port table") for stage in Stage]
        self.idle, self.armed, self.braking = (self._all[n] for n in (Stage.IDLE, Stage.ARMED, Stage.BRAKE))
        self._reached = hold("reached", _REACHED_MPS, SPEED_Q, "law")
        self._moving = hold("moving", _MOVING_MPS, SPEED_Q, "law")
        self._armed_m = hold("armed", _ARMED_M, DISTANCE_Q, "law")

    def after(
        self, stage: T, measured: Measured[T], speed: T, cruise: T, margin: T, refused: T, begins: T, learned: T
    ) -> T:
        """The stage of this cycle.

        :param stage: of the last one. :param speed: estimated, m/s. :param cruise: that of the approach, m/s.
        :param margin: distance left before the brake has to begin, m. :param refused: 1 while the estimate is not one
            to brake by. :param begins: 1 if the brake begins once it is armed. :param learned: 1 once the stop has
            been learned (all Q0).
        """
        ar, zero = self._numbers.ar, self._numbers.zero
        idle, begun, rising, tracking, armed, braking, stands, learnt = self._all
        moves = ar.gt(speed, self._moving)
        after = ar.where(moves, tracking, ar.where(ar.gt(measured.doors, zero), idle, begun))
        after = self._at(stage, begun, ar.where(moves, rising, begun), after)
        close = ar.gt(speed, ar.sub(cruise, self._reached))
        due = ar.gt(self._armed_m, margin)
        # A short run brakes before it has reached the speed of the approach.
        after = self._at(stage, rising, ar.where(close, tracking, ar.where(due, tracking, rising)), after)
        near = ar.where(due, armed, tracking)
        after = self._at(stage, tracking, ar.where(ar.gt(refused, zero), tracking, near), after)
        brakes = ar.where(ar.gt(begins, zero), braking, armed)
        after = self._at(stage, armed, ar.where(ar.gt(refused, zero), tracking, brakes), after)
        still = ar.where(ar.gt(measured.standstill, zero), stands, braking)
        after = self._at(stage, braking, still, after)
        after = self._at(stage, stands, ar.where(ar.gt(learned, zero), learnt, stands), after)
        after = ar.where(ar.gt(stage, stands), learnt, after)
        return ar.note("stage_now", after, 0)

    def _at(self, stage: T, which: T, then: T, other: T) -> T:
        """``then`` where the stage is ``which`` or later, else ``other``: applied in the order of the stages."""
        ar = self._numbers.ar
        return ar.where(ar.gt(which, stage), other, then)
