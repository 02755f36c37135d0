"""DelayGPC: our law. Prediction with the exact delays, a Kalman filter of [v, d, K], horizon counted after the delay.

The command of a side is a plan plus a correction. The plan is the acceleration of the reference at the time when the
command acts, less the estimated disturbance, by the estimated effectiveness: the steady command of D6 along the whole
preview. The predicted speeds with that plan leave errors, of which the correction, a constant added to the command,
removes the part that least squares with the weight lambda on it allow. Errors before the delay is over have no weight.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Generic, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.laws.high_speed.core import Core, Move, Sample, Unit
from railhil.controller_node.laws.high_speed.delay_line import DelayLines, step_response
from railhil.controller_node.laws.high_speed.kalman import Belief, Noise, corrected, predicted
from railhil.controller_node.laws.high_speed.law import CoreLaw, LawParameters
from railhil.controller_node.laws.high_speed.loop import refuse_short_horizon
from railhil.controller_node.laws.high_speed.reals import Reals

_SIDES = ("traction", "braking")


@dataclass(frozen=True)
class DelayGpcParameters(LawParameters):
    """Parameters of the law."""

    sample_period_s: Annotated[float, Field(gt=0, le=10)] = 0.2
    #: N: 3.2 s, within the preview of 3.5 s.
    horizon: Annotated[int, Field(ge=1, le=17)] = 16
    #: lambda, on the correction.
    control_weight: Annotated[float, Field(ge=0, le=1e5)] = 30.0
    #: Half the span over which the acceleration of the reference is taken, s.
    slope_span_s: Annotated[float, Field(ge=0.1, le=2)] = 0.4
    #: Standard deviations: of a reading, and of the steps of speed, disturbance and effectiveness in one second.
    reading_sigma_mps: Annotated[float, Field(gt=0, le=1)] = 0.02
    speed_walk_mps: Annotated[float, Field(ge=0, le=1)] = 0.004
    disturbance_walk_mps2: Annotated[float, Field(ge=0, le=1)] = 0.006
    gain_walk: Annotated[float, Field(ge=0, le=1)] = 0.02
    #: Standard deviations at the start.
    disturbance_sigma_mps2: Annotated[float, Field(ge=0, le=1)] = 0.05
    gain_sigma: Annotated[float, Field(ge=0, le=1)] = 0.1
    #: Limits of the estimated effectiveness.
    gain_limits: tuple[Annotated[float, Field(gt=0, le=10)], Annotated[float, Field(gt=0, le=10)]] = (0.4, 2.0)


class DelayState(NamedTuple, Generic[T]):
    """Past commands, newest first (m/s^2); acceleration of the lag now; belief after the last reading."""

    commands: tuple[T, ...]
    accel: T
    belief: Belief[T]


class DelayCore(Core[T, DelayState[T]]):
    """Estimation, plan, prediction and correction in each sample."""

    def __init__(self, re: Reals[T], unit: Unit, parameters: DelayGpcParameters) -> None:
        super().__init__(re, unit, parameters)
        given, period_s = parameters, unit.sample_period_s
        delays_s = (unit.traction_delay_s, unit.braking_delay_s)
        self._lines = DelayLines(re, delays_s, unit.lag_s, period_s)
        self._count = given.horizon
        root = period_s**0.5
        self._noise = Noise(
            re.number("reading_variance", given.reading_sigma_mps**2, "parameters"),
            re.number("speed_variance", (given.speed_walk_mps * root) ** 2, "parameters"),
            re.number("disturbance_variance", (given.disturbance_walk_mps2 * root) ** 2, "parameters"),
            re.number("gain_variance", (given.gain_walk * root) ** 2, "parameters"),
        )
        self._first = (given.reading_sigma_mps**2, given.disturbance_sigma_mps2**2, given.gain_sigma**2)
        self._period = re.number("period", period_s, "T0")
        self._weight = re.number("control_weight", given.control_weight, "lambda, parameters")
        self._gains = re.numbers("gain_limit", given.gain_limits, "parameters")
        times_s = [j * period_s for j in range(1, given.horizon + 1)]
        responses = [step_response(delay_s, unit.lag_s, times_s) for delay_s in delays_s]
        self._responses = [re.numbers(f"{name}_step", s) for name, s in zip(_SIDES, responses, strict=True)]
        self._squares = [
            re.number(f"{name}_square", sum(x * x for x in s)) for name, s in zip(_SIDES, responses, strict=True)
        ]
        # Centre of the time in which a command acts, in periods after it was computed, and half the span around it.
        self._centres = [(delay_s + unit.lag_s) / period_s + 0.5 for delay_s in delays_s]
        self._half = max(1, round(given.slope_span_s / period_s))
        self._per_span = re.number("per_span", 0.5 / (self._half * period_s), "parameters")
        self.horizon = given.horizon
        self._shares = [
            re.numbers(f"{name}_share", (1.0 - c % 1.0, c % 1.0)) for name, c in zip(_SIDES, self._centres, strict=True)
        ]

    def start(self, sample: Sample[T]) -> DelayState[T]:
        re, zero = self.re, self.re.zero
        vv, dd, kk = re.numbers("first_variance", self._first, "parameters")
        belief = Belief(sample.speed, zero, re.one, (vv, zero, zero, dd, zero, kk))
        return DelayState((zero,) * self._lines.count, zero, belief)

    def step(self, state: DelayState[T], sample: Sample[T]) -> tuple[DelayState[T], Move[T]]:
        re = self.re
        # The period that has passed: it began when u(k-1), the first of the past commands, was computed.
        rolled = self._lines.roll(state.accel, self._lines.parts(state.commands), 0)
        before = predicted(re, state.belief, rolled.gained, self._period, self._noise)
        belief, innovation = corrected(re, before, sample.speed, self._noise)
        gain = re.clip(belief.gain, *self._gains)
        belief = belief._replace(gain=gain)
        plans = self._plans(sample, belief)
        errors = self._errors(state.commands, rolled.accel, plans, belief, sample)
        command = self._command(plans, errors, gain, sample)
        after = DelayState((command, *state.commands[:-1]), rolled.accel, belief)
        return after, Move(command, innovation.error, re.mul(belief.disturbance, self._period), gain, re.zero)

    def _plans(self, sample: Sample[T], belief: Belief[T]) -> tuple[list[T], list[T]]:
        """Steady commands of both sides now and in the following samples of the horizon, m/s^2."""
        re, reference, last = self.re, sample.reference, len(sample.reference) - 1
        per_gain = re.div(re.one, belief.gain)
        slopes = []
        for place in range(last + 1):
            late, early = min(place + self._half, last), max(min(place, last - self._half) - self._half, 0)
            rise = re.mul(re.sub(reference[late], reference[early]), self._per_span)
            slopes.append(rise)
        plans: tuple[list[T], list[T]] = ([], [])
        for side, plan in enumerate(plans):
            for i in range(self._count):
                place = min(int(self._centres[side]) + i, last - 1)
                slope = re.dot(self._shares[side], slopes[place : place + 2])
                plan.append(re.mul(re.sub(slope, belief.disturbance), per_gain))
        return plans

    def _errors(
        self, past: tuple[T, ...], accel: T, plans: tuple[list[T], list[T]], belief: Belief[T], sample: Sample[T]
    ) -> list[T]:
        """w - v over the horizon if the plans are carried out, m/s."""
        re, ar, lines = self.re, self.re.ar, self._lines
        traction, braking = plans
        planned = [
            (ar.maximum(up, re.zero), ar.minimum(down, re.zero)) for up, down in zip(traction, braking, strict=True)
        ]
        old_up, old_down = lines.parts(past)
        ups = (*(up for up, _ in reversed(planned)), *old_up)
        downs = (*(down for _, down in reversed(planned)), *old_down)
        errors = []
        # Relative to the estimated speed, so that float32 keeps its digits.
        speed = re.zero
        drift = re.mul(self._period, belief.disturbance)
        for j in range(1, self._count + 1):
            rolled = lines.roll(accel, (ups, downs), self._count - j)
            accel = rolled.accel
            speed = re.add(speed, re.add(drift, re.mul(rolled.gained, belief.gain)))
            errors.append(re.sub(re.sub(sample.reference[j], belief.speed), speed))
        return errors

    def _command(self, plans: tuple[list[T], list[T]], errors: list[T], gain: T, sample: Sample[T]) -> T:
        """Plan and correction of each side: traction if its own is positive, braking if its own is negative."""
        re = self.re
        square = re.mul(gain, gain)
        sides = []
        for side, plan in enumerate(plans):
            scale = re.add(re.mul(square, self._squares[side]), self._weight)
            correction = re.div(re.mul(gain, re.dot(self._responses[side], errors)), scale)
            sides.append(re.add(plan[0], correction))
        up, down = re.ar.maximum(sides[0], re.zero), re.ar.minimum(sides[1], re.zero)
        return re.clip(re.add(up, down), sample.lowest, sample.highest)

    def sent(self, state: DelayState[T], command: T) -> DelayState[T]:
        return state._replace(commands=(command, *state.commands[1:]))


class DelayGpc(CoreLaw[T]):
    """See the module."""

    name = "delay_gpc"
    parameters_type = DelayGpcParameters
    parameters_origin = "ours"

    def core(self, re: Reals[T], unit: Unit, parameters: Any) -> DelayCore[T]:
        refuse_short_horizon(self.name, parameters, max(unit.traction_delay_s, unit.braking_delay_s))
        return DelayCore(re, unit, parameters)
