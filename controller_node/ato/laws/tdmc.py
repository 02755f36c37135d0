"""TDMC: traditional dynamic matrix control of the train's speed.

The textbook law (Cutler and Ramaker, "Dynamic matrix control - a computer control algorithm", Joint Automatic Control
Conference 1980), one of the comparators of Wang et al., DOI 10.19650/j.cnki.cjsi.J2108765, who name it without its
equations. Each control period: the last move is added to the predictions, the vector is shifted by one period and its
last entry is repeated; the prediction error corrects the predictions by h_i = h_1 + r (i - 1); the move is d . (future
set-points - corrected predictions).

The correction has a ramp because the model differs from the train: under a constant notch the model's speed settles
while the train continues to accelerate, so their difference is a ramp, and a constant correction lags behind it (13 m
at the stop).

The predictions are kept in two parts, from moves and from corrections. All corrections together form a straight line,
so two numbers represent them, and a shift moves along the line. The single vector of the textbook also repeats the last
entry of the line; this reaches the prediction horizon only after N - P periods and has no advantage.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.ato.guard import SPEED_MAX_01MMPS
from railhil.controller_node.ato.tdmc_constants import (
    GAIN_Q,
    LINE_Q,
    MODEL_Q,
    TUNABLE,
    TdmcParameters,
    correction_norms,
    largest_predictions,
    make_constants,
)
from railhil.controller_node.laws.base import NOTCH_Q, NOTCH_RAW_Q, SPEED_Q, Law, LawInputs, LawOutputs
from railhil.systems.ato.scenario.model import Scenario

# Shifts of the products: Q of the first factor + Q of the second - Q of the result.
_RESPONSE_BY_MOVE_TO_MODEL = NOTCH_Q
_GAIN_TO_LINE = GAIN_Q
_GAIN_TO_NOTCH = GAIN_Q + LINE_Q - NOTCH_RAW_Q

_SPEED_MAX_KMH = SPEED_MAX_01MMPS * 3.6e-4


class TdmcState(NamedTuple, Generic[T]):
    """Memory of the law between two control periods.

    ``predictions``: speeds 1..N periods after the last step, from all moves but the last (km/h, Q23). ``level`` and
    ``slope`` of the correction line at the last step (km/h, km/h per period, Q18). ``notch``: the last one sent and the
    one before it (Q8).
    """

    predictions: tuple[T, ...]
    level: T
    slope: T
    notch: T
    notch_before: T


class Tdmc(Law[T, TdmcState[T]]):
    """The TDMC law on one arithmetic.

    Speeds in km/h (Q20), notch in notches. Raises ``ValueError`` for inconsistent parameters.
    """

    name: ClassVar[str] = "tdmc"
    parameters_type: ClassVar[type[Any]] = TdmcParameters
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = TUNABLE
    parameters_origin: ClassVar[str] = "textbook values, chosen by hand on nominal runs"

    def __init__(self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: TdmcParameters | None = None) -> None:
        self.parameters = parameters = parameters or TdmcParameters()
        self.table = table = make_constants(
            parameters, scenario.timing.control_period_ns / 1e9, scenario.train.notch_max
        )
        self._ar = ar = arithmetic
        self._step_response = ar.load(table.step_response)
        self._gains = ar.load(table.gains)
        self._correction_level = ar.const(table.correction_level)
        self._correction_ramp = ar.const(table.correction_ramp)
        self._deviation_max = ar.const(table.deviation_max)
        self._deviation_min = ar.neg(self._deviation_max)
        self._trend_max = ar.const(table.trend_max)
        self._trend_min = ar.neg(self._trend_max)
        self._notch_max = ar.const(table.notch_max)
        self._notch_min = ar.neg(self._notch_max)
        self._zero = ar.const(table.zero)

    @property
    def horizon(self) -> int:
        return len(self.table.gains)

    @property
    def constants(self) -> tuple[Constant, ...]:
        return self.table.entries()

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        """Predictions under any notches inside the range, and the correction line under any speed on the wire.

        The predictions are exact; a millionth is added to the correction line for the rounding of its products.
        """
        notch_max = self.table.notch_max.value
        sizes = [notch_max * size for size in largest_predictions([a.value for a in self.table.step_response])]
        bounds = {f"predictions[{i}]": (-size, size) for i, size in enumerate(sizes)}
        worst = _SPEED_MAX_KMH + sizes[0]
        norms = correction_norms(self.table.correction_level.value, self.table.correction_ramp.value)
        for name, norm in zip(("level", "slope"), norms, strict=True):
            size = worst * norm * (1 + 1e-6) + 1e-3
            bounds[name] = (-size, size)
        return bounds

    def start(self, inputs: LawInputs[T]) -> TdmcState[T]:
        """Model at rest; an initial speed is treated as a constant error of the model."""
        resting = (self._zero,) * len(self._step_response)
        level = self._ar.convert(inputs.speed, SPEED_Q, LINE_Q)
        return TdmcState(resting, level, self._zero, self._zero, self._zero)

    def with_sent(self, state: TdmcState[T], notch: T) -> TdmcState[T]:
        return state._replace(notch=notch)

    def step(self, state: TdmcState[T], inputs: LawInputs[T]) -> tuple[TdmcState[T], LawOutputs[T]]:
        ar = self._ar
        move = ar.note("move", ar.sub(state.notch, state.notch_before), NOTCH_Q, "notch")
        moved = [
            ar.add(prediction, ar.rmpy(response, move, _RESPONSE_BY_MOVE_TO_MODEL))
            for prediction, response in zip(state.predictions, self._step_response, strict=True)
        ]
        predictions = (*moved[1:], moved[-1])
        y_m = ar.note("y_m", ar.convert(moved[0], MODEL_Q, LINE_Q), LINE_Q, "km/h")
        model_error = ar.sub(ar.convert(inputs.speed, SPEED_Q, LINE_Q), y_m)
        model_error = ar.note("model_error", model_error, LINE_Q, "km/h")
        level, slope = self._corrected(state, model_error)
        deviations = self._deviations(inputs, predictions, level, slope)

        change = ar.note("change", ar.dot(self._gains, deviations, _GAIN_TO_NOTCH), NOTCH_RAW_Q, "notch")
        notch_raw = ar.add(ar.convert(state.notch, NOTCH_Q, NOTCH_RAW_Q), change)
        notch_raw = ar.note("notch_raw", notch_raw, NOTCH_RAW_Q, "notch")
        clipped = ar.clip(notch_raw, self._notch_max, self._notch_min)
        notch = ar.note("notch", ar.quantise(clipped, NOTCH_RAW_Q, NOTCH_Q), NOTCH_Q, "notch")
        new_state = TdmcState(predictions, level, slope, notch, state.notch)
        return new_state, LawOutputs(notch_raw, notch)

    def _corrected(self, state: TdmcState[T], model_error: T) -> tuple[T, T]:
        """Level and slope of the correction line: shifted by one period, then corrected by h times the prediction
        error."""
        ar = self._ar
        expected = ar.add(state.level, state.slope)
        missed = ar.note("missed", ar.sub(model_error, expected), LINE_Q, "km/h")
        level = ar.add(expected, ar.rmpy(self._correction_level, missed, _GAIN_TO_LINE))
        slope = ar.add(state.slope, ar.rmpy(self._correction_ramp, missed, _GAIN_TO_LINE))
        return ar.note("level", level, LINE_Q, "km/h"), ar.note("slope", slope, LINE_Q, "km/h")

    def _deviations(self, inputs: LawInputs[T], predictions: tuple[T, ...], level: T, slope: T) -> tuple[T, ...]:
        """Future set-points minus corrected predictions (km/h, Q18)."""
        ar = self._ar
        if not ar.wide:
            slope = ar.sat(slope, self._trend_max, self._trend_min)
        line, deviations = level, []
        for target, prediction in zip(inputs.preview, predictions, strict=False):
            line = ar.add(line, slope)
            free = ar.add(ar.convert(prediction, MODEL_Q, LINE_Q), line)
            deviation = ar.sub(ar.convert(target, SPEED_Q, LINE_Q), free)
            if not ar.wide:
                deviation = ar.sat(deviation, self._deviation_max, self._deviation_min)
            deviations.append(deviation)
        return ar.note_all("deviation", deviations, LINE_Q, "km/h")
