"""Fuzzy PID: an incremental PID of the speed error whose three gains follow fuzzy rules.

The textbook law, one of the comparators of Wang et al., DOI 10.19650/j.cnki.cjsi.J2108765, who name it without its
equations: error e and change ec are each described by seven triangular sets NB..PB, 49 rules give the shift of each
gain from its nominal value, and

    du = Kp ec + Ki Ts e + Kd / Ts (ec - ec before)

Product inference, defuzzification by the centre of singletons. Neighbouring triangles add up to 1, and so do the 49
products, so the centroid needs no division. The only memory of the incremental form is the notch really sent, so there
is no wind-up at the end of the notch range.

No traction is requested in the last two seconds before the stop, that is, once the future set-point is below zero. With
set-points by time this hardly ever acts. With set-points by distance they fall with the square root of the remaining
distance: a train slightly too slow would be accelerated again and overrun the stopping point.

Rules: see ``fuzzy_pid_constants``. They are symmetric, so (-e, -ec) gives the opposite notch. The tables most often
reprinted (Kp from PB at e = ec = NB down to NB at e = ec = PB) are not: with them a train that is too slow has other
gains than one that is too fast.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.ato.fuzzy_pid_constants import GAIN_Q, TUNABLE, FuzzyPidParameters, make_constants
from railhil.controller_node.laws.base import NOTCH_Q, NOTCH_RAW_Q, SPEED_Q, Law, LawInputs, LawOutputs
from railhil.systems.ato.scenario.model import Scenario

# Shifts of the products: Q of the first factor + Q of the second - Q of the result.
_SPEED_TO_SCALED = SPEED_Q
_GAIN_TO_GAIN = GAIN_Q
_GAIN_TO_NOTCH = GAIN_Q + SPEED_Q - NOTCH_RAW_Q


class FuzzyPidState(NamedTuple, Generic[T]):
    """Memory of the law between two control periods: last error and its last change (km/h, Q20), notch sent (Q8)."""

    error: T
    change: T
    notch: T


class FuzzyPid(Law[T, FuzzyPidState[T]]):
    """The fuzzy PID law on one arithmetic.

    Speeds in km/h (Q20), notch in notches. Raises ``ValueError`` for parameters that do not fit its formats.
    """

    name: ClassVar[str] = "fuzzy_pid"
    parameters_type: ClassVar[type[Any]] = FuzzyPidParameters
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = TUNABLE
    parameters_origin: ClassVar[str] = "rules from the literature, gains chosen by hand on nominal runs"

    def __init__(
        self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: FuzzyPidParameters | None = None
    ) -> None:
        self.parameters = parameters = parameters or FuzzyPidParameters()
        period_s = scenario.timing.control_period_ns / 1e9
        self._horizon = max(1, round(parameters.no_traction_s / period_s))
        self.table = table = make_constants(parameters, period_s, scenario.train.notch_max)
        self._ar = ar = arithmetic
        self._rules = [tuple(ar.load(row) for row in rows) for rows in (table.rules_kp, table.rules_ki, table.rules_kd)]
        self._peaks = ar.load(table.peaks)
        self._gains = ar.load(table.gains)
        self._spans = ar.load(table.spans)
        self._error_big = ar.const(table.error_big)
        self._change_big = ar.const(table.change_big)
        self._error_scale = ar.const(table.error_scale)
        self._change_scale = ar.const(table.change_scale)
        self._error_max = ar.const(table.error_max)
        self._error_min = ar.neg(self._error_max)
        self._bend_max = ar.const(table.bend_max)
        self._bend_min = ar.neg(self._bend_max)
        self._one = ar.const(table.one)
        self._notch_max = ar.const(table.notch_max)
        self._notch_min = ar.neg(self._notch_max)
        self._zero = ar.const(table.zero)

    @property
    def horizon(self) -> int:
        """The PID needs only the set-point of its own period; future ones show that the stop is near."""
        return self._horizon

    @property
    def constants(self) -> tuple[Constant, ...]:
        return self.table.entries()

    def start(self, inputs: LawInputs[T]) -> FuzzyPidState[T]:
        """Earlier errors are assumed equal to the first."""
        ar = self._ar
        error = ar.sub(inputs.set_point, inputs.speed)
        if not ar.wide:
            # Saturation by the format limit is counted in the following step.
            error = ar.clip(error, self._error_max, self._error_min)
        return FuzzyPidState(error, self._zero, self._zero)

    def with_sent(self, state: FuzzyPidState[T], notch: T) -> FuzzyPidState[T]:
        return state._replace(notch=notch)

    def step(self, state: FuzzyPidState[T], inputs: LawInputs[T]) -> tuple[FuzzyPidState[T], LawOutputs[T]]:
        ar = self._ar
        error = ar.sub(inputs.set_point, inputs.speed)
        if not ar.wide:
            error = ar.sat(error, self._error_max, self._error_min)
        error = ar.note("error", error, SPEED_Q, "km/h")
        change = ar.note("change", ar.sub(error, state.error), SPEED_Q, "km/h")
        bend = ar.sub(change, state.change)
        if not ar.wide:
            bend = ar.sat(bend, self._bend_max, self._bend_min)
        bend = ar.note("bend", bend, SPEED_Q, "km/h")

        gains = ar.note_all("gain", self.gains(error, change), GAIN_Q, "notch/(km/h)")
        increment = ar.note("increment", ar.dot(gains, (change, error, bend), _GAIN_TO_NOTCH), NOTCH_RAW_Q, "notch")
        notch_raw = ar.add(ar.convert(state.notch, NOTCH_Q, NOTCH_RAW_Q), increment)
        notch_raw = ar.note("notch_raw", notch_raw, NOTCH_RAW_Q, "notch")
        # No traction close to the stop.
        upper = ar.where(ar.gt(self._zero, inputs.preview[-1]), self._zero, self._notch_max)
        clipped = ar.clip(notch_raw, upper, self._notch_min)
        notch = ar.note("notch", ar.quantise(clipped, NOTCH_RAW_Q, NOTCH_Q), NOTCH_Q, "notch")
        return FuzzyPidState(error, change, notch), LawOutputs(notch_raw, notch)

    def gains(self, error: T, change: T) -> list[T]:
        """Gains per control period of ec, e and the change of ec: notch per km/h (Q24)."""
        ar = self._ar
        in_error = self._memberships(error, self._error_big, self._error_scale)
        in_change = self._memberships(change, self._change_big, self._change_scale)
        found = []
        for middle, span, rows in zip(self._gains, self._spans, self._rules, strict=True):
            by_error = [ar.dot(row, in_change, _GAIN_TO_GAIN) for row in rows]
            # Already inside -1..1, because memberships add up to 1; repeated for the interval analysis.
            share = ar.clip(ar.dot(by_error, in_error, _GAIN_TO_GAIN), self._one, ar.neg(self._one))
            found.append(ar.add(middle, ar.rmpy(span, share, _GAIN_TO_GAIN)))
        return found

    def _memberships(self, value: T, big: T, scale: T) -> list[T]:
        """Membership of a value (km/h, Q20) in each of NB..PB (Q24); beyond the outer peaks it is 1 in the outer
        set."""
        ar = self._ar
        scaled = ar.rmpy(ar.clip(value, big, ar.neg(big)), scale, _SPEED_TO_SCALED)
        scaled = ar.clip(scaled, self._peaks[-1], self._peaks[0])
        distances = [ar.abs(ar.sub(scaled, peak)) for peak in self._peaks]
        return [ar.maximum(ar.sub(self._one, distance), self._zero) for distance in distances]
