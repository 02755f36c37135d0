"""The quadratic program of :mod:`.delay_qp`: commands of a train's units over the horizon, with their constraints.

Each command is traction less braking, p - n, with p, n >= 0: the sides have delays of their own. The plan is the
steady command of both sides: the acceleration of the reference when a command acts, less the disturbance, by the
effectiveness. With c the deviation of p - n from the plan (kept behind the control horizon) the cost is::

    sum (w - v)^2 + lambda sum (c(j) - c(j-1))^2 + rho sum (p - p_plan)^2 + rho sum (n - n_plan)^2
      + kappa (p where no traction is planned, n where no braking is planned)
      + energy sum p v T0 + force sum F^2 + slack

Constraints: 0 <= p <= least of largest traction and power by speed, 0 <= n <= largest braking, |u(j) - u(j-1)| <= J T0,
|F| <= F_max + slack. Where p and n would act against each other without a plan for both, the smaller one is set to 0
and the program solved again. Per unit c, p and n count by the unit's share of the mass. A command above the power limit
is reduced at the jerk limit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import Field

from railhil.common.extras import missing_library
from railhil.controller_node.high_speed.model import Matrix
from railhil.controller_node.high_speed.train_model import Prediction

#: ``solve(hessian, linear, rows, upper, lower)``: the minimum of x'Hx/2 + f'x with lower <= (x, rows x) <= upper;
#: bounds first limit x, then the rows.
Solver = Callable[[Matrix, Matrix, Matrix, Matrix, Matrix], Matrix]

_SOLVED = 1
#: DAQP's numbers for problems that have no solution, or took too long.
_WORDS = {-1: "no solution fulfils the constraints", -2: "cycling", -3: "unbounded", -4: "too many iterations"}


class SolverError(Exception):
    """A quadratic program was not solved; one line."""


def daqp_solver(law: str) -> Solver:
    """DAQP, a dual active-set method (Arnstrom et al. 2022); the extra [qp].

    Every solution starts anew, so that it depends on the problem alone.

    :param law: named in the message if it is not installed.
    :raises InputError: it is not installed.
    """
    try:
        import daqp
    except ImportError as error:
        raise missing_library(law, error, "qp") from None

    def solve(hessian: Matrix, linear: Matrix, rows: Matrix, upper: Matrix, lower: Matrix) -> Matrix:
        kinds = np.zeros(len(upper), dtype=np.intc)
        found, _, flag, _ = daqp.solve(hessian, linear, rows, upper, lower, kinds)
        if flag != _SOLVED:
            raise SolverError(f"quadratic program: {_WORDS.get(flag, f'DAQP answers {flag}')}")
        answer: Any = found
        return np.asarray(answer, dtype=np.float64)

    return solve


_Weight = Annotated[float, Field(ge=0, le=1e6)]
#: Value for no jerk limit: in an emergency, and for the first command of a run.
_FREE_MPS3 = 100.0
_CRAWL_MPS = 1.0
#: Places of p and n in a command.
_SIGNS = np.array([1.0, -1.0])
#: A side with less does not act.
_ACTS_MPS2 = 1e-6
#: A side with less is not planned: a constant reference gives a plan of 0, whose sign is a matter of rounding.
_PLANNED_MPS2 = 1e-3
#: Cost of the force above its limit, by kN and by kN^2: far above every other one.
_SLACK, _SLACK_SQUARE = 10.0, 1.0


@dataclass(frozen=True)
class QpParameters:
    """Parameters of the quadratic program."""

    #: N: 3.2 s, within the preview of 3.5 s.
    horizon: Annotated[int, Field(ge=2, le=17)] = 16
    #: Nu: samples with commands of their own.
    control_horizon: Annotated[int, Field(ge=1, le=10)] = 6
    #: lambda, on the increments of the deviation from the plan.
    control_weight: Annotated[float, Field(gt=0, le=1e4)] = 3.0
    #: lambda in an emergency, where the slope of the command is not scored.
    emergency_weight: Annotated[float, Field(gt=0, le=1e4)] = 0.003
    #: rho, on the deviation from the plan.
    plan_weight: Annotated[float, Field(gt=0, le=1e4)] = 0.05
    #: kappa, on the side that is not planned: traction and braking do not act against each other for less. Not in an
    #: emergency.
    side_weight: _Weight = 0.01
    #: Cost of the work of the traction by mass, per J/kg.
    energy_weight: _Weight = 0.0
    #: J, m/s^3; not in an emergency.
    jerk_max_mps3: Annotated[float, Field(gt=0, le=100)] = 0.2
    #: Cost of the coupler forces, per kN^2, with ``loop = "train"``.
    force_weight: _Weight = 1e-5
    #: Largest force of a coupler as predicted, kN.
    force_max_kn: Annotated[float, Field(gt=0, le=1e4)] = 2.0
    #: Half the span over which the acceleration of the reference is taken, s.
    slope_span_s: Annotated[float, Field(ge=0.1, le=1)] = 0.4


class Limits(NamedTuple):
    """Largest traction and braking (m/s^2), and power by mass (W/kg)."""

    traction_mps2: float
    braking_mps2: float
    power_w_per_kg: float


class Situation(NamedTuple):
    """Inputs at a sample: ``reference`` w(k) ... w(k+N) and ``speed`` in m/s, ``disturbance`` in m/s^2, gain.

    ``emergency``: no jerk limit, no kappa, and lambda of an emergency. ``first``: no jerk limit, as nothing was sent
    before. ``state``: of the :class:`.train_model.TrainModel`. ``past``: u(k-1), u(k-2), ... of each unit,
    (units, past), m/s^2.
    """

    reference: Matrix
    speed: float
    disturbance: float
    gain: float
    emergency: bool
    first: bool
    state: Matrix
    past: Matrix


class Decision(NamedTuple):
    """The commands of the units, m/s^2, and the state of the model one sample later."""

    commands: Matrix
    after: Matrix


class Qp:
    """The program for one train and one set of delays.

    :param centres: of each unit and side, samples from a command's computation to the centre of its action.
    :param shares: of the units in the mass.
    """

    def __init__(
        self,
        prediction: Prediction,
        centres: Sequence[Sequence[float]],
        shares: Sequence[float],
        limits: Limits,
        given: QpParameters,
        period_s: float,
        solver: Solver,
    ) -> None:
        self._given, self._limits, self._solver, self._period_s = given, limits, solver, period_s
        self._prediction = prediction
        n, moves, horizon = len(shares), given.control_horizon, given.horizon
        self._shape = (n, 2, moves)
        size = n * 2 * moves
        # Plans begin one sample early: the deviation of the last command is needed too.
        self._slopes = np.array([[_slopes(c, horizon, period_s, given.slope_span_s) for c in unit] for unit in centres])
        future = [part[:, :, prediction.past :] for part in prediction.commands[:2]]
        on_speed, on_force = ((_moved(part, moves) * _SIGNS[:, None, None]).reshape(size, -1).T for part in future)
        #: Forces that the commands can influence.
        self._reached = np.abs(on_force).max(axis=1, initial=0.0) > 1e-9
        self._on_speed, self._on_force = on_speed, on_force[self._reached]
        # Increments of p - n of each unit: (units * moves, size).
        steps = np.eye(moves) - np.eye(moves, k=-1)
        self._steps = np.kron(np.eye(n), np.kron(_SIGNS, steps))
        self._on_steps = self._steps.T * np.repeat(shares, moves)
        self._steps_square = self._on_steps @ self._steps
        self._shares = np.repeat(shares, 2 * moves)
        self._side = given.side_weight * self._shares
        self._plan_square = np.diag(given.plan_weight * self._shares)
        self._speed_square = self._on_speed.T @ self._on_speed
        self._force_square = self._on_force.T @ self._on_force * given.force_weight
        self._slacks = n > 1
        self._rows: Matrix = np.asarray(self._steps)
        if self._slacks:
            empty, one = np.zeros((len(self._steps), 1)), np.ones((len(self._on_force), 1))
            self._rows = np.asarray(np.block([[self._steps, empty], [self._on_force, -one], [self._on_force, one]]))

    def decide(self, now: Situation) -> Decision:
        """The commands of this sample.

        :raises SolverError: the program was not solved.
        """
        prediction, past, moves = self._prediction, self._prediction.past, self._shape[2]
        most = self._most(now)
        plan = self._plan(now, most)
        acted = self._acted(now, plan)
        flat = [part.reshape(acted.size, -1) for part in prediction.commands]
        speed, force = (
            now.state @ own + acted.reshape(-1) @ by for own, by in zip(prediction.state[:2], flat[:2], strict=True)
        )
        times_s = self._period_s * np.arange(1, self._given.horizon + 1)
        ahead = now.reference[1:] - now.speed - times_s * now.disturbance - now.gain * speed
        force = now.gain * force[self._reached]
        # The unknowns are the deviations of p and n from the plan.
        near: Matrix = plan[:, :, 1 : moves + 1]
        hessian, linear = self._cost(now, near, ahead, force, now.past[:, 0] - (plan[:, 0, 0] - plan[:, 1, 0]))
        upper, lower = self._bounds(now, near, most, force)
        rows = self._rows
        if self._slacks:
            hessian, linear = _with_slack(hessian, linear)
            rows = rows.copy()
            rows[len(self._steps) :, :-1] *= now.gain
        size = near.size
        found = self._solver(hessian, linear, rows, upper, lower)
        against = _against(near, near + found[:size].reshape(self._shape)).reshape(-1)
        if against.any():
            upper[:size][against] = -near.reshape(-1)[against]
            found = self._solver(hessian, linear, rows, upper, lower)
        sides = near[:, :, 0] + found[:size].reshape(self._shape)[:, :, 0]
        commands = sides[:, 0] - sides[:, 1]
        acted[:, 0, past], acted[:, 1, past] = np.maximum(commands, 0.0), np.minimum(commands, 0.0)
        return Decision(commands, now.state @ prediction.state.after + acted.reshape(-1) @ flat[2])

    def _most(self, now: Situation) -> Matrix:
        """Largest traction over the horizon, (N,), at the speeds of the reference."""
        speeds = np.maximum(now.speed + now.reference[1:] - now.reference[0], _CRAWL_MPS)
        return np.asarray(np.minimum(self._limits.traction_mps2, self._limits.power_w_per_kg / speeds))

    def _plan(self, now: Situation, most: Matrix) -> Matrix:
        """Planned p and n, (units, 2, 1 + N), the first for the last sample, m/s^2."""
        wanted = (self._slopes @ now.reference - now.disturbance) / now.gain
        plan: Matrix = np.maximum(wanted * _SIGNS[:, None], 0.0)
        plan[:, 0, 1:] = np.minimum(plan[:, 0, 1:], most)
        plan[:, 1] = np.minimum(plan[:, 1], self._limits.braking_mps2)
        return plan

    def _acted(self, now: Situation, plan: Matrix) -> Matrix:
        """Commands by sides if the plan is carried out, (units, 2, past + N), the oldest first, m/s^2."""
        past = self._prediction.past
        found = np.empty((*plan.shape[:2], past + self._given.horizon))
        oldest_first = now.past[:, past - 1 :: -1]
        found[:, 0, :past], found[:, 1, :past] = np.maximum(oldest_first, 0.0), np.minimum(oldest_first, 0.0)
        found[:, :, past:] = plan[:, :, 1:] * _SIGNS[:, None]
        return found

    def _cost(
        self, now: Situation, near: Matrix, ahead: Matrix, force: Matrix, deviation: Matrix
    ) -> tuple[Matrix, Matrix]:
        """Hessian and linear term.

        :param near: planned p and n of the control horizon; ``ahead``: w - v under the plan (m/s), ``force``: of the
            couplers under it (kN); ``deviation``: of the last commands from the plan, (units,).
        """
        given, gain = self._given, now.gain
        before = np.zeros((len(near), near.shape[2]))
        before[:, 0] = deviation
        weight = given.emergency_weight if now.emergency else given.control_weight
        hessian = gain * gain * (self._speed_square + self._force_square) + self._plan_square
        hessian += weight * self._steps_square
        linear = -gain * (ahead @ self._on_speed) - weight * (self._on_steps @ before.reshape(-1))
        linear += gain * given.force_weight * (force @ self._on_force)
        if not now.emergency:
            linear += self._side * (near <= _PLANNED_MPS2).reshape(-1)
        work = np.zeros(near.shape)
        work[:, 0] = given.energy_weight * max(now.speed, 0.0) * self._period_s
        return hessian, linear + self._shares * work.reshape(-1)

    def _bounds(self, now: Situation, near: Matrix, most: Matrix, force: Matrix) -> tuple[Matrix, Matrix]:
        """Upper and lower bounds of the unknowns and of the rows."""
        given, moves = self._given, near.shape[2]
        jerk = (_FREE_MPS3 if now.emergency or now.first else given.jerk_max_mps3) * self._period_s
        # A command that the power no longer allows is reduced at the jerk limit.
        allowed = np.maximum(most[:moves], now.past[:, :1] - jerk * np.arange(1, moves + 1))
        highest = np.stack([allowed - near[:, 0], self._limits.braking_mps2 - near[:, 1]], axis=1)
        planned = np.diff(np.concatenate([now.past[:, :1], near[:, 0] - near[:, 1]], axis=1), axis=1).reshape(-1)
        upper, lower = [highest.reshape(-1), jerk - planned], [-near.reshape(-1), -jerk - planned]
        if self._slacks:
            none, most_kn = np.full(len(force), np.inf), given.force_max_kn
            upper[1:1], lower[1:1] = [np.array([np.inf])], [np.array([0.0])]
            upper += [most_kn - force, none]
            lower += [-none, -most_kn - force]
        return np.concatenate(upper), np.concatenate(lower)


def _against(plan: Matrix, sides: Matrix) -> Matrix:
    """Marks the smaller of p and n where not both are planned, because they would act against each other; (units, 2,
    Nu), bool.

    The train would carry out their difference by one side alone.
    """
    both = (sides.min(axis=1) > _ACTS_MPS2) & (plan.min(axis=1) <= _PLANNED_MPS2)
    smaller = sides == sides.min(axis=1, keepdims=True)
    return np.asarray(smaller & both[:, None])


def _slopes(centre: float, horizon: int, period_s: float, span_s: float) -> Matrix:
    """Weights of w(k) ... w(k+N) in the acceleration of the reference when the commands -1 ... N - 1 act, (1+N, 1+N).

    Between two samples linear; behind the preview the last slope continues.
    """
    half = max(1, round(span_s / period_s))
    found = np.zeros((horizon + 1, horizon + 1))
    for row, sample in enumerate(range(-1, horizon)):
        place = centre + sample
        low = min(int(place), horizon - 1)
        for index, share in ((low, 1.0 - place % 1.0), (low + 1, place % 1.0)):
            late = min(index + half, horizon)
            early = max(late - 2 * half, 0)
            found[row, late] += share / ((late - early) * period_s)
            found[row, early] -= share / ((late - early) * period_s)
    return found


def _moved(part: Matrix, moves: int) -> Matrix:
    """Responses by the commands of the control horizon, the last of which continues: axes unit, side, command,
    output."""
    return np.concatenate([part[:, :, : moves - 1], part[:, :, moves - 1 :].sum(axis=2, keepdims=True)], axis=2)


def _with_slack(hessian: Matrix, linear: Matrix) -> tuple[Matrix, Matrix]:
    """The program with one more unknown: the force above its limit."""
    size = len(linear)
    wider = np.zeros((size + 1, size + 1))
    wider[:size, :size], wider[size, size] = hessian, _SLACK_SQUARE
    return wider, np.append(linear, _SLACK)
