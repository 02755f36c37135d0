"""Parameters of the IPFC law (defaults: the paper's) and the table of constants made from them.

Equation and section numbers are those of the paper (see ``ipfc``).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
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
from controller_node.laws.pfc_model import InternalModel, Matrix, morlet, on_grid, polynomial_fit
from controller_node.laws.table import LawTable, build, flatten, held

#: Model state (km/h), model matrices, fit matrices, gains.
GAIN_Q = 24
#: Coefficients of the set-point and error polynomials: their difference reaches 215 when inputs jump.
POLYNOMIAL_Q = 23
#: Reciprocals of the fuzzy widths and of the control period.
RATE_Q = 20
#: Rise times: in Q20 the fuzzy width of 6 ms would be off by 7e-5, and no rise time would be quite unsatisfying.
RISE_Q = 24
#: Deviations, km/h: their terms reach 3400 before the sum is limited, when inputs jump.
DEVIATION_Q = 19

#: Fixed-point limit of deviations, of the set-point's rise ahead and of the model error's past rise, km/h: they exceed
#: it only when a speed suddenly reads wrong.
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


#: Bounds of a search. The gains of the paper's model are among them because they are a guess about the train.
TUNABLE: dict[str, tuple[float, float]] = {
    "model_gain_mps": (0.05, 0.10),
    "model_damping_per_s": (0.30, 0.60),
    "model_stiffness_per_s2": (0.0, 0.05),
    "wavelet_slope_kmh_per_s": (0.3, 3.0),
    "softening_max": (0.5, 0.95),
    "softening_min": (0.4, 0.9),
    "softening_exponent": (0.5, 2.0),
}

Row = tuple[Constant, ...]


@dataclass(frozen=True)
class IpfcConstants:
    """Constant table of the law. A ``Row`` is one vector, a tuple of rows a matrix."""

    #: Row n is (A_n1, A_n2, B_n).
    model: tuple[Row, ...] = field(metadata=held(GAIN_Q, "eq. (16), model of eq. (2) sampled with a zero-order hold"))
    #: i = 1..P.
    free: tuple[Row, ...] = field(metadata=held(GAIN_Q, "C (A^i - I), free response in eq. (18)"))
    step_response: Row = field(metadata=held(GAIN_Q, "C (A^(i-1) + ... + I) B, eq. (16)"))
    #: Row n - 1 gives coefficient n.
    set_point_fit: tuple[Row, ...] = field(metadata=held(GAIN_Q, "least squares fit of eq. (11)"))
    error_fit: tuple[Row, ...] = field(metadata=held(GAIN_Q, "least squares fit of eq. (15)"))
    gains_step: Row = field(metadata=held(GAIN_Q, "U of eq. (19), step basis"))
    gains_wavelet: Row = field(metadata=held(GAIN_Q, "U of eq. (19), wavelets of eqs. (20) and (21)"))
    per_period: Constant = field(metadata=held(RATE_Q, "1 / control period"))
    wavelet_change: Constant = field(metadata=held(SPEED_Q, "eq. (22): threshold times the horizon"))
    deviation_max: Constant = field(metadata=held(DEVIATION_Q, "limit of this implementation"))
    rise_max: Constant = field(metadata=held(SPEED_Q, "limit of this implementation"))
    rise_never: Constant = field(metadata=held(0, "M of eq. (23)"))
    rise_never_narrow: Constant = field(metadata=held(RISE_Q, "M of eq. (23) as far as fixed point needs it"))
    rise_window: Row = field(metadata=held(RISE_Q, "window of eq. (24), section 4.4"))
    rise_widths: Row = field(metadata=held(RISE_Q, "fuzzy widths of eq. (24), section 4.4"))
    rise_slopes: Row = field(metadata=held(RATE_Q, "1 / fuzzy widths of eq. (24)"))
    speed_window: Row = field(metadata=held(SPEED_Q, "window of eq. (25), section 4.4"))
    speed_widths: Row = field(metadata=held(SPEED_Q, "fuzzy widths of eq. (25), section 4.4"))
    speed_slopes: Row = field(metadata=held(RATE_Q, "1 / fuzzy widths of eq. (25)"))
    one_speed: Constant = field(metadata=held(SPEED_Q, "1"))
    one_satisfaction: Constant = field(metadata=held(SATISFACTION_Q, "1"))
    one_softening: Constant = field(metadata=held(SOFTENING_Q, "1"))
    notch_max: Constant = field(metadata=held(NOTCH_RAW_Q, "notch range of the train"))
    zero: Constant = field(metadata=held(SPEED_Q, "0"))
    basis: Row = field(metadata=held(0, "codes of CTL_STAT: step, wavelet basis"))
    #: Rows h, columns n = 1, 2, ...
    point_powers: tuple[Row, ...] = field(metadata=held(0, "h^n at the fitting points of eq. (18), section 4.4"))
    softening: Row = field(metadata=held(SOFTENING_Q, "eq. (27) at mu = i/256"))

    def entries(self) -> tuple[Constant, ...]:
        """All constants, in the order of the fields."""
        return flatten(self)


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
def softening_function(parameters: IpfcParameters) -> Callable[[float], float]:
    """Eq. (27): alpha over the satisfaction mu."""
    slope = math.log(parameters.softening_min / parameters.softening_max)

    def alpha(mu: float) -> float:
        return parameters.softening_max * math.exp(mu**parameters.softening_exponent * slope)

    return alpha


def softening_curve(parameters: IpfcParameters, table: IpfcConstants) -> Curve:
    """Eq. (27) with its samples in the table."""
    return Curve("softening", softening_function(parameters), SATISFACTION_Q, SOFTENING_Q, table.softening)


def compute_constants(parameters: IpfcParameters, period_s: float, notch_max: float) -> IpfcConstants:
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
    alpha = softening_function(p)
    values = {
        "model": np.column_stack([model.a, model.b]),
        "free": model.free_rows(p.horizon),
        "step_response": model.step_response(p.horizon),
        "set_point_fit": polynomial_fit(range(1, p.horizon + 1), p.set_point_order),
        "error_fit": polynomial_fit(range(1 - p.error_window, 0), p.error_order),
        "gains_step": model.gains(step, p.fit_points),
        "gains_wavelet": model.gains(wavelets, p.fit_points),
        "per_period": 1 / period_s,
        "wavelet_change": p.wavelet_slope_kmh_per_s * p.horizon * period_s,
        "deviation_max": DEVIATION_MAX_KMH,
        "rise_max": DEVIATION_MAX_KMH,
        "rise_never": p.rise_time_never_s,
        "rise_never_narrow": RISE_TIME_MAX_S,
        "rise_window": (p.rise_time_min_s, p.rise_time_max_s),
        "rise_widths": (p.rise_width_below_s, p.rise_width_above_s),
        "rise_slopes": (1 / p.rise_width_below_s, 1 / p.rise_width_above_s),
        "speed_window": (-p.speed_below_kmh, p.speed_above_kmh),
        "speed_widths": (p.speed_width_below_kmh, p.speed_width_above_kmh),
        "speed_slopes": (1 / p.speed_width_below_kmh, 1 / p.speed_width_above_kmh),
        "one_speed": 1.0,
        "one_satisfaction": 1.0,
        "one_softening": 1.0,
        "notch_max": notch_max,
        "zero": 0.0,
        "basis": (BASIS_STEP, BASIS_WAVELET),
        "point_powers": ([h**n for n in p.orders] for h in p.fit_points),
        "softening": on_grid([alpha(i / 256) for i in range(257)], bits=48),
    }
    return build(IpfcConstants, values)


#: The checked-in table: the paper's parameters at 0.5 s and 7 notches.
TABLE = LawTable("ipfc", IpfcConstants, IpfcParameters(), 0.5, 7.0, compute_constants)


@lru_cache(maxsize=8)
def make_constants(parameters: IpfcParameters, period_s: float, notch_max: float) -> IpfcConstants:
    """As :func:`compute_constants`, but from the checked-in table at its operating point.

    Raises also :class:`~scenarios.errors.InputError` (one line) when that table is not as it was generated.
    """
    return TABLE.make(parameters, period_s, notch_max)
