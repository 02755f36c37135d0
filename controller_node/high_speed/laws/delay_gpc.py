"""DelayGPC: our law. Prediction with the exact delays, a Kalman filter of [v, d, K], horizon counted after the delay.

The command of a side is a plan plus a correction. The plan is the acceleration of the reference at the time when the
command acts, less the estimated disturbance, by the estimated effectiveness: the steady command of D6 along the whole
preview. With that plan and the last correction the predicted speeds leave errors; GPC with the weight lambda on the
increments of the correction removes them. Errors before the delay is over cannot be changed and have no weight.

The delay is estimated by a bank of such filters, one for each extra delay (``delay_bank``); the one whose predictions
were best for some time is used.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Annotated, Any, ClassVar, Generic, NamedTuple

import numpy as np
from pydantic import Field

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.arithmetic.float64 import Float64
from railhil.controller_node.high_speed.delay_bank import Bank, BankParameters, Belief, DelayBank, Found, steady_gains
from railhil.controller_node.high_speed.delay_line import DelayLines, step_response
from railhil.controller_node.high_speed.law import (
    JOURNEYS,
    LawParameters,
    LoopController,
    LoopControllerLaw,
    Move,
    Sample,
    Unit,
)
from railhil.controller_node.high_speed.model import Matrix
from railhil.controller_node.high_speed.stability import (
    Train,
    magnitude,
    refuse_short_horizon,
    refuse_unstable,
    transition,
)
from railhil.controller_node.vector.reals import Reals

_SIDES = ("traction", "braking")


@dataclass(frozen=True)
class DelayGpcParameters(BankParameters, LawParameters):
    """Parameters of the law."""

    sample_period_s: Annotated[float, Field(gt=0, le=10)] = 0.2
    #: N: 3.2 s, within the preview of 3.5 s.
    horizon: Annotated[int, Field(ge=1, le=17)] = 16
    #: Nu.
    control_horizon: Annotated[int, Field(ge=1, le=10)] = 4
    #: lambda, on the increments of the correction.
    control_weight: Annotated[float, Field(gt=0, le=1e4)] = 4.0
    #: lambda from the trigger of an emergency on, when the predicted error is large and comfort does not matter.
    emergency_weight: Annotated[float, Field(gt=0, le=1e4)] = 0.5
    #: Half the span over which the acceleration of the reference is taken, s.
    slope_span_s: Annotated[float, Field(ge=0.1, le=1)] = 0.4


class DelayState(NamedTuple, Generic[T]):
    """Past commands, newest first, and the last correction (m/s^2); the filters."""

    commands: tuple[T, ...]
    correction: T
    bank: Bank[T]


def error_weights(response: Sequence[float], control_horizon: int, weight: float) -> tuple[float, ...]:
    """First row of (G'G + lambda I)^-1 G' for increments of the command, from the response to its first one."""
    size = len(response)
    columns = np.zeros((size, control_horizon))
    for i in range(control_horizon):
        columns[i:, i] = response[: size - i]
    inner = columns.T @ columns + weight * np.eye(control_horizon)
    return tuple(float(x) for x in np.linalg.solve(inner, columns.T)[0])


class DelayController(LoopController[T, DelayState[T]]):
    """Estimation, plan, prediction and correction in each sample."""

    def __init__(self, re: Reals[T], unit: Unit, parameters: DelayGpcParameters) -> None:
        super().__init__(re, unit, parameters)
        given, period_s = parameters, unit.sample_period_s
        delays_s = (unit.traction_delay_s, unit.braking_delay_s)
        self.horizon = given.horizon
        self._bank = DelayBank(re, unit, given)
        self.lines: DelayLines[T] = self._bank.lines
        self.nominal, self.noise = self._bank.nominal, self._bank.noise
        self._period = re.number("period", period_s, "T0")
        self._half = max(1, round(given.slope_span_s / period_s))
        self._per_span = re.number("per_span", 0.5 / (self._half * period_s), "parameters")
        # For each extra delay and each side: the law's weights on the errors, and the centre of the time in which a
        # command acts (in periods after its computation).
        times_s = [j * period_s for j in range(1, given.horizon + 1)]
        self._laws: list[tuple[tuple[T, ...], ...]] = []
        self._urgent_laws: list[tuple[tuple[T, ...], ...]] = []
        self._centres: list[list[float]] = []
        for extra_s in self._bank.extra_s:
            total_s = [delay_s + extra_s for delay_s in delays_s]
            responses = [step_response(delay_s, unit.lag_s, times_s) for delay_s in total_s]
            for laws, kind, weight in (
                (self._laws, "", given.control_weight),
                (self._urgent_laws, "urgent_", given.emergency_weight),
            ):
                laws.append(
                    tuple(
                        re.numbers(f"{kind}{name}_{extra_s:g}s", error_weights(s, given.control_horizon, weight))
                        for name, s in zip(_SIDES, responses, strict=True)
                    )
                )
            self._centres.append([(delay_s + unit.lag_s) / period_s + 0.5 for delay_s in total_s])
        # The fraction is the same for every extra delay, which is a whole number of periods.
        shares = [center % 1.0 for center in self._centres[0]]
        self._shares = [re.numbers(f"{name}_share", (1.0 - x, x)) for name, x in zip(_SIDES, shares, strict=True)]

    def start(self, sample: Sample[T]) -> DelayState[T]:
        zero = self.re.zero
        return DelayState((zero,) * self.lines.count, zero, self._bank.start(sample.speed))

    def step(self, state: DelayState[T], sample: Sample[T]) -> tuple[DelayState[T], Move[T]]:
        re = self.re
        filters, found = self._bank.step(state.bank, state.commands, sample.speed)
        command, correction = self.compute_command(state.commands, state.correction, found, sample)
        after = DelayState((command, *state.commands[:-1]), correction, filters)
        xi = re.mul(found.belief.disturbance, self._period)
        return after, Move(command, found.error, xi, found.belief.gain, found.delay)

    def compute_command(self, past: tuple[T, ...], last: T, found: Found[T], sample: Sample[T]) -> tuple[T, T]:
        """Command and correction, m/s^2.

        :param past: u(k-1), u(k-2), ...; ``last``: correction of the last sample.
        """
        re, bank, belief = self.re, self._bank, found.belief
        plans = self._plans(sample, belief, found.chosen)
        errors = self._errors(past, found.accel, plans, last, belief, sample, found.chosen)
        per_gain = re.div(re.one, belief.gain)
        urgent = re.gt(sample.emergency, re.zero)
        laws = re.select(urgent, bank.pick(found.chosen, self._urgent_laws), bank.pick(found.chosen, self._laws))
        sides = [
            re.add(plan[0], last, re.mul(per_gain, re.dot(law, errors))) for plan, law in zip(plans, laws, strict=True)
        ]
        command = re.clip(self._joined(*sides), sample.lowest, sample.highest)
        return command, re.sub(command, self._joined(plans[0][0], plans[1][0]))

    def _plans(self, sample: Sample[T], belief: Belief[T], chosen: Sequence[Any]) -> tuple[tuple[T, ...], ...]:
        """Steady commands of both sides, now and in the following samples of the horizon, m/s^2."""
        re, reference, last = self.re, sample.reference, len(sample.reference) - 1
        first = min(int(center) for center in self._centres[0])
        slopes: dict[int, T] = {}
        for place in range(first, last + 1):
            late = min(place + self._half, last)
            early = max(late - 2 * self._half, 0)
            slopes[place] = re.mul(re.sub(reference[late], reference[early]), self._per_span)
        per_gain = re.div(re.one, belief.gain)
        plans = []
        for side, shares in enumerate(self._shares):
            options = []
            for centres in self._centres:
                places = [min(int(centres[side]) + i, last - 1) for i in range(self.horizon)]
                options.append(tuple(re.dot(shares, (slopes[place], slopes[place + 1])) for place in places))
            wanted = self._bank.pick(chosen, options)
            plans.append(tuple(re.mul(re.sub(slope, belief.disturbance), per_gain) for slope in wanted))
        return tuple(plans)

    def _errors(
        self,
        past: tuple[T, ...],
        accel: T,
        plans: tuple[tuple[T, ...], ...],
        correction: T,
        belief: Belief[T],
        sample: Sample[T],
        chosen: Sequence[Any],
    ) -> list[T]:
        """w - v over the horizon if the plans are carried out with the last correction, m/s."""
        re, ar, lines, count = self.re, self.re.ar, self.lines, self.horizon
        old_up, old_down = lines.parts(past)
        traction = (*(ar.maximum(re.add(u, correction), re.zero) for u in reversed(plans[0])), *old_up)
        braking = (*(ar.minimum(re.add(u, correction), re.zero) for u in reversed(plans[1])), *old_down)
        length = count + lines.whole_max + 1
        seen = self._bank.pick(
            chosen,
            [(traction[shift : shift + length], braking[shift : shift + length]) for shift in self._bank.shifts],
        )
        errors = []
        # Relative to the estimated speed, so that float32 keeps its digits.
        gained = re.zero
        drift = re.mul(self._period, belief.disturbance)
        for j in range(1, count + 1):
            rolled = lines.roll(accel, seen, count - j)
            accel = rolled.accel
            gained = re.add(gained, re.add(drift, re.mul(rolled.gained, belief.gain)))
            errors.append(re.sub(re.sub(sample.reference[j], belief.speed), gained))
        return errors

    def _joined(self, traction: T, braking: T) -> T:
        """One command from those of both sides: traction if its own is positive, braking if its own is negative."""
        ar, zero = self.re.ar, self.re.zero
        return self.re.add(ar.maximum(traction, zero), ar.minimum(braking, zero))

    def sent(self, state: DelayState[T], command: T) -> DelayState[T]:
        return state._replace(commands=(command, *state.commands[1:]))


class DelayGpc(LoopControllerLaw[T]):
    """See the module."""

    name = "delay_gpc"
    parameters_type = DelayGpcParameters
    parameters_origin = "ours"
    design_seeds: ClassVar[Mapping[str, range]] = dict.fromkeys(JOURNEYS, range(1, 204))
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {
        "control_weight": (0.5, 50.0),
        "disturbance_walk_mps2": (0.0005, 0.05),
        "speed_walk_mps": (0.0005, 0.05),
        "gain_walk": (0.002, 0.2),
    }

    def make_controller(self, re: Reals[T], unit: Unit, parameters: Any) -> DelayController[T]:
        refuse_short_horizon(self.name, parameters, max(unit.traction_delay_s, unit.braking_delay_s))
        controller = DelayController(re, unit, parameters)
        refuse_unstable(self.name, parameters, radii(unit, parameters))
        return controller


@cache
def radii(unit: Unit, parameters: DelayGpcParameters) -> Mapping[str, float]:
    """Spectral radius of the closed loop with the nominal train in each mode, before and in an emergency."""
    found = {}
    for mode, delay_s in (("traction", unit.traction_delay_s), ("braking", unit.braking_delay_s)):
        sides = replace(unit, traction_delay_s=delay_s, braking_delay_s=delay_s)
        controller = DelayController(Reals(Float64()), sides, parameters)
        gains = steady_gains(controller.re, unit.sample_period_s, controller.noise)
        train = Train(delay_s, unit.lag_s)
        found[mode] = loop_radius(controller, train, gains, emergency=False)
        found[f"{mode} in an emergency"] = loop_radius(controller, train, gains, emergency=True)
    return found


#: No command of a loop of unit vectors is as large, m/s^2.
_UNLIMITED_MPS2 = 1e6
_NO_COVARIANCE = (0.0,) * 6


def loop_radius(controller: DelayController[float], train: Train, gains: tuple[float, float], emergency: bool) -> float:
    """Largest magnitude of a pole of the closed loop: train, exact predictor, filter of [v, d] and the law.

    The loop is stable if it is below 1. The effectiveness is taken as known and the gains of the filter as steady. With
    one delay for both sides the law is then linear: the columns of the loop's matrix are its answers to unit vectors.

    :param controller: in float64, with the same delay for traction and braking.
    :param train: with the nominal delay; another one shows the effect of a mismatch.
    :param gains: of the filter, on speed and disturbance, see :func:`.kalman.steady_gains`.
    :param emergency: with the weights from the trigger of an emergency on.
    """
    period_s = controller.unit.sample_period_s
    step, drive = transition(train, period_s)
    queue = max(controller.lines.count, len(drive) - 2)
    matrix = [_after(controller, step, drive, gains, float(emergency), row, queue) for row in np.eye(queue + 6)]
    return magnitude(np.array(matrix).T)


def _after(
    controller: DelayController[float],
    step: Matrix,
    drive: Matrix,
    gains: tuple[float, float],
    emergency: float,
    state: Matrix,
    queue: int,
) -> list[float]:
    """The state one period later: speed, acceleration, u(k-1), ..., correction, and v, d, acceleration as estimated."""
    speed = float(state[0])
    sent = tuple(map(float, state[2 : 2 + queue]))
    correction, believed, disturbance, lagging = map(float, state[2 + queue :])
    period_s, lines = controller.unit.sample_period_s, controller.lines
    rolled = lines.roll(lagging, lines.parts(sent), 0)
    predicted = believed + period_s * disturbance + rolled.gained
    error = speed - predicted
    belief = Belief(predicted + gains[0] * error, disturbance + gains[1] * error, 1.0, _NO_COVARIANCE)
    found = Found(belief, rolled.accel, error, 0.0, controller.nominal)
    sample = Sample(speed, (0.0,) * (controller.horizon + 1), -_UNLIMITED_MPS2, _UNLIMITED_MPS2, emergency)
    command, correction = controller.compute_command(sent[: lines.count], correction, found, sample)
    moved = step[:2] @ state[: len(drive)] + drive[:2] * command
    return [*map(float, moved), command, *sent[:-1], correction, belief.speed, belief.disturbance, rolled.accel]
