"""PID control of the speed, the comparator of both papers, which print no gains.

::

    u(k) = clip(kp e(k) + i(k) + kd (e(k) - e(k-1)) / T0)        i(k) = clip(i(k-1) + ki T0 e(k))        e = w - v

It also drives the runs whose records networks are trained on: a square wave can be added to its commands. Without it
the record holds only the effect of the law's own feedback, and a network trained on it controls badly (D14).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.high_speed.base import (
    ACCEL_Q,
    SPEED_Q,
    HighSpeedLaw,
    HighSpeedParameters,
    LoopAnswer,
    LoopInputs,
)

_GAIN_Q = 20
#: Errors are limited to this, m/s: beyond it every command is at its limit.
_FAR_MPS = 20.0


@dataclass(frozen=True)
class PidParameters(HighSpeedParameters):
    """Gains on the error of the speed (m/s)."""

    kp_per_s: Annotated[float, Field(ge=0, le=10)] = 0.587
    ki_per_s2: Annotated[float, Field(ge=0, le=10)] = 0.160
    kd: Annotated[float, Field(ge=0, le=10)] = 0.214
    #: Square wave added to each command, and half its period in samples.
    dither_mps2: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    dither_samples: Annotated[int, Field(ge=1, le=100)] = 3


class PidState(NamedTuple):
    """Integral part (m/s2), last error (m/s); with dither also the samples since the wave changed, and the wave."""

    integral: Any
    error: Any
    wave: tuple[Any, ...] = ()


class Pid(HighSpeedLaw[T, PidState]):
    """See the module."""

    name = "pid"
    parameters_type: ClassVar[type[Any]] = PidParameters
    parameters_origin = "railhil.systems.high_speed.tuning; the papers print none"
    design_seeds: ClassVar[Mapping[str, range]] = {"jinan_xuzhou": range(100, 101)}
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {
        "kp_per_s": (0.05, 5.0),
        "ki_per_s2": (0.005, 2.0),
        "kd": (0.0, 2.0),
    }

    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: PidParameters | None = None) -> None:
        super().__init__(arithmetic, scenario, parameters)
        given, sample_s = self.given, self.sample_s
        self._proportional = self.hold("kp", given.kp_per_s, _GAIN_Q, "parameters")
        self._integral = self.hold("ki_sample", given.ki_per_s2 * sample_s, _GAIN_Q, "parameters")
        self._differential = self.hold("kd_by_sample", given.kd / sample_s, _GAIN_Q, "parameters")
        # With the wave it makes records. They equal the records of the shipped networks to the last bit: no holding
        # brake, and an error of two rounded speeds.
        self.holds = not given.dither_mps2
        self._wave: tuple[T, ...] = ()
        if given.dither_mps2:
            self._wave = self.zero, self.hold("dither", given.dither_mps2, ACCEL_Q, "parameters")
            self._samples = self.hold("dither_samples", given.dither_samples, 0, "parameters")
            self._next = self.hold("next_sample", 1.0, 0, "law")
        self._far = self.hold("far", _FAR_MPS, SPEED_Q, "law"), self.hold("minus_far", -_FAR_MPS, SPEED_Q, "law")

    def loop_start(self, loop: int, inputs: LoopInputs[T]) -> PidState:
        return PidState(self.zero, self._error(inputs), self._wave)

    def _error(self, inputs: LoopInputs[T]) -> T:
        error = self.ar.sub(inputs.target, inputs.speed) if self._wave else inputs.error
        return self.ar.clip(error, *self._far)

    def loop_step(self, loop: int, state: PidState, inputs: LoopInputs[T]) -> tuple[PidState, LoopAnswer[T]]:
        ar = self.ar
        error = ar.note(f"error[{loop}]", self._error(inputs), SPEED_Q, "m/s")
        part = ar.mpy_iqx(error, SPEED_Q, self._integral, _GAIN_Q, ACCEL_Q)
        integral = ar.clip(ar.add(state.integral, ar.clip(part, self.most, self.least)), self.most, self.least)
        ar.note(f"integral[{loop}]", integral, ACCEL_Q, "m/s2")
        accel = ar.add(integral, ar.mpy_iqx(error, SPEED_Q, self._proportional, _GAIN_Q, ACCEL_Q))
        change = ar.sub(error, state.error)
        accel = ar.add(accel, ar.mpy_iqx(change, SPEED_Q, self._differential, _GAIN_Q, ACCEL_Q))
        if not state.wave:
            return PidState(integral, error), LoopAnswer(accel, self.no_notes())
        samples, wave = state.wave
        counted = ar.minimum(ar.add(samples, self._next), self._samples)
        over = ar.gt(self._samples, counted)
        after = ar.where(over, counted, self.zero), ar.where(over, wave, ar.neg(wave))
        return PidState(integral, error, after), LoopAnswer(ar.add(accel, wave), self.no_notes())
