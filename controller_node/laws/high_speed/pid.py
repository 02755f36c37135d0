"""PID on the speed error, and the same with the acceleration of the reference added: the baselines.

The papers give no gains; the defaults come from ``tune.py`` of this folder.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Generic, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.laws.high_speed.core import Core, Move, Sample, Unit
from railhil.controller_node.laws.high_speed.law import HighSpeedLaw, LawParameters
from railhil.controller_node.laws.high_speed.reals import Reals


@dataclass(frozen=True, slots=True)
class PidParameters(LawParameters):
    """Gains of the law; the error is w(k) - v(k)."""

    gain_per_s: Annotated[float, Field(ge=0, le=10)] = 0.4
    integral_per_s2: Annotated[float, Field(ge=0, le=10)] = 0.05
    derivative: Annotated[float, Field(ge=0, le=10)] = 0.0


@dataclass(frozen=True, slots=True)
class PidFfParameters(PidParameters):
    """Gains of the law with the acceleration of the reference."""

    #: Weight of (w(k+2) - w(k+1)) / T0.
    feed_forward: Annotated[float, Field(ge=0, le=2)] = 1.0


class PidState(NamedTuple, Generic[T]):
    """``errors``: e(k-1), e(k-2), m/s. ``command``: u(k-1) as limited, ``rise``: the feed-forward in it, m/s^2."""

    errors: tuple[T, ...]
    command: T
    rise: T


class PidCore(Core[T, PidState[T]]):
    """The incremental form, u(k) = u(k-1) + ...: with the limited u(k-1) it does not wind up."""

    def __init__(self, re: Reals[T], unit: Unit, parameters: PidParameters) -> None:
        super().__init__(re, unit, parameters)
        given, period_s = parameters, unit.sample_period_s
        proportional, derivative = given.gain_per_s, given.derivative / period_s
        on_now = proportional + given.integral_per_s2 * period_s + derivative
        self._gains = re.numbers("gain", (on_now, -proportional - 2.0 * derivative, derivative), "parameters")
        self._ahead = isinstance(given, PidFfParameters)
        self.horizon = 2 if self._ahead else 0
        weight = given.feed_forward if isinstance(given, PidFfParameters) else 0.0
        self._feed = re.number("feed_forward", weight / period_s, "parameters")

    def start(self, sample: Sample[T]) -> PidState[T]:
        zero = self.re.zero
        return PidState((zero, zero), zero, zero)

    def step(self, state: PidState[T], sample: Sample[T]) -> tuple[PidState[T], Move[T]]:
        re = self.re
        error = re.sub(sample.reference[0], sample.speed)
        errors = (error, *state.errors)
        command, rise = re.add(state.command, re.dot(self._gains, errors)), re.zero
        if self._ahead:
            rise = re.mul(self._feed, re.sub(sample.reference[2], sample.reference[1]))
            command = re.add(command, re.sub(rise, state.rise))
        command = re.clip(command, sample.lowest, sample.highest)
        return PidState(errors[:2], command, rise), Move(command, re.zero, re.zero, re.one, re.zero)

    def sent(self, state: PidState[T], command: T) -> PidState[T]:
        return state._replace(command=command)


class Pid(HighSpeedLaw[T]):
    """PID, without any preview of the reference."""

    name = "pid"
    parameters_type = PidParameters

    def core(self, re: Reals[T], unit: Unit, parameters: Any) -> PidCore[T]:
        return PidCore(re, unit, parameters)


class PidFf(Pid[T]):
    """PID with the acceleration of the reference."""

    name = "pid_ff"
    parameters_type = PidFfParameters
