"""Parameters of the fuzzy PID law, its rules, and the table of constants made from them.

Gains are for continuous time, so that they are valid for every control period (see ``fuzzy_pid``).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Annotated

from pydantic import Field

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.laws.base import NOTCH_RAW_Q, SPEED_Q
from railhil.controller_node.laws.constant_table import LawTable, build, flatten, held

#: Gains per control period, memberships, scaled inputs, outputs of the rules.
GAIN_Q = 24

#: Fixed-point limits of the error and of its second difference, km/h, exceeded only when a speed reading is suddenly
#: wrong.
ERROR_MAX_KMH = 100.0
BEND_MAX_KMH = 20.0

#: Fuzzy sets NB, NM, NS, ZO, PS, PM, PB: where their triangles peak on the scaled axis -3..3.
PEAKS = (-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0)

# Rules after Zhao, Tomizuka and Isaka, "Fuzzy gain scheduling of PID controllers", IEEE Trans. Systems, Man and
# Cybernetics 23(5), 1993: far from the target, or crossing it slowly, act strongly; crossing it fast, act weakly and
# damp.
# Rows: error NB..PB; columns: change of the error NB..PB. Here every rule gives the deviation of a gain from its
# nominal value, as a share of its span.
_HALVES = {
    "kp": (
        "PB PB PB PB PB PB PB",
        "NB PB PB PB PB PB NB",
        "NB NB PB PB PB NB NB",
        "NB NB NB PB NB NB NB",
    ),
    # Their ratio of integral to derivative time is 2, 3, 4, 5 where this table has PB, PS, NS, NB.
    "ki": (
        "PB PB PB PB PB PB PB",
        "PS PS PB PB PB PS PS",
        "NS PS PS PB PS PS NS",
        "NB NS PS PS PS NS NB",
    ),
    "kd": (
        "NB NB NB NB NB NB NB",
        "PB PB NB NB NB PB PB",
        "PB PB PB NB PB PB PB",
        "PB PB PB PB PB PB PB",
    ),
}
_SHARES = {"NB": -1.0, "NM": -2 / 3, "NS": -1 / 3, "ZO": 0.0, "PS": 1 / 3, "PM": 2 / 3, "PB": 1.0}

Shares = tuple[tuple[float, ...], ...]
Gain = Annotated[float, Field(ge=0, le=100)]
#: Above 1 a gain could change sign.
Span = Annotated[float, Field(ge=0, le=1)]
Big = Annotated[float, Field(ge=0.03, le=100)]


def rules(gain: str) -> Shares:
    """Rule table of ``kp``, ``ki`` or ``kd`` as shares -1..1, shape (7, 7).

    The tables are symmetric about zero error, so a train above its target is treated like one below.
    """
    half = [tuple(_SHARES[label] for label in row.split()) for row in _HALVES[gain]]
    return (*half, *half[-2::-1])


@dataclass(frozen=True, slots=True)
class FuzzyPidParameters:
    """Parameters of the law, tuned by hand, because the paper gives none.

    The plant is nearly an integrator of 0.75 km/h/s per notch behind a lag of 2.9 s; derivative time 2 s, integral time
    4 s and a crossover near 1.3 rad/s leave the loop stable with its delay.
    """

    #: Nominal gains: notch per km/h, notch per km/h and s, notch per km/h/s.
    proportional: Gain = 2.0
    integral_per_s: Gain = 0.5
    derivative_s: Gain = 4.0
    #: Span by which the rules move each gain, as a share of its nominal value.
    proportional_span: Span = 0.3
    integral_span: Span = 0.5
    derivative_span: Span = 0.3
    #: Error and its rate of change that are "big" (peak of NB and PB).
    error_big_kmh: Big = 1.0
    rate_big_kmh_per_s: Big = 1.0
    #: Time before the stop from which traction is suppressed.
    no_traction_s: Annotated[float, Field(ge=0, le=30)] = 2.0


#: Bounds of a search.
TUNABLE: dict[str, tuple[float, float]] = {
    "proportional": (0.5, 4.0),
    "integral_per_s": (0.02, 1.5),
    "derivative_s": (0.5, 8.0),
    "proportional_span": (0.0, 0.9),
    "integral_span": (0.0, 0.9),
    "derivative_span": (0.0, 0.9),
    "error_big_kmh": (0.2, 5.0),
    "rate_big_kmh_per_s": (0.2, 5.0),
}

Row = tuple[Constant, ...]


@dataclass(frozen=True)
class FuzzyPidConstants:
    """Constant table of the law. Rules: rows over the error, columns over its change."""

    rules_kp: tuple[Row, ...] = field(metadata=held(GAIN_Q, "rules of the proportional gain, share of its span"))
    rules_ki: tuple[Row, ...] = field(metadata=held(GAIN_Q, "rules of the integral gain, share of its span"))
    rules_kd: tuple[Row, ...] = field(metadata=held(GAIN_Q, "rules of the derivative gain, share of its span"))
    peaks: Row = field(metadata=held(GAIN_Q, "peaks of NB..PB on the scaled axis"))
    gains: Row = field(metadata=held(GAIN_Q, "middle of Kp, Ki Ts, Kd / Ts: notch per km/h"))
    spans: Row = field(metadata=held(GAIN_Q, "spans of the same, notch per km/h"))
    error_big: Constant = field(metadata=held(SPEED_Q, "error at the peak of PB"))
    change_big: Constant = field(metadata=held(SPEED_Q, "change per control period at the peak of PB"))
    error_scale: Constant = field(metadata=held(GAIN_Q, "3 / error at the peak of PB"))
    change_scale: Constant = field(metadata=held(GAIN_Q, "3 / change at the peak of PB"))
    error_max: Constant = field(metadata=held(SPEED_Q, "limit of this implementation"))
    bend_max: Constant = field(metadata=held(SPEED_Q, "limit of this implementation"))
    one: Constant = field(metadata=held(GAIN_Q, "1"))
    notch_max: Constant = field(metadata=held(NOTCH_RAW_Q, "notch range of the train"))
    zero: Constant = field(metadata=held(SPEED_Q, "0"))

    def entries(self) -> tuple[Constant, ...]:
        """All constants, in the order of the fields."""
        return flatten(self)


def compute_constants(parameters: FuzzyPidParameters, period_s: float, notch_max: float) -> FuzzyPidConstants:
    """The constant table at a control period (s) and a notch range (notches).

    Raises ``ValueError`` when a constant does not fit its format.
    """
    p = parameters
    gains = (p.proportional, p.integral_per_s * period_s, p.derivative_s / period_s)
    shares = (p.proportional_span, p.integral_span, p.derivative_span)
    change_big = p.rate_big_kmh_per_s * period_s
    values = {
        "rules_kp": rules("kp"),
        "rules_ki": rules("ki"),
        "rules_kd": rules("kd"),
        "peaks": PEAKS,
        "gains": gains,
        "spans": [gain * share for gain, share in zip(gains, shares, strict=True)],
        "error_big": p.error_big_kmh,
        "change_big": change_big,
        "error_scale": PEAKS[-1] / p.error_big_kmh,
        "change_scale": PEAKS[-1] / change_big,
        "error_max": ERROR_MAX_KMH,
        "bend_max": BEND_MAX_KMH,
        "one": 1.0,
        "notch_max": notch_max,
        "zero": 0.0,
    }
    return build(FuzzyPidConstants, values)


#: The checked-in table: the default parameters at 0.5 s and 7 notches.
TABLE = LawTable("fuzzy_pid", FuzzyPidConstants, FuzzyPidParameters(), 0.5, 7.0, compute_constants)


@lru_cache(maxsize=8)
def make_constants(parameters: FuzzyPidParameters, period_s: float, notch_max: float) -> FuzzyPidConstants:
    """Like :func:`compute_constants`, but from the checked-in table at its operating point.

    Also raises :class:`~railhil.common.errors.InputError` (one line) if that table is not as generated.
    """
    return TABLE.make(parameters, period_s, notch_max)
