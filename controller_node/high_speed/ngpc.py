"""GPC laws on the sampled model: residual, estimate of xi, identification, control law, in this order.

A law of the family is a subclass of :class:`NgpcLaw` that makes an :class:`~.identification.Estimator`; nothing else is
needed for a law with a network. The readings D1 to D9 and D11 are parameters.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, Any, Generic, Literal, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.identification import (
    Estimator,
    Past,
    Theta,
    coefficients,
    dead_zone,
    differenced_step,
    paper_step,
    residual,
    theta_of,
)
from railhil.controller_node.high_speed.law import LawParameters, LoopController, LoopControllerLaw, Move, Sample, Unit
from railhil.controller_node.high_speed.model import Sampled, bilinear_without_direct, pade_zoh
from railhil.controller_node.high_speed.predictor import Weights, first_row, predictions, weights
from railhil.controller_node.high_speed.stability import Train, refuse_short_horizon, refuse_unstable, spectral_radius
from railhil.controller_node.vector.reals import Reals

_DISCRETISATIONS = {"zoh": pade_zoh, "bilinear": bilinear_without_direct}


@dataclass(frozen=True)
class GpcParameters(LawParameters):
    """Parameters of generalized predictive control; the defaults are the repaired set of the specification."""

    #: N and Nu (002 section 4.1).
    horizon: Annotated[int, Field(ge=1, le=16)] = 3
    control_horizon: Literal[1, 2] = 2
    #: lambda.
    control_weight: Annotated[float, Field(ge=0, le=1000)] = 0.3
    #: Delay and lag of the model; None: traction delay and lag of the unit (D11: one model, with the traction delay).
    model_delay_s: Annotated[float | None, Field(gt=0, le=5)] = None
    model_lag_s: Annotated[float | None, Field(gt=0, le=5)] = None
    #: D5: zero-order hold, or the bilinear transform with c0 dropped.
    discretisation: Literal["zoh", "bilinear"] = "zoh"
    #: D6: weighting polynomials that satisfy eq. (30) exactly, or M_j = E_j(1), r_j = 1.
    weighting: Literal["exact", "unit"] = "exact"
    #: D7: commands after the control horizon are zero, as G is printed, or hold the last one.
    after_control_horizon: Literal["zero", "held"] = "zero"
    #: D8: the reference vector starts at w(k+1), or at w(k) as 002 prints it.
    reference_start: Literal["next", "now"] = "next"
    #: Add (1 - sum p_j s_j) (w(k+2) - w(k+1)) / T0 to the command, which removes the ramp error of the cost of u^2.
    acceleration_term: bool = False
    #: D2 to D4: projection as printed, on differences, or none.
    ident: Literal["paper", "differenced", "off"] = "off"
    #: D2: e = v - v_hat (004), or e = w - v_hat as 002 prints it, which diverges.
    ident_error: Literal["speed", "reference"] = "speed"
    #: Delta; an error of at most 2 Delta identifies nothing (D3).
    dead_zone_mps: Annotated[float, Field(ge=0, le=10)] = 0.05


class NgpcState(NamedTuple, Generic[T]):
    """Regressors, identified parameters (empty without identification), state of the estimator."""

    past: Past[T]
    theta: tuple[Theta[T], ...]
    memory: Any


class NgpcController(LoopController[T, NgpcState[T]]):
    """The law of 002 section 3 and 004 section 5 for one power unit."""

    def __init__(self, re: Reals[T], unit: Unit, parameters: GpcParameters, estimator: Estimator[T, Any]) -> None:
        super().__init__(re, unit, parameters)
        self.parameters = given = parameters
        self.estimator = estimator
        self.horizon = max(given.horizon, 2)
        delay_s = unit.traction_delay_s if given.model_delay_s is None else given.model_delay_s
        lag_s = unit.lag_s if given.model_lag_s is None else given.model_lag_s
        self.model: Sampled = _DISCRETISATIONS[given.discretisation](delay_s, lag_s, unit.sample_period_s)
        self._theta = theta_of(re, self.model)
        self._weight = re.number("control_weight", given.control_weight, "lambda, parameters")
        self._zone = re.number("dead_zone", 2.0 * given.dead_zone_mps, "2 Delta, parameters")
        self._per_b_sum = re.number("per_b_sum", 1.0 / self.model.b_sum, "1/B(1)")
        self._rate = re.number("rate", 1.0 / unit.sample_period_s, "1/T0")
        self._integrating = given.ident != "paper"
        found = self.nominal_weights()
        self._weights = Weights(
            re.numbers("p", found.w, "eq. 26"),
            re.numbers("f_p", found.f, "eq. 27"),
            re.numbers("h_p", found.h, "eq. 27"),
            re.number("m_p", found.xi, "eq. 30"),
            re.number("ramp", found.ramp, "1 - sum p_j s_j"),
        )

    def nominal_weights(self) -> Weights[float]:
        """Weights of the model before any identification, computed in float64."""
        from railhil.controller_node.arithmetic.float64 import Float64

        exact = Reals(Float64())
        theta = theta_of(exact, self.model)
        return self._weights_of(exact, theta, self.parameters.control_weight)

    def radius(self, train: Train) -> float:
        """Spectral radius of the loop with the nominal model: the larger of the values without and with the
        residual."""
        found, period_s = self.nominal_weights(), self.unit.sample_period_s
        smoothings = {None, self.estimator.smoothing}
        return max(spectral_radius(train, self.model, found, period_s, smoothing) for smoothing in smoothings)

    def _weights_of(self, re: Reals[Any], theta: Theta[Any], weight: Any) -> Weights[Any]:
        given = self.parameters
        found = predictions(re, coefficients(re, theta), theta.b, given.horizon)
        held = given.after_control_horizon == "held"
        p = first_row(re, found.g, given.control_horizon, weight, held)
        return weights(re, found, p, theta.drift, re.add(*theta.b), exact=given.weighting == "exact")

    def start(self, sample: Sample[T]) -> NgpcState[T]:
        past = Past((sample.speed,) * 3, (self.re.zero,) * 3)
        theta = () if self.parameters.ident == "off" else (self._theta,)
        return NgpcState(past, theta, self.estimator.start())

    def step(self, state: NgpcState[T], sample: Sample[T]) -> tuple[NgpcState[T], Move[T]]:
        re, past = self.re, state.past
        theta = state.theta[0] if state.theta else self._theta
        left = residual(re, theta, sample.speed, past, integrating=self._integrating)
        memory, estimate = self.estimator.step(state.memory, past, left)
        error = re.sub(left, estimate.predicted)
        found = self._weights
        if state.theta:
            theta = self._identified(theta, past, error, sample)
            found = self._weights_of(re, theta, self._weight)
        command = self._command(found, theta, sample, past, estimate.used)
        speeds = (sample.speed, *past.speeds[:-1])
        after = NgpcState(Past(speeds, (command, *past.commands[:-1])), (theta,) if state.theta else (), memory)
        gain = re.mul(re.add(*theta.b), self._per_b_sum) if state.theta else re.one
        return after, Move(command, error, estimate.used, gain, re.zero)

    def _identified(self, theta: Theta[T], past: Past[T], error: T, sample: Sample[T]) -> Theta[T]:
        re = self.re
        if self.parameters.ident_error == "reference":
            # w - v_hat = (v - v_hat) + (w - v).
            error = re.add(error, re.sub(sample.reference[0], sample.speed))
        project = paper_step if self.parameters.ident == "paper" else differenced_step
        return project(re, theta, past, dead_zone(re, error, self._zone))

    def _command(self, found: Weights[T], theta: Theta[T], sample: Sample[T], past: Past[T], xi: T) -> T:
        """Eq. (26), with all speeds relative to v(k): F_j(1) = 1 - E_j(1) A(1), so the rest is A(1) M_p v(k)."""
        re, now = self.re, sample.speed
        first = 1 if self.parameters.reference_start == "next" else 0
        ahead = [re.sub(w, now) for w in sample.reference[first : first + self.parameters.horizon]]
        behind = [re.sub(v, now) for v in past.speeds[:-1]]
        command = re.sub(re.dot(found.w, ahead), re.dot(found.f[1:], behind))
        command = re.sub(command, re.dot(found.h, past.commands[: len(found.h)]))
        if not self._integrating:
            xi = re.sub(xi, re.mul(theta.drift, now))
        command = re.sub(command, re.mul(found.xi, xi))
        if self.parameters.acceleration_term:
            rise = re.mul(re.sub(sample.reference[2], sample.reference[1]), self._rate)
            command = re.add(command, re.mul(found.ramp, rise))
        return re.clip(command, sample.lowest, sample.highest)

    def sent(self, state: NgpcState[T], command: T) -> NgpcState[T]:
        past = state.past
        return state._replace(past=past._replace(commands=(command, *past.commands[1:])))


class NgpcLaw(LoopControllerLaw[T]):
    """A law of the family: the controller with an estimator of xi."""

    parameters_type = GpcParameters
    parameters_origin = "the repaired set of the specification: N = 3, Nu = 2, lambda = 0.3, T0 = 1 s"

    @abstractmethod
    def estimator(self, re: Reals[T], unit: Unit, parameters: Any) -> Estimator[T, Any]:
        """The estimator of xi of one power unit."""

    def make_controller(self, re: Reals[T], unit: Unit, parameters: Any) -> NgpcController[T]:
        """The law of one power unit.

        :raises InputError: the horizon does not exceed the delay, or the loop is unstable; not with ``override``.
        """
        delays = {"traction": unit.traction_delay_s, "braking": unit.braking_delay_s}
        refuse_short_horizon(self.name, parameters, max(delays.values()))
        controller = NgpcController(re, unit, parameters, self.estimator(re, unit, parameters))
        refuse_unstable(
            self.name,
            parameters,
            {mode: controller.radius(Train(delay_s, unit.lag_s)) for mode, delay_s in delays.items()},
        )
        return controller
