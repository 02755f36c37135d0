"""Parameters of the TDMC law and the table of constants made from them.

Textbook dynamic matrix control (Cutler and Ramaker 1980). Parameters are in seconds, so that they are valid for every
control period; the plant's step response is that of the paper's model (see ``tdmc``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.ato.pfc_model import (
    InternalModel,
    Matrix,
    ModelDamping,
    ModelGain,
    ModelStiffness,
    on_grid,
)
from railhil.controller_node.laws.base import NOTCH_RAW_Q
from railhil.controller_node.laws.constant_table import LawTable, build, flatten, held

#: Predictions of the step-response model, km/h: in a step they reach 170 at 7 notches and 240 at 10, and their format
#: ends at 256 (with more notches than that allows, the controller does not start).
MODEL_Q = 23
#: Model error, correction line and deviations, km/h: their sums reach 3300 for the fastest reading on the wire, 5300
#: with parameters at the bounds of a search.
LINE_Q = 18
#: Control gains, correction gains.
GAIN_Q = 24
#: The model's coefficients are multiples of 2^-15 km/h per notch. A notch is a multiple of 2^-8, so the products are
#: exact in Q23: an unending sum of increments never drifts, in any arithmetic. 1.5e-5 km/h is far below the resolution
#: of a sensor.
COEFFICIENT_BITS = MODEL_Q - 8

#: Fixed-point limit of the deviations of the set-points from the prediction, km/h, and of the trend of the model error
#: in the prediction, km/h per s, exceeded only when a speed reading is suddenly wrong.
DEVIATION_MAX_KMH = 100.0
TREND_MAX_KMH_PER_S = 20.0

#: Longest model horizon in control periods: it bounds memory and time of a step.
MODEL_PERIODS_MAX = 600

Horizon = Annotated[float, Field(ge=0.1, le=60)]
CorrectionGain = Annotated[float, Field(ge=0, le=4)]


@dataclass(frozen=True, slots=True)
class TdmcParameters:
    """Parameters of the law. The model is the paper's; the paper does not give the other parameters, which are tuned by
    hand."""

    #: Eq. (2), in m/s per notch: numerator, and the two coefficients of the denominator.
    model_gain_mps: ModelGain = 0.07128
    model_damping_per_s: ModelDamping = 0.4356
    model_stiffness_per_s2: ModelStiffness = 0.0324
    #: Model horizon N: after 60 s the response is within 0.5 % of its final value.
    model_horizon_s: Annotated[float, Field(ge=1, le=120)] = 60.0
    #: Prediction horizon P and control horizon M.
    prediction_horizon_s: Horizon = 7.5
    control_horizon_s: Horizon = 2.0
    #: Q: weight of the last predicted error relative to the first, geometric in between. R: weight of a squared move
    #: (notch^2) against squared errors ((km/h)^2).
    last_error_weight: Annotated[float, Field(ge=1e-3, le=1e3)] = 1.0
    move_weight: Annotated[float, Field(ge=0, le=1e6)] = 0.1
    #: Correction vector h_i = level + ramp (i - 1).
    correction_level: CorrectionGain = 1.0
    correction_ramp: CorrectionGain = 0.6


#: Bounds of a search. They include the model's gain because it is an estimate of the train.
TUNABLE: dict[str, tuple[float, float]] = {
    "model_gain_mps": (0.05, 0.10),
    "prediction_horizon_s": (4.0, 12.0),
    "control_horizon_s": (1.0, 4.0),
    "last_error_weight": (0.1, 10.0),
    "move_weight": (0.02, 3.0),
    "correction_level": (0.5, 1.0),
    "correction_ramp": (0.05, 0.9),
}

Row = tuple[Constant, ...]


@dataclass(frozen=True)
class TdmcConstants:
    """Constant table of the law; horizons N and P are the lengths of the first two rows."""

    step_response: Row = field(metadata=held(MODEL_Q, "a_1..a_N: step response of eq. (2) of the paper"))
    gains: Row = field(metadata=held(GAIN_Q, "d: first row of (A^T Q A + R)^-1 A^T Q"))
    correction_level: Constant = field(metadata=held(GAIN_Q, "h_1"))
    correction_ramp: Constant = field(metadata=held(GAIN_Q, "h_(i+1) - h_i"))
    deviation_max: Constant = field(metadata=held(LINE_Q, "limit of this implementation"))
    trend_max: Constant = field(metadata=held(LINE_Q, "limit of this implementation, per control period"))
    notch_max: Constant = field(metadata=held(NOTCH_RAW_Q, "notch range of the train"))
    zero: Constant = field(metadata=held(LINE_Q, "0"))

    def entries(self) -> tuple[Constant, ...]:
        """All constants, in the order of the fields."""
        return flatten(self)


def periods(duration_s: float, period_s: float) -> int:
    """Control periods in a duration, at least one."""
    return max(1, round(duration_s / period_s))


def dynamic_matrix(step_response: Matrix, horizon: int, moves: int) -> Matrix:
    """A: predicted outputs 1..P over moves 1..M, A_ij = a_(i-j+1), shape (horizon, moves)."""
    matrix = np.zeros((horizon, moves))
    for j in range(moves):
        matrix[j:, j] = step_response[: horizon - j]
    return matrix


def control_gains(matrix: Matrix, error_weights: ArrayLike, move_weight: float) -> Matrix:
    """First row of (A^T Q A + R I)^-1 A^T Q: the first move for each predicted deviation, shape (P,).

    :param error_weights: diagonal of Q, shape (P,).
    """
    weighted = matrix.T * np.asarray(error_weights)
    return np.asarray(np.linalg.solve(weighted @ matrix + move_weight * np.eye(matrix.shape[1]), weighted)[0])


def largest_predictions(step_response: Sequence[float]) -> list[float]:
    """Largest magnitude of each prediction of the model, in km/h per notch of the notch range, before the last move.

    Prediction i is the sum of a_(i+j) times the move j periods ago. Summed by parts it is a_i times the last notch plus
    the subsequent increments of a times the earlier notches.
    """
    a = np.asarray(step_response)
    behind = np.append(np.cumsum(np.abs(np.diff(a))[::-1])[::-1], 0.0)
    return [float(x) for x in np.abs(a) + behind]


def correction_norms(level: float, ramp: float) -> tuple[float, float]:
    """Largest level and slope of the correction line per km/h of model error (L1 norms of their pulse responses).

    Raises ``ValueError`` when the correction does not decay.
    """
    line, slope, norms = level, ramp, [level, ramp]
    for _ in range(4000):
        innovation = -(line + slope)
        line, slope = line + slope + level * innovation, slope + ramp * innovation
        norms = [norms[0] + abs(line), norms[1] + abs(slope)]
    if not abs(line) + abs(slope) < 1e-9:
        raise ValueError(f"a correction of level {level:g} and ramp {ramp:g} does not settle")
    return norms[0], norms[1]


def compute_constants(parameters: TdmcParameters, period_s: float, notch_max: float) -> TdmcConstants:
    """The constant table at a control period (s) and a notch range (notches).

    Raises ``ValueError`` when a constant does not fit its format, the horizons are inconsistent, or the correction is
    unstable.
    """
    p = parameters
    n, horizon, moves = (periods(s, period_s) for s in (p.model_horizon_s, p.prediction_horizon_s, p.control_horizon_s))
    if not moves <= horizon <= n:
        raise ValueError(f"horizons of {moves} moves, {horizon} predictions and {n} coefficients do not nest")
    if n > MODEL_PERIODS_MAX:
        raise ValueError(f"model_horizon_s takes {n} control periods, more than {MODEL_PERIODS_MAX}")
    correction_norms(p.correction_level, p.correction_ramp)
    model = InternalModel.sampled(p.model_gain_mps * 3.6, p.model_damping_per_s, p.model_stiffness_per_s2, period_s)
    step_response = on_grid(model.step_response(n), COEFFICIENT_BITS)
    weights = p.last_error_weight ** np.linspace(0.0, 1.0, horizon)
    values = {
        "step_response": step_response,
        "gains": on_grid(control_gains(dynamic_matrix(step_response, horizon, moves), weights, p.move_weight)),
        "correction_level": p.correction_level,
        "correction_ramp": p.correction_ramp,
        "deviation_max": DEVIATION_MAX_KMH,
        "trend_max": TREND_MAX_KMH_PER_S * period_s,
        "notch_max": notch_max,
        "zero": 0.0,
    }
    return build(TdmcConstants, values)


#: The checked-in table: the default parameters at 0.5 s and 7 notches.
TABLE = LawTable("tdmc", TdmcConstants, TdmcParameters(), 0.5, 7.0, compute_constants)


@lru_cache(maxsize=8)
def make_constants(parameters: TdmcParameters, period_s: float, notch_max: float) -> TdmcConstants:
    """Like :func:`compute_constants`, but from the checked-in table at its operating point.

    Also raises :class:`~railhil.common.errors.InputError` (one line) if that table is not as generated.
    """
    return TABLE.make(parameters, period_s, notch_max)
