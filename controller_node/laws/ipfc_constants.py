"""Parameters of the IPFC law (defaults: the paper's) and the table of constants made from them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np

from controller_node.arithmetic.base import Constant, Curve
from controller_node.laws.base import (
    BASIS_STEP,
    BASIS_WAVELET,
    NOTCH_RAW_Q,
    SATISFACTION_Q,
    SOFTENING_Q,
    SPEED_Q,
)
from controller_node.laws.pfc_model import InternalModel, Matrix, morlet, polynomial_fit

#: Model state (km/h), model matrices, fit matrices, gains, polynomial coefficients.
GAIN_Q = 24
#: Reciprocals of the fuzzy widths and of the control period.
RATE_Q = 20

#: Fixed-point limit of deviations, km/h: they exceed it only when a speed suddenly reads wrong.
DEVIATION_MAX_KMH = 100.0
#: Fixed-point limit of the estimated rise time, s; every larger value has satisfaction 0 as well.
RISE_TIME_MAX_S = 1.0


@dataclass(frozen=True, slots=True)
class Wavelet:
    """One Morlet basis function: scale a, shift b in seconds, bandwidth beta (eq. 21)."""

    scale: float
    shift_s: float
    bandwidth: float


@dataclass(frozen=True, slots=True)
class IpfcParameters:
    """Parameters of the law, section 4.4 of the paper where it states them."""

    #: Eq. (2), in m/s per notch: numerator, and the two coefficients of the denominator.
    model_gain_mps: float = 0.07128
    model_damping_per_s: float = 0.4356
    model_stiffness_per_s2: float = 0.0324
    #: Optimisation horizon P and fitting points h, in control periods.
    horizon: int = 10
    fit_points: tuple[int, ...] = (3, 5, 8, 9)
    wavelets: tuple[Wavelet, ...] = (Wavelet(1.0, 0.0, 0.5), Wavelet(2.0, 5.0, 0.5))
    #: Orders of the set-point polynomial and of the error polynomial, and the errors the latter is fitted to.
    set_point_order: int = 2
    error_order: int = 2
    error_window: int = 8
    #: Eq. (22): mean acceleration over the horizon above which wavelets are used, km/h per s.
    wavelet_slope_kmh_per_s: float = 1.134
    #: Eq. (24): window of the rise time and its fuzzy widths, s.
    rise_time_min_s: float = 0.008
    rise_time_max_s: float = 0.02
    rise_width_below_s: float = 0.006
    rise_width_above_s: float = 0.006
    #: Eq. (25): window of the predicted speed around the target and its fuzzy widths, km/h.
    speed_below_kmh: float = 0.02
    speed_above_kmh: float = 0.02
    speed_width_below_kmh: float = 0.02
    speed_width_above_kmh: float = 0.02
    #: Eq. (27).
    softening_max: float = 0.85
    softening_min: float = 0.77
    softening_exponent: float = 0.94
    #: The "large number M" of eq. (23), s.
    rise_time_never_s: float = 1e6

    @property
    def orders(self) -> range:
        """Powers n of the set-point and error polynomials together."""
        return range(1, max(self.set_point_order, self.error_order) + 1)


Row = tuple[Constant, ...]


@dataclass(frozen=True)
class IpfcConstants:
    """Constant table of the law. A ``Row`` is one vector, a tuple of rows a matrix."""

    #: Model (eq. 16): row n is (A_n1, A_n2, B_n).
    model: tuple[Row, ...]
    #: C (A^i - I) and step response at i = 1..P.
    free: tuple[Row, ...]
    step_response: Row
    #: Polynomial fits: row n - 1 gives coefficient n.
    set_point_fit: tuple[Row, ...]
    error_fit: tuple[Row, ...]
    #: U of eq. (19) for the two bases.
    gains_step: Row
    gains_wavelet: Row
    per_period: Constant
    wavelet_change: Constant
    deviation_max: Constant
    rise_never: Constant
    rise_never_narrow: Constant
    rise_window: Row
    rise_widths: Row
    rise_slopes: Row
    speed_window: Row
    speed_widths: Row
    speed_slopes: Row
    one_speed: Constant
    one_satisfaction: Constant
    one_softening: Constant
    notch_max: Constant
    zero: Constant
    #: Codes of the step and of the wavelet basis.
    basis: Row
    #: h^n at the fitting points h (rows), n = 1, 2, ...
    point_powers: tuple[Row, ...]
    #: Samples of the softening curve, eq. (27).
    softening: Row

    def entries(self) -> tuple[Constant, ...]:
        """All constants, in the order of the fields."""
        return tuple(constant for item in fields(self) for constant in _flat(getattr(self, item.name)))


def _flat(value: Constant | tuple[object, ...]) -> Iterable[Constant]:
    if isinstance(value, Constant):
        yield value
        return
    for item in value:
        yield from _flat(item)  # type: ignore[arg-type]


def _row(name: str, values: Iterable[float], q: int) -> Row:
    return tuple(Constant(f"{name}[{i}]", float(value), q) for i, value in enumerate(values))


def _rows(name: str, values: Iterable[Iterable[float]], q: int) -> tuple[Row, ...]:
    return tuple(_row(f"{name}[{i}]", row, q) for i, row in enumerate(values))


def internal_model(parameters: IpfcParameters, period_s: float) -> InternalModel:
    """Eq. (2) sampled at the control period, in km/h per notch."""
    return InternalModel.sampled(
        parameters.model_gain_mps * 3.6,
        parameters.model_damping_per_s,
        parameters.model_stiffness_per_s2,
        period_s,
    )


def bases(parameters: IpfcParameters, period_s: float) -> tuple[Matrix, Matrix]:
    """Step basis, shape (1, P), and wavelet basis, shape (number of wavelets, P), at i = 0..P-1."""
    time_s = np.arange(parameters.horizon, dtype=np.float64) * period_s
    wavelets = [morlet(w.scale, w.shift_s, w.bandwidth, time_s) for w in parameters.wavelets]
    return np.ones((1, parameters.horizon)), np.array(wavelets)


@lru_cache(maxsize=8)
def softening_curve(parameters: IpfcParameters) -> Curve:
    """Eq. (27): alpha over the satisfaction mu."""
    slope = math.log(parameters.softening_min / parameters.softening_max)

    def alpha(mu: float) -> float:
        return parameters.softening_max * math.exp(mu**parameters.softening_exponent * slope)

    return Curve.sampled("softening", alpha, SATISFACTION_Q, SOFTENING_Q)


@lru_cache(maxsize=8)
def make_constants(parameters: IpfcParameters, period_s: float, notch_max: float) -> IpfcConstants:
    """The constant table at a control period (s) and a notch range (notches).

    Raises ``ValueError`` when a constant does not fit its format, or fitting points or orders do not fit each other.
    """
    p = parameters
    if not p.fit_points or max(p.fit_points) > p.horizon or min(p.fit_points) < 1:
        raise ValueError(f"fitting points {p.fit_points} lie outside 1..{p.horizon}")
    if len(p.wavelets) > len(p.fit_points):
        raise ValueError(f"{len(p.wavelets)} wavelets need as many fitting points, there are {len(p.fit_points)}")
    if p.error_window <= p.error_order or p.horizon < p.set_point_order:
        raise ValueError("polynomial orders are too high for their windows")
    model = internal_model(p, period_s)
    step, wavelets = bases(p, period_s)
    return IpfcConstants(
        model=_rows("model", np.column_stack([model.a, model.b]), GAIN_Q),
        free=_rows("free", model.free_rows(p.horizon), GAIN_Q),
        step_response=_row("step_response", model.step_response(p.horizon), GAIN_Q),
        set_point_fit=_rows("set_point_fit", polynomial_fit(range(1, p.horizon + 1), p.set_point_order), GAIN_Q),
        error_fit=_rows("error_fit", polynomial_fit(range(1 - p.error_window, 0), p.error_order), GAIN_Q),
        gains_step=_row("gains_step", model.gains(step, p.fit_points), GAIN_Q),
        gains_wavelet=_row("gains_wavelet", model.gains(wavelets, p.fit_points), GAIN_Q),
        per_period=Constant("per_period", 1 / period_s, RATE_Q),
        wavelet_change=Constant("wavelet_change", p.wavelet_slope_kmh_per_s * p.horizon * period_s, SPEED_Q),
        deviation_max=Constant("deviation_max", DEVIATION_MAX_KMH, SPEED_Q),
        rise_never=Constant("rise_never", p.rise_time_never_s, 0),
        rise_never_narrow=Constant("rise_never_narrow", RISE_TIME_MAX_S, SPEED_Q),
        rise_window=_row("rise_window", (p.rise_time_min_s, p.rise_time_max_s), SPEED_Q),
        rise_widths=_row("rise_widths", (p.rise_width_below_s, p.rise_width_above_s), SPEED_Q),
        rise_slopes=_row("rise_slopes", (1 / p.rise_width_below_s, 1 / p.rise_width_above_s), RATE_Q),
        speed_window=_row("speed_window", (-p.speed_below_kmh, p.speed_above_kmh), SPEED_Q),
        speed_widths=_row("speed_widths", (p.speed_width_below_kmh, p.speed_width_above_kmh), SPEED_Q),
        speed_slopes=_row("speed_slopes", (1 / p.speed_width_below_kmh, 1 / p.speed_width_above_kmh), RATE_Q),
        one_speed=Constant("one_speed", 1.0, SPEED_Q),
        one_satisfaction=Constant("one_satisfaction", 1.0, SATISFACTION_Q),
        one_softening=Constant("one_softening", 1.0, SOFTENING_Q),
        notch_max=Constant("notch_max", notch_max, NOTCH_RAW_Q),
        zero=Constant("zero", 0.0, SPEED_Q),
        basis=_row("basis", (BASIS_STEP, BASIS_WAVELET), 0),
        point_powers=_rows("point_powers", ([h**n for n in p.orders] for h in p.fit_points), 0),
        softening=softening_curve(p).samples,
    )
