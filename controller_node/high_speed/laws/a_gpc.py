"""A-GPC, the adaptive comparator of 004 ([25] there, cited wrongly, D10): GPC on an identified, integrated model.

It is read as explicit CARIMA GPC with recursive least squares on differences: the integrator of the train is known, and
an unknown constant (running resistance, grade) is removed by the differences.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Generic, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.arithmetic.float64 import Float64
from railhil.controller_node.high_speed.carima import (
    CarimaParameters,
    Track,
    command_of,
    falls,
    increments,
    one_step_error,
    radius,
    resent,
    start_track,
    tracked,
)
from railhil.controller_node.high_speed.identification import coefficients, theta_of
from railhil.controller_node.high_speed.law import JOURNEYS, LoopController, LoopControllerLaw, Move, Sample, Unit
from railhil.controller_node.high_speed.model import pade_zoh
from railhil.controller_node.high_speed.stability import Train, refuse_short_horizon, refuse_unstable
from railhil.controller_node.vector.reals import Reals

_PARAMETERS = 5


@dataclass(frozen=True)
class AGpcParameters(CarimaParameters):
    """Parameters of the law."""

    control_weight: Annotated[float, Field(ge=0, le=1000)] = 9.0
    #: Forgetting factor of the least squares.
    forgetting: Annotated[float, Field(gt=0.5, le=1)] = 0.995
    #: Covariance of the parameters at the start, as a multiple of the unit matrix; also the limit of its diagonal.
    covariance: Annotated[float, Field(gt=0, le=1e4)] = 0.05


class Rls(NamedTuple, Generic[T]):
    """``theta``: alpha1, alpha2, b0, b1, b2. ``covariance``: the upper triangle, row by row (15)."""

    theta: tuple[T, ...]
    covariance: tuple[T, ...]


def triangle(row: int, column: int) -> int:
    """Place of an element of a symmetric matrix in its upper triangle."""
    low, high = min(row, column), max(row, column)
    return low * _PARAMETERS - low * (low - 1) // 2 + high - low


def rls_step(re: Reals[T], old: Rls[T], x: Sequence[T], error: T, forgetting: T, most: T) -> Rls[T]:
    """Recursive least squares with forgetting: gain P x / (lambda + x'P x).

    The new covariance (P - gain x'P) / lambda is kept where its diagonal stays below ``most``; elsewhere it is not
    forgotten, so that it does not grow without excitation.

    :param error: y - x'theta with the old parameters.
    """
    rows = range(_PARAMETERS)
    px = [re.dot([old.covariance[triangle(i, j)] for j in rows], x) for i in rows]
    scale = re.add(forgetting, re.dot(x, px))
    gain = [re.div(p, scale) for p in px]
    theta = re.axpy(error, gain, old.theta)
    reduced = [re.sub(old.covariance[triangle(i, j)], re.mul(gain[i], px[j])) for i in rows for j in rows if j >= i]
    grown = tuple(re.div(p, forgetting) for p in reduced)
    largest = grown[0]
    for i in rows[1:]:
        largest = re.ar.maximum(largest, grown[triangle(i, i)])
    return Rls(theta, re.select(re.gt(largest, most), tuple(reduced), grown))


class AState(NamedTuple, Generic[T]):
    """Regressors and identification."""

    track: Track[T]
    rls: Rls[T]


class AController(LoopController[T, AState[T]]):
    """Identification, weights and command in each sample."""

    def __init__(self, re: Reals[T], unit: Unit, parameters: AGpcParameters) -> None:
        super().__init__(re, unit, parameters)
        self._given = parameters
        self.horizon = parameters.horizon
        model = pade_zoh(unit.traction_delay_s, unit.lag_s, unit.sample_period_s)
        self._model = model
        self._theta = theta_of(re, model)
        self._weight = re.number("control_weight", parameters.control_weight, "lambda, parameters")
        self._forgetting = re.number("forgetting", parameters.forgetting, "parameters")
        self._covariance = re.number("covariance", parameters.covariance, "parameters")
        self._most = re.number("covariance_max", 1.001 * parameters.covariance, "parameters")
        self._per_b_sum = re.number("per_b_sum", 1.0 / model.b_sum, "1/B(1)")

    def radius(self, train: Train) -> float:
        """Spectral radius of the loop with the model from which the identification starts."""
        given, model = self._given, self._model
        exact = Reals(Float64())
        law = increments(exact, model.a, model.b, given.horizon, given.control_horizon, given.control_weight)
        return radius(law, train, self.unit.sample_period_s)

    def start(self, sample: Sample[T]) -> AState[T]:
        re = self.re
        rows = range(_PARAMETERS)
        unit = tuple(self._covariance if i == j else re.zero for i in rows for j in rows if j >= i)
        return AState(start_track(re, sample), Rls((*self._theta.alpha, *self._theta.b), unit))

    def step(self, state: AState[T], sample: Sample[T]) -> tuple[AState[T], Move[T]]:
        re, track, given = self.re, state.track, self._given
        alpha, b = state.rls.theta[:2], state.rls.theta[2:]
        error = one_step_error(re, alpha, b, sample.speed, track)
        changes = falls(re, falls(re, track.speeds))
        x = (*(re.neg(change) for change in changes[:2]), *falls(re, track.commands))
        rls = rls_step(re, state.rls, x, error, self._forgetting, self._most)
        theta = self._theta._replace(alpha=rls.theta[:2], b=rls.theta[2:])
        found = increments(re, coefficients(re, theta), theta.b, given.horizon, given.control_horizon, self._weight)
        command = command_of(re, found, sample, track)
        gain = re.mul(re.add(*theta.b), self._per_b_sum)
        return AState(tracked(track, sample.speed, command), rls), Move(command, error, re.zero, gain, re.zero)

    def sent(self, state: AState[T], command: T) -> AState[T]:
        return state._replace(track=resent(state.track, command))


class AGpc(LoopControllerLaw[T]):
    """Adaptive GPC."""

    name = "a_gpc"
    parameters_type = AGpcParameters
    #: Its figures on these seeds were known while its parameters were chosen.
    design_seeds: ClassVar[Mapping[str, range]] = dict.fromkeys(JOURNEYS, range(201, 206))
    parameters_origin = "ours, near those of mm_gpc; the papers print none"
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {
        "control_weight": (0.5, 100.0),
        "forgetting": (0.95, 1.0),
        "covariance": (0.005, 1.0),
    }

    def make_controller(self, re: Reals[T], unit: Unit, parameters: Any) -> AController[T]:
        delays = {"traction": unit.traction_delay_s, "braking": unit.braking_delay_s}
        refuse_short_horizon(self.name, parameters, max(delays.values()))
        controller = AController(re, unit, parameters)
        radii = {mode: controller.radius(Train(delay_s, unit.lag_s)) for mode, delay_s in delays.items()}
        refuse_unstable(self.name, parameters, radii)
        return controller
