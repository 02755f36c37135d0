"""IPFC: predictive functional control of the train's speed with a switched basis and an adapted softening factor.

The core of ``pfc`` with section 3 of Wang et al. (see ``pfc_model``); equation numbers are theirs. Interpretations
where the paper leaves a choice, in addition to the core's: eq. (22) takes wavelets *above* the threshold, the
descriptions of the windows of eqs. (24) and (25) are swapped, eq. (23) uses the magnitude of the error.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.ato.ipfc_constants import (
    RATE_Q,
    RISE_Q,
    TUNABLE,
    IpfcParameters,
    make_constants,
    softening_curve,
)
from railhil.controller_node.ato.pfc import Basis, Pfc
from railhil.controller_node.ato.pfc_constants import GAIN_Q
from railhil.controller_node.ato.pfc_model import (
    BASIS_NOTE,
    SATISFACTION_NOTE,
    SATISFACTION_Q,
    SOFTENING_NOTE,
    SOFTENING_Q,
)
from railhil.controller_node.laws.base import NOTCH_Q, SPEED_Q, LawInputs, LawOutputs
from railhil.controller_node.laws.note import Note
from railhil.systems.ato.scenario.model import Scenario

# Shifts of the products: Q of the first factor + Q of the second - Q of the result.
_NOTCH_TO_SPEED = GAIN_Q + GAIN_Q - SPEED_Q
_SPEED_TO_SATISFACTION = SPEED_Q + RATE_Q - SATISFACTION_Q
_RISE_TO_SATISFACTION = RISE_Q + RATE_Q - SATISFACTION_Q


class IpfcState(NamedTuple, Generic[T]):
    """Memory of the law between two control periods.

    ``model`` is [y_m, dy_m/dt] in km/h and km/h/s (Q24), ``notch`` the notch last sent (Q24), ``model_errors`` the
    last errors y_p - y_m, oldest first, ``tracking_error`` the last y_s - y_p (km/h, Q20).
    """

    model: tuple[T, T]
    notch: T
    model_errors: tuple[T, ...]
    tracking_error: T


class Ipfc(Pfc[T, IpfcState[T]]):
    """The IPFC law on one arithmetic.

    Speeds in km/h (Q20), notch in notches. Raises ``ValueError`` for inconsistent parameters.
    """

    name: ClassVar[str] = "ipfc"
    parameters_type: ClassVar[type[Any]] = IpfcParameters
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = TUNABLE
    parameters_origin: ClassVar[str] = "the paper's, and ours where it prints none"
    notes: ClassVar[tuple[Note, ...]] = (BASIS_NOTE, SOFTENING_NOTE, SATISFACTION_NOTE)

    def __init__(self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: IpfcParameters | None = None) -> None:
        parameters = parameters or IpfcParameters()
        self.table = table = make_constants(
            parameters, scenario.timing.control_period_ns / 1e9, scenario.train.notch_max
        )
        step, wavelet = table.basis
        bases = (Basis(step, table.gains_step), Basis(wavelet, table.gains_wavelet))
        super().__init__(arithmetic, parameters, table, bases, table.wavelet_change)
        self._curve = softening_curve(parameters, table)
        self._fit_points = parameters.fit_points
        ar = arithmetic
        self._step_response = ar.load(table.step_response)
        self._per_period = ar.const(table.per_period)
        self._rise_never = ar.const(table.rise_never if ar.wide else table.rise_never_narrow)
        self._rise = (ar.load(table.rise_window), ar.load(table.rise_widths), ar.load(table.rise_slopes))
        self._speed = (ar.load(table.speed_window), ar.load(table.speed_widths), ar.load(table.speed_slopes))
        self._one = ar.const(table.one_speed)
        self._one_mu = ar.const(table.one_satisfaction)
        self._one_alpha = ar.const(table.one_softening)

    def start(self, inputs: LawInputs[T]) -> IpfcState[T]:
        """Model at rest; earlier errors are assumed equal to the first ones."""
        tracking_error = self._ar.sub(inputs.set_point, inputs.speed)
        errors = (inputs.speed,) * self._error_window
        return IpfcState((self._zero, self._zero), self._zero, errors, tracking_error)

    def with_sent(self, state: IpfcState[T], notch: T) -> IpfcState[T]:
        return state._replace(notch=self._ar.convert(notch, NOTCH_Q, GAIN_Q))

    def step(self, state: IpfcState[T], inputs: LawInputs[T]) -> tuple[IpfcState[T], LawOutputs[T]]:
        ar = self._ar
        now = self.observe(state.model, state.notch, state.model_errors, inputs)
        t_s = ar.note("t_s", self._rise_time(now.tracking_error, state.tracking_error), RISE_Q, "s")
        mu_ts = ar.note("mu_ts", self.rise_satisfaction(t_s), SATISFACTION_Q)
        mu_y = ar.note("mu_y", self._prediction_satisfaction(inputs, now.free, state.notch), SATISFACTION_Q)
        mu = ar.note("mu", ar.minimum(mu_ts, mu_y), SATISFACTION_Q)
        alpha = ar.note("alpha", self.softening(mu), SOFTENING_Q)
        command = self.command(now, self._closed(alpha), inputs)
        sent = ar.convert(command.notch, NOTCH_Q, GAIN_Q)
        new_state = IpfcState(now.model, sent, now.model_errors, now.tracking_error)
        return new_state, LawOutputs(command.notch_raw, command.notch, (command.basis, alpha, mu))

    def _closed(self, alpha: T) -> list[T]:
        """1 - alpha^h at the fitting points of eq. (18) (Q30)."""
        ar = self._ar
        powers = [alpha]
        while len(powers) < max(self._fit_points):
            powers.append(ar.rmpy(powers[-1], alpha, SOFTENING_Q))
        return [ar.sub(self._one_alpha, powers[point - 1]) for point in self._fit_points]

    def _rise_time(self, error: T, error_before: T) -> T:
        """Eq. (23) with the magnitude of the error, s (Q24)."""
        ar = self._ar
        size = ar.abs(error)
        closed = ar.sub(ar.abs(error_before), size)
        closing = ar.gt(closed, self._zero)
        rate = ar.where(closing, ar.rsmpy(closed, self._per_period, RATE_Q), self._one)
        if not ar.wide:
            # Limits the quotient to 1 s.
            rate = ar.maximum(rate, size)
        ratio = ar.div(size, rate, RISE_Q)
        return ar.where(closing, ratio, ar.where(ar.gt(size, self._zero), self._rise_never, self._zero))

    def rise_satisfaction(self, t_s: T) -> T:
        """Eq. (24): satisfaction (Q24) with a rise time in s (Q24); its cases in the published order, so 0 s gives
        1."""
        inside = self._membership(t_s, t_s, _RISE_TO_SATISFACTION, *self._rise)
        return self._ar.where(self._ar.gt(t_s, self._zero), inside, self._one_mu)

    def speed_satisfaction(self, low: T, high: T) -> T:
        """Minimum of eq. (25) (Q24), from the extremes of predicted speed minus target (km/h, Q20).

        The membership is monotone on each flank, so the extremes over the horizon suffice.
        """
        return self._membership(low, high, _SPEED_TO_SATISFACTION, *self._speed)

    def softening(self, mu: T) -> T:
        """Eq. (27): softening factor alpha (Q30) of a satisfaction (Q24)."""
        return self._ar.curve(self._curve, mu)

    def _membership(
        self, low: T, high: T, shift: int, window: tuple[T, ...], widths: tuple[T, ...], slopes: tuple[T, ...]
    ) -> T:
        """Trapezoid of eqs. (24) and (25), the smaller of that of ``low`` and of ``high`` where low <= high (Q24).

        Left and right flank are clipped to their widths before the product, which therefore cannot overflow.
        """
        ar = self._ar
        below = ar.clip(ar.sub(low, window[0]), self._zero, ar.neg(widths[0]))
        above = ar.clip(ar.sub(high, window[1]), widths[1], self._zero)
        left = ar.add(self._one_mu, ar.rmpy(below, slopes[0], shift))
        right = ar.sub(self._one_mu, ar.rmpy(above, slopes[1], shift))
        return ar.clip(ar.minimum(left, right), self._one_mu, self._zero)

    def _prediction_satisfaction(self, inputs: LawInputs[T], free: tuple[T, ...], notch: T) -> T:
        """Smallest satisfaction of eq. (25) over the horizon with an unchanged notch."""
        ar = self._ar
        misses = [
            ar.sub(ar.add(ar.add(inputs.speed, change), ar.rmpy(response, notch, _NOTCH_TO_SPEED)), target)
            for change, response, target in zip(free, self._step_response, inputs.preview, strict=True)
        ]
        low = high = misses[0]
        for miss in misses[1:]:
            low, high = ar.minimum(low, miss), ar.maximum(high, miss)
        low = ar.note("miss_low", low, SPEED_Q, "km/h")
        high = ar.note("miss_high", high, SPEED_Q, "km/h")
        return self.speed_satisfaction(low, high)
