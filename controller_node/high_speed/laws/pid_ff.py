"""PID with the acceleration of the reference added: the baseline that knows the preview too.

::

    u(k) = PID + ff (w(k+2) - w(k+1)) / T0
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from pydantic import Field

from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.high_speed.base import ACCEL_Q, SPEED_Q, LoopAnswer, LoopInputs
from railhil.controller_node.high_speed.laws.pid import Pid, PidParameters, PidState
from railhil.wire.power_units import PREVIEW_STEP_S

_GAIN_Q = 20


@dataclass(frozen=True)
class PidFfParameters(PidParameters):
    """Gains of the law with the acceleration of the reference."""

    kp_per_s: Annotated[float, Field(ge=0, le=10)] = 0.434
    ki_per_s2: Annotated[float, Field(ge=0, le=10)] = 0.0911
    kd: Annotated[float, Field(ge=0, le=10)] = 0.0133
    #: Weight of the acceleration of the reference.
    feed_forward: Annotated[float, Field(ge=0, le=2)] = 1.0
    #: The acceleration is taken between these two times ahead, s, multiples of the step of the preview.
    from_s: Annotated[float, Field(ge=0.25, le=3.25)] = 1.0
    to_s: Annotated[float, Field(ge=0.5, le=3.5)] = 2.0


class PidFf(Pid[T]):
    """See the module."""

    name = "pid_ff"
    parameters_type: ClassVar[type[Any]] = PidFfParameters

    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: PidFfParameters | None = None) -> None:
        super().__init__(arithmetic, scenario, parameters)
        given = self.given
        self._points = [round(ahead_s / PREVIEW_STEP_S) - 1 for ahead_s in (given.from_s, given.to_s)]
        span_s = (self._points[1] - self._points[0]) * PREVIEW_STEP_S
        if span_s <= 0.0:
            raise ValueError(f"to_s {given.to_s:g} must be later than from_s {given.from_s:g}")
        self._feed = self.hold("feed_forward", given.feed_forward / span_s, _GAIN_Q, "parameters")

    def loop_step(self, loop: int, state: PidState, inputs: LoopInputs[T]) -> tuple[PidState, LoopAnswer[T]]:
        ar = self.ar
        after, (accel, notes) = super().loop_step(loop, state, inputs)
        early, late = (inputs.preview[point] for point in self._points)
        rise = ar.clip(ar.sub(late, early), *self._far)
        fed = ar.mpy_iqx(rise, SPEED_Q, self._feed, _GAIN_Q, ACCEL_Q)
        return after, LoopAnswer(ar.add(accel, ar.note(f"fed[{loop}]", fed, ACCEL_Q, "m/s2")), notes)
