"""IPFC: predictive functional control of the train's speed with a switched basis and an adapted softening factor.

Law of Wang et al., "An improved predictive function control algorithm for velocity curve of urban rail vehicle",
Chinese Journal of Scientific Instrument, DOI 10.19650/j.cnki.cjsi.J2108765; equation numbers below are the paper's.
Readings of what the paper leaves open: eq. (11) counts i in samples, eq. (18) takes (c_n - e_n) and the free
response with a minus sign, eq. (22) takes wavelets *above* the threshold, the windows of eqs. (24) and (25) have
their words swapped, eq. (23) works on the size of the error. The internal model runs in parallel to the train,
driven by the notch really sent.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Generic, NamedTuple

from controller_node.arithmetic.base import Arithmetic, Constant, T
from controller_node.laws.base import (
    NOTCH_Q,
    NOTCH_RAW_Q,
    SATISFACTION_Q,
    SOFTENING_Q,
    SPEED_Q,
    Law,
    LawInputs,
    LawOutputs,
)
from controller_node.laws.ipfc_constants import (
    DEVIATION_Q,
    GAIN_Q,
    POLYNOMIAL_Q,
    RATE_Q,
    RISE_Q,
    TUNABLE,
    IpfcParameters,
    make_constants,
    softening_curve,
)
from scenarios.model import Scenario

# Shifts of the products: Q of the first factor + Q of the second - Q of the result.
_GAIN_TO_GAIN = GAIN_Q
_GAIN_TO_SPEED = GAIN_Q + GAIN_Q - SPEED_Q
_SPEED_TO_POLYNOMIAL = SPEED_Q + GAIN_Q - POLYNOMIAL_Q
_POLYNOMIAL_BY_COUNT_TO_DEVIATION = POLYNOMIAL_Q - DEVIATION_Q
_DEVIATION_TO_NOTCH = DEVIATION_Q + GAIN_Q - NOTCH_RAW_Q
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


class Ipfc(Law[T, IpfcState[T]]):
    """The IPFC law on one arithmetic.

    Speeds in km/h (Q20), notch in notches. Raises ``ValueError`` for parameters that do not fit each other.
    """

    name: ClassVar[str] = "ipfc"
    parameters_type: ClassVar[type[Any]] = IpfcParameters
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = TUNABLE

    def __init__(self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: IpfcParameters | None = None) -> None:
        self.parameters = parameters = parameters or IpfcParameters()
        self.table = table = make_constants(
            parameters, scenario.timing.control_period_ns / 1e9, scenario.train.notch_max
        )
        self._curve = softening_curve(parameters, table)
        self._ar = ar = arithmetic
        self._fit_points = parameters.fit_points
        self._orders = parameters.orders
        self._model = tuple(ar.load(row) for row in table.model)
        self._free = tuple(ar.load(row) for row in table.free)
        self._step_response = ar.load(table.step_response)
        self._set_point_fit = tuple(ar.load(row) for row in table.set_point_fit)
        self._error_fit = tuple(ar.load(row) for row in table.error_fit)
        self._gains_step = ar.load(table.gains_step)
        self._gains_wavelet = ar.load(table.gains_wavelet)
        self._per_period = ar.const(table.per_period)
        self._wavelet_change = ar.const(table.wavelet_change)
        self._deviation_max = ar.const(table.deviation_max)
        self._rise_max = ar.const(table.rise_max)
        self._rise_never = ar.const(table.rise_never if ar.wide else table.rise_never_narrow)
        self._rise = (ar.load(table.rise_window), ar.load(table.rise_widths), ar.load(table.rise_slopes))
        self._speed = (ar.load(table.speed_window), ar.load(table.speed_widths), ar.load(table.speed_slopes))
        self._one = ar.const(table.one_speed)
        self._one_mu = ar.const(table.one_satisfaction)
        self._one_alpha = ar.const(table.one_softening)
        self._notch_max = ar.const(table.notch_max)
        self._notch_min = ar.neg(self._notch_max)
        self._deviation_min = ar.neg(self._deviation_max)
        self._rise_min = ar.neg(self._rise_max)
        self._zero = ar.const(table.zero)
        self._basis_step, self._basis_wavelet = ar.load(table.basis)
        self._point_powers = tuple(ar.load(row) for row in table.point_powers)

    @property
    def horizon(self) -> int:
        return self.parameters.horizon

    @property
    def constants(self) -> tuple[Constant, ...]:
        return self.table.entries()

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        """The internal model's output and its slope under any notch inside the range (L1 norm of its pulse response).

        A millionth is added for the rounding of the model's matrices and products.
        """
        notch_max = self.table.notch_max.value
        sizes = [notch_max * norm * (1 + 1e-6) + 1e-6 for norm in self._model_norms()]
        return {f"model[{i}]": (-size, size) for i, size in enumerate(sizes)}

    def _model_norms(self) -> tuple[float, float]:
        (a, b, gain), (c, d, gain_slope) = ([entry.value for entry in row] for row in self.table.model)
        y, slope, norms = gain, gain_slope, [0.0, 0.0]
        # The model forgets: after 2000 periods nothing is left of a pulse.
        for _ in range(2000):
            norms = [norms[0] + abs(y), norms[1] + abs(slope)]
            y, slope = a * y + b * slope, c * y + d * slope
        return norms[0], norms[1]

    def start(self, inputs: LawInputs[T]) -> IpfcState[T]:
        """Model at rest; earlier errors are taken to equal the first ones."""
        tracking_error = self._ar.sub(inputs.set_point, inputs.speed)
        errors = (inputs.speed,) * self.parameters.error_window
        return IpfcState((self._zero, self._zero), self._zero, errors, tracking_error)

    def with_sent(self, state: IpfcState[T], notch: T) -> IpfcState[T]:
        return state._replace(notch=self._ar.convert(notch, NOTCH_Q, GAIN_Q))

    def step(self, state: IpfcState[T], inputs: LawInputs[T]) -> tuple[IpfcState[T], LawOutputs[T]]:
        ar = self._ar
        drive = (*state.model, state.notch)
        model = (
            ar.note("model[0]", ar.dot(self._model[0], drive, _GAIN_TO_GAIN), GAIN_Q, "km/h"),
            ar.note("model[1]", ar.dot(self._model[1], drive, _GAIN_TO_GAIN), GAIN_Q, "km/h/s"),
        )
        y_m = ar.note("y_m", ar.convert(model[0], GAIN_Q, SPEED_Q), SPEED_Q, "km/h")
        model_error = ar.note("model_error", ar.sub(inputs.speed, y_m), SPEED_Q, "km/h")
        model_errors = (*state.model_errors[1:], model_error)
        tracking_error = ar.note("tracking_error", ar.sub(inputs.set_point, inputs.speed), SPEED_Q, "km/h")
        free = ar.note_all("free", [ar.dot(row, model, _GAIN_TO_SPEED) for row in self._free], SPEED_Q, "km/h")

        t_s = ar.note("t_s", self._rise_time(tracking_error, state.tracking_error), RISE_Q, "s")
        mu_ts = ar.note("mu_ts", self.rise_satisfaction(t_s), SATISFACTION_Q)
        mu_y = ar.note("mu_y", self._prediction_satisfaction(inputs, free, state.notch), SATISFACTION_Q)
        mu = ar.note("mu", ar.minimum(mu_ts, mu_y), SATISFACTION_Q)
        alpha = ar.note("alpha", self.softening(mu), SOFTENING_Q)

        c = self._set_point_polynomial(inputs)
        e = self._error_polynomial(model_errors)
        d = self._deviations(tracking_error, alpha, c, e, free)

        change = ar.note("change", ar.abs(ar.sub(inputs.preview[-1], inputs.set_point)), SPEED_Q, "km/h")
        steep = ar.gt(change, self._wavelet_change)
        gains = [ar.where(steep, w, s) for w, s in zip(self._gains_wavelet, self._gains_step, strict=True)]
        notch_raw = ar.note("notch_raw", ar.dot(gains, d, _DEVIATION_TO_NOTCH), NOTCH_RAW_Q, "notch")
        clipped = ar.clip(notch_raw, self._notch_max, self._notch_min)
        notch = ar.note("notch", ar.quantise(clipped, NOTCH_RAW_Q, NOTCH_Q), NOTCH_Q, "notch")
        basis = ar.where(steep, self._basis_wavelet, self._basis_step)

        new_state = IpfcState(model, ar.convert(notch, NOTCH_Q, GAIN_Q), model_errors, tracking_error)
        return new_state, LawOutputs(notch_raw, notch, basis, alpha, mu)

    def _rise_time(self, error: T, error_before: T) -> T:
        """Eq. (23) on the size of the error, s (Q24)."""
        ar = self._ar
        size = ar.abs(error)
        closed = ar.sub(ar.abs(error_before), size)
        closing = ar.gt(closed, self._zero)
        rate = ar.where(closing, ar.rsmpy(closed, self._per_period, RATE_Q), self._one)
        if not ar.wide:
            # Keeps the quotient at or below 1 s.
            rate = ar.maximum(rate, size)
        ratio = ar.div(size, rate, RISE_Q)
        return ar.where(closing, ratio, ar.where(ar.gt(size, self._zero), self._rise_never, self._zero))

    def rise_satisfaction(self, t_s: T) -> T:
        """Eq. (24): satisfaction (Q24) with a rise time in s (Q24); its cases in printed order, so 0 s gives 1."""
        inside = self._membership(t_s, t_s, _RISE_TO_SATISFACTION, *self._rise)
        return self._ar.where(self._ar.gt(t_s, self._zero), inside, self._one_mu)

    def speed_satisfaction(self, low: T, high: T) -> T:
        """Eq. (25) at its worst (Q24), from the extremes of predicted speed minus target (km/h, Q20).

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

        Left and right flank are cut to their widths before the product, which therefore cannot overflow.
        """
        ar = self._ar
        below = ar.clip(ar.sub(low, window[0]), self._zero, ar.neg(widths[0]))
        above = ar.clip(ar.sub(high, window[1]), widths[1], self._zero)
        left = ar.add(self._one_mu, ar.rmpy(below, slopes[0], shift))
        right = ar.sub(self._one_mu, ar.rmpy(above, slopes[1], shift))
        return ar.clip(ar.minimum(left, right), self._one_mu, self._zero)

    def _prediction_satisfaction(self, inputs: LawInputs[T], free: tuple[T, ...], notch: T) -> T:
        """Smallest satisfaction of eq. (25) over the horizon if the notch stayed as it is."""
        ar = self._ar
        misses = [
            ar.sub(ar.add(ar.add(inputs.speed, change), ar.rmpy(response, notch, _GAIN_TO_SPEED)), target)
            for change, response, target in zip(free, self._step_response, inputs.preview, strict=True)
        ]
        low = high = misses[0]
        for miss in misses[1:]:
            low, high = ar.minimum(low, miss), ar.maximum(high, miss)
        low = ar.note("miss_low", low, SPEED_Q, "km/h")
        high = ar.note("miss_high", high, SPEED_Q, "km/h")
        return self.speed_satisfaction(low, high)

    def _limited(self, rises: list[T]) -> list[T]:
        """Rises (km/h, Q20) inside what the polynomials' formats hold."""
        if self._ar.wide:
            return rises
        return [self._ar.sat(rise, self._rise_max, self._rise_min) for rise in rises]

    def _set_point_polynomial(self, inputs: LawInputs[T]) -> tuple[T, ...]:
        """Coefficients c_n of the set-points ahead (Q23)."""
        ar = self._ar
        rises = self._limited([ar.sub(target, inputs.set_point) for target in inputs.preview])
        return ar.note_all("c", [ar.dot(row, rises, _SPEED_TO_POLYNOMIAL) for row in self._set_point_fit], POLYNOMIAL_Q)

    def _error_polynomial(self, model_errors: tuple[T, ...]) -> tuple[T, ...]:
        """Coefficients e_n of eq. (15) (Q23)."""
        ar = self._ar
        newest = model_errors[-1]
        past = self._limited([ar.sub(error, newest) for error in model_errors[:-1]])
        past = list(ar.note_all("error_rise", past, SPEED_Q, "km/h"))
        return ar.note_all("e", [ar.dot(row, past, _SPEED_TO_POLYNOMIAL) for row in self._error_fit], POLYNOMIAL_Q)

    def _deviations(
        self, tracking_error: T, alpha: T, c: tuple[T, ...], e: tuple[T, ...], free: tuple[T, ...]
    ) -> tuple[T, ...]:
        """d(k + h) of eq. (18) at the fitting points (km/h, Q19)."""
        ar = self._ar
        powers = [alpha]
        while len(powers) < max(self._fit_points):
            powers.append(ar.rmpy(powers[-1], alpha, SOFTENING_Q))
        slopes = [self._slope(c, e, n) for n in self._orders]
        deviations = []
        for point, count_powers in zip(self._fit_points, self._point_powers, strict=True):
            softened = ar.rmpy(ar.sub(self._one_alpha, powers[point - 1]), tracking_error, SOFTENING_Q)
            d = ar.convert(ar.sub(softened, free[point - 1]), SPEED_Q, DEVIATION_Q)
            for slope, count in zip(slopes, count_powers, strict=True):
                d = ar.add(d, ar.rmpy(slope, count, _POLYNOMIAL_BY_COUNT_TO_DEVIATION))
            if not ar.wide:
                # The format holds the sum of every input; a limit behind a sum that has wrapped would be none.
                d = ar.sat(d, self._deviation_max, self._deviation_min)
            deviations.append(d)
        return ar.note_all("d", deviations, DEVIATION_Q, "km/h")

    def _slope(self, c: tuple[T, ...], e: tuple[T, ...], n: int) -> T:
        """c_n - e_n, where a coefficient beyond the order of its polynomial is zero."""
        if n > len(e):
            return c[n - 1]
        if n > len(c):
            return self._ar.neg(e[n - 1])
        return self._ar.sub(c[n - 1], e[n - 1])
