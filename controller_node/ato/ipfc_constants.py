"""Parameters of the IPFC law (defaults: the paper's) and the table of constants made from them.

Equation and section numbers refer to the paper (see ``ipfc``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from typing import Annotated

from pydantic import Field

from railhil.controller_node.arithmetic.base import Constant, Curve
from railhil.controller_node.ato.pfc_constants import (
    GAIN_Q,
    MODEL_TUNABLE,
    WAVELETS,
    PfcConstants,
    PfcParameters,
    Row,
    Slope,
    Wavelets,
    core_values,
    gains,
    internal_model,
    step_basis,
    wavelet_basis,
)
from railhil.controller_node.ato.pfc_model import BASIS_STEP, BASIS_WAVELET, SATISFACTION_Q, SOFTENING_Q, on_grid
from railhil.controller_node.laws.base import SPEED_Q
from railhil.controller_node.laws.constant_table import LawTable, build, held

#: Reciprocals of the fuzzy widths and of the control period.
RATE_Q = 20
#: Rise times: in Q20 the fuzzy width of 6 ms would be off by 7e-5, and no rise time would give a satisfaction of
#: exactly 0.
RISE_Q = 24

#: Fixed-point limit of the estimated rise time, s; all larger values also have satisfaction 0.
RISE_TIME_MAX_S = 1.0

RiseTime = Annotated[float, Field(ge=0, le=RISE_TIME_MAX_S)]
Speed = Annotated[float, Field(ge=0, le=100)]
#: Fuzzy width, s or km/h: its reciprocal has to fit ``RATE_Q``.
Width = Annotated[float, Field(ge=0.0005, le=100)]


@dataclass(frozen=True, slots=True)
class IpfcParameters(PfcParameters):
    """Parameters of the law, from section 4.4 of the paper where it states them."""

    wavelets: Wavelets = WAVELETS
    #: Eq. (22): mean acceleration over the horizon above which wavelets are used, km/h per s.
    wavelet_slope_kmh_per_s: Slope = 1.134
    #: Eq. (24): window of the rise time and its fuzzy widths, s.
    rise_time_min_s: RiseTime = 0.008
    rise_time_max_s: RiseTime = 0.02
    rise_width_below_s: Width = 0.006
    rise_width_above_s: Width = 0.006
    #: Eq. (25): window of the predicted speed around the target and its fuzzy widths, km/h.
    speed_below_kmh: Speed = 0.02
    speed_above_kmh: Speed = 0.02
    speed_width_below_kmh: Width = 0.02
    speed_width_above_kmh: Width = 0.02
    #: Eq. (27): alpha_max, alpha_max - alpha_min, beta.
    softening_max: Annotated[float, Field(gt=0, lt=1)] = 0.85
    softening_span: Annotated[float, Field(ge=0, lt=1)] = 0.08
    softening_exponent: Annotated[float, Field(ge=0.01, le=100)] = 0.94
    #: The "large number M" of eq. (23), s.
    rise_time_never_s: Annotated[float, Field(ge=RISE_TIME_MAX_S, le=1e9)] = 1e6

    @property
    def softening_min(self) -> float:
        """alpha_min of eq. (27)."""
        return self.softening_max - self.softening_span

    @property
    def free_points(self) -> Sequence[int]:
        """Eq. (25) is evaluated over the whole horizon."""
        return range(1, self.horizon + 1)


#: Bounds of a search.
TUNABLE: dict[str, tuple[float, float]] = {
    **MODEL_TUNABLE,
    "wavelet_slope_kmh_per_s": (0.0, 3.0),
    "softening_max": (0.5, 0.95),
    "softening_span": (0.0, 0.3),
    "softening_exponent": (0.5, 2.0),
}


@dataclass(frozen=True)
class IpfcConstants(PfcConstants):
    """Constant table of the law."""

    step_response: Row = field(metadata=held(GAIN_Q, "C (A^(i-1) + ... + I) B, eq. (16)"))
    gains_step: Row = field(metadata=held(GAIN_Q, "U of eq. (19), step basis"))
    gains_wavelet: Row = field(metadata=held(GAIN_Q, "U of eq. (19), wavelets of eqs. (20) and (21)"))
    per_period: Constant = field(metadata=held(RATE_Q, "1 / control period"))
    wavelet_change: Constant = field(metadata=held(SPEED_Q, "eq. (22): threshold times the horizon"))
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
    basis: Row = field(metadata=held(0, "codes of CTL_STAT: step, wavelet basis"))
    softening: Row = field(metadata=held(SOFTENING_Q, "eq. (27) at mu = i/256"))


def _softening(largest: float, exponent: float, slope: float, mu: float) -> float:
    return largest * math.exp(mu**exponent * slope)


@lru_cache(maxsize=8)
def softening_function(parameters: IpfcParameters) -> Callable[[float], float]:
    """Eq. (27): alpha over the satisfaction mu."""
    slope = math.log(parameters.softening_min / parameters.softening_max)
    # The batch compiles the function apart from its numbers.
    return partial(_softening, parameters.softening_max, parameters.softening_exponent, slope)


def softening_curve(parameters: IpfcParameters, table: IpfcConstants) -> Curve:
    """Eq. (27) with its samples in the table."""
    return Curve("softening", softening_function(parameters), SATISFACTION_Q, SOFTENING_Q, table.softening)


def compute_constants(parameters: IpfcParameters, period_s: float, notch_max: float) -> IpfcConstants:
    """The constant table at a control period (s) and a notch range (notches).

    Raises ``ValueError`` when a constant does not fit its format, or fitting points or orders are inconsistent.
    """
    p = parameters
    if p.softening_min <= 0:
        raise ValueError(f"softening_span {p.softening_span:g} is not below softening_max {p.softening_max:g}")
    if p.rise_time_min_s > p.rise_time_max_s:
        raise ValueError(f"rise_time_min_s {p.rise_time_min_s:g} is above rise_time_max_s {p.rise_time_max_s:g}")
    model = internal_model(p, period_s)
    alpha = softening_function(p)
    values = core_values(p, model, notch_max) | {
        "step_response": model.step_response(p.horizon),
        "gains_step": gains(model, step_basis(p.horizon), p.fit_points),
        "gains_wavelet": gains(model, wavelet_basis(p.wavelets, p.horizon, period_s), p.fit_points),
        "per_period": 1 / period_s,
        "wavelet_change": p.wavelet_slope_kmh_per_s * p.horizon * period_s,
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
        "basis": (BASIS_STEP, BASIS_WAVELET),
        "softening": on_grid([alpha(i / 256) for i in range(257)], bits=48),
    }
    return build(IpfcConstants, values)


#: The checked-in table: the paper's parameters at 0.5 s and 7 notches.
TABLE = LawTable("ipfc", IpfcConstants, IpfcParameters(), 0.5, 7.0, compute_constants)


@lru_cache(maxsize=8)
def make_constants(parameters: IpfcParameters, period_s: float, notch_max: float) -> IpfcConstants:
    """Like :func:`compute_constants`, but from the checked-in table at its operating point.

    Also raises :class:`~railhil.common.errors.InputError` (one line) if that table is not as generated.
    """
    return TABLE.make(parameters, period_s, notch_max)
