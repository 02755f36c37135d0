"""Parameters and constants common to all predictive functional laws on the core of ``pfc``; defaults are the paper's.

Equation and section numbers refer to the paper (see ``pfc_model``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.ato.pfc_model import (
    SOFTENING_Q,
    InternalModel,
    Matrix,
    ModelDamping,
    ModelGain,
    ModelStiffness,
    morlet,
    on_grid,
    polynomial_fit,
)
from railhil.controller_node.laws.base import NOTCH_RAW_Q, SPEED_Q
from railhil.controller_node.laws.constant_table import held

#: Model state (km/h), model matrices, fit matrices, gains.
GAIN_Q = 24
#: Coefficients of the set-point and error polynomials: their difference reaches 215 when inputs jump.
POLYNOMIAL_Q = 23
#: Deviations, km/h: their terms reach 3400 before the sum is limited, when inputs jump.
DEVIATION_Q = 19

#: Fixed-point limit of deviations, of the future rise of the set-point and of the past rise of the model error, km/h,
#: exceeded only when a speed reading is suddenly wrong.
DEVIATION_MAX_KMH = 100.0

Row = tuple[Constant, ...]


@dataclass(frozen=True, slots=True)
class Wavelet:
    """One Morlet basis function: scale a, shift b in seconds, bandwidth beta (eq. 21)."""

    scale: Annotated[float, Field(ge=0.01, le=100)]
    shift_s: Annotated[float, Field(ge=-100, le=100)]
    bandwidth: Annotated[float, Field(ge=0, le=10)]


Wavelets = Annotated[tuple[Wavelet, ...], Field(min_length=1, max_length=8)]
#: Limit of the horizon in control periods: far beyond what a law can use, it limits the design time.
Periods = Annotated[int, Field(ge=1, le=200)]
Order = Annotated[int, Field(ge=0, le=4)]
#: Threshold of eq. (22); a negative one is always exceeded.
Slope = Annotated[float, Field(ge=-100, le=100)]


#: Section 4.4.
WAVELETS = (Wavelet(1.0, 0.0, 0.5), Wavelet(2.0, 5.0, 0.5))


@dataclass(frozen=True, slots=True)
class PfcParameters:
    """Parameters of the core, from section 4.4 of the paper where it states them."""

    #: Eq. (2), in m/s per notch: numerator, and the two coefficients of the denominator.
    model_gain_mps: ModelGain = 0.07128
    model_damping_per_s: ModelDamping = 0.4356
    model_stiffness_per_s2: ModelStiffness = 0.0324
    #: Optimisation horizon P and fitting points h, in control periods.
    horizon: Periods = 10
    fit_points: Annotated[tuple[Periods, ...], Field(min_length=1, max_length=16)] = (3, 5, 8, 9)
    #: Orders of the set-point polynomial and of the error polynomial, and the errors the latter is fitted to.
    set_point_order: Order = 2
    error_order: Order = 2
    error_window: Annotated[int, Field(ge=2, le=64)] = 8

    @property
    def orders(self) -> range:
        """Powers n of the set-point and error polynomials together."""
        return range(1, max(self.set_point_order, self.error_order) + 1)

    @property
    def free_points(self) -> Sequence[int]:
        """Future control periods for which the law predicts the free response, including the fitting points."""
        return self.fit_points


#: Search bounds of the internal model: the paper's model is an estimate of the train. Below a stiffness of 0.02 the
#: steady-state speed of the model at 7 notches exceeds its format.
MODEL_TUNABLE: dict[str, tuple[float, float]] = {
    "model_gain_mps": (0.05, 0.10),
    "model_damping_per_s": (0.30, 0.60),
    "model_stiffness_per_s2": (0.025, 0.05),
}


@dataclass(frozen=True)
class PfcConstants:
    """The part of a law's constant table that the core needs. A ``Row`` is one vector, a tuple of rows a matrix."""

    #: Row n is (A_n1, A_n2, B_n).
    model: tuple[Row, ...] = field(metadata=held(GAIN_Q, "eq. (16), model of eq. (2) sampled with a zero-order hold"))
    #: Rows i: the law's ``free_points``.
    free: tuple[Row, ...] = field(metadata=held(GAIN_Q, "C (A^i - I), free response in eq. (18)"))
    #: Row n - 1 gives coefficient n.
    set_point_fit: tuple[Row, ...] = field(metadata=held(GAIN_Q, "least squares fit of eq. (11)"))
    error_fit: tuple[Row, ...] = field(metadata=held(GAIN_Q, "least squares fit of eq. (15)"))
    #: Rows h, columns n = 1, 2, ...
    point_powers: tuple[Row, ...] = field(metadata=held(0, "h^n at the fitting points of eq. (18), section 4.4"))
    deviation_max: Constant = field(metadata=held(DEVIATION_Q, "limit of this implementation"))
    rise_max: Constant = field(metadata=held(SPEED_Q, "limit of this implementation"))
    notch_max: Constant = field(metadata=held(NOTCH_RAW_Q, "notch range of the train"))
    zero: Constant = field(metadata=held(SPEED_Q, "0"))


def internal_model(parameters: PfcParameters, period_s: float) -> InternalModel:
    """Eq. (2) sampled at the control period, in km/h per notch."""
    return InternalModel.sampled(
        parameters.model_gain_mps * 3.6,
        parameters.model_damping_per_s,
        parameters.model_stiffness_per_s2,
        period_s,
    )


def step_basis(horizon: int) -> Matrix:
    """The step at i = 0..P-1, shape (1, P)."""
    return np.ones((1, horizon))


def step_and_ramp_basis(horizon: int) -> Matrix:
    """Step and ramp at i = 0..P-1, shape (2, P)."""
    return np.vstack([np.ones(horizon), np.arange(horizon, dtype=np.float64)])


def wavelet_basis(wavelets: Sequence[Wavelet], horizon: int, period_s: float) -> Matrix:
    """Morlet wavelets at i = 0..P-1, shape (number of wavelets, P)."""
    time_s = np.arange(horizon, dtype=np.float64) * period_s
    return np.array([morlet(w.scale, w.shift_s, w.bandwidth, time_s) for w in wavelets])


def core_values(parameters: PfcParameters, model: InternalModel, notch_max: float) -> dict[str, Any]:
    """Numbers for the fields of :class:`PfcConstants`, to be passed to ``table.build`` together with the law's own.

    :param notch_max: notch range of the train, notches.
    :raises ValueError: fitting points or orders are inconsistent.
    """
    p = parameters
    if max(p.fit_points) > p.horizon:
        raise ValueError(f"fit_points {p.fit_points} lie beyond the horizon of {p.horizon} periods")
    if p.error_order >= p.error_window:
        raise ValueError(f"error_order {p.error_order} takes an error_window longer than {p.error_window}")
    if p.set_point_order > p.horizon:
        raise ValueError(f"set_point_order {p.set_point_order} is above the horizon of {p.horizon} periods")
    return {
        "model": np.column_stack([model.a, model.b]),
        "free": model.free_rows(p.horizon)[[i - 1 for i in p.free_points]],
        "set_point_fit": polynomial_fit(range(1, p.horizon + 1), p.set_point_order),
        "error_fit": polynomial_fit(range(1 - p.error_window, 0), p.error_order),
        "point_powers": [[h**n for n in p.orders] for h in p.fit_points],
        "deviation_max": DEVIATION_MAX_KMH,
        "rise_max": DEVIATION_MAX_KMH,
        "notch_max": notch_max,
        "zero": 0.0,
    }


def gains(model: InternalModel, basis: Matrix, fit_points: Sequence[int]) -> Matrix:
    """U of eq. (19) for basis functions of shape (N, P); see :meth:`InternalModel.gains`.

    :raises ValueError: fewer different fitting points than basis functions, or points that cannot distinguish them.
    """
    if len(basis) > (points := len(set(fit_points))):
        raise ValueError(f"{len(basis)} basis functions need as many different fitting points, there are {points}")
    return model.gains(basis, fit_points)


@dataclass(frozen=True, slots=True)
class ConstantPfcParameters(PfcParameters):
    """Parameters of a law with a constant softening factor."""

    #: exp(-Ts / Tr) with Tr = 2 Ts, section 2.3.
    softening: Annotated[float, Field(ge=0, lt=1)] = 0.6065306597126334


#: Bounds of a search.
CONSTANT_TUNABLE: dict[str, tuple[float, float]] = {**MODEL_TUNABLE, "softening": (0.4, 0.95)}


@dataclass(frozen=True)
class ConstantPfcConstants(PfcConstants):
    """Constant table of such a law, without its gains."""

    softening: Constant = field(metadata=held(SOFTENING_Q, "alpha of eq. (11), section 2.3"))
    closed: Row = field(metadata=held(SOFTENING_Q, "1 - alpha^h at the fitting points of eq. (18)"))
    basis: Row = field(metadata=held(0, "codes of CTL_STAT"))


def constant_values(parameters: ConstantPfcParameters, model: InternalModel, notch_max: float) -> dict[str, Any]:
    """Like :func:`core_values`, for the fields of :class:`ConstantPfcConstants` except the codes."""
    alpha = parameters.softening
    core = core_values(parameters, model, notch_max)
    return core | {"softening": alpha, "closed": on_grid([1 - alpha**h for h in parameters.fit_points])}
