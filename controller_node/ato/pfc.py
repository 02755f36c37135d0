"""Core of predictive functional control (PFC) of the train's speed, shared by IPFC, TPFC1 and TPFC2.

Sections 2.1 to 2.6 of Wang et al. (see ``pfc_model``), equation numbers are theirs. Interpretations where the paper
leaves a choice: eq. (11) counts i in samples, eq. (18) takes (c_n - e_n) and the free response with a minus sign. The
internal model runs in parallel to the train, driven by the notch really sent.

A law is built as follows: its parameters extend ``PfcParameters``, its table ``PfcConstants``; its constructor gives
the core one fixed :class:`Basis`, or two and the change of the set-point above which the second is used; its step
consists of :meth:`Pfc.observe`, its own rule for the softening factor, and :meth:`Pfc.command`. ``tpfc2`` is the
shortest example:
:class:`ConstantPfc` is the core with a constant softening factor.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.ato.pfc_constants import (
    DEVIATION_Q,
    GAIN_Q,
    POLYNOMIAL_Q,
    ConstantPfcConstants,
    PfcConstants,
    PfcParameters,
    Row,
)
from railhil.controller_node.ato.pfc_model import BASIS_NOTE, SOFTENING_NOTE, SOFTENING_Q
from railhil.controller_node.laws.base import NOTCH_Q, NOTCH_RAW_Q, SPEED_Q, Law, LawInputs, LawOutputs, State
from railhil.controller_node.laws.constant_table import flatten
from railhil.controller_node.laws.note import Note

# Shifts of the products: Q of the first factor + Q of the second - Q of the result.
_GAIN_TO_GAIN = GAIN_Q
_GAIN_TO_SPEED = GAIN_Q + GAIN_Q - SPEED_Q
_SPEED_TO_POLYNOMIAL = SPEED_Q + GAIN_Q - POLYNOMIAL_Q
_POLYNOMIAL_BY_COUNT_TO_DEVIATION = POLYNOMIAL_Q - DEVIATION_Q
_DEVIATION_TO_NOTCH = DEVIATION_Q + GAIN_Q - NOTCH_RAW_Q


class Basis(NamedTuple):
    """Basis functions as needed at run time: their code in CTL_STAT and their gains U of eq. (19)."""

    code: Constant
    gains: Row


class Observation(NamedTuple, Generic[T]):
    """The quantities at the start of a control period.

    ``model`` is [y_m, dy_m/dt] in km/h and km/h/s (Q24), ``model_errors`` the last errors y_p - y_m, oldest first,
    ``tracking_error`` y_s - y_p, ``free`` the change of the model's output at the ``free_points`` without any input
    (km/h, Q20).
    """

    model: tuple[T, T]
    model_errors: tuple[T, ...]
    tracking_error: T
    free: tuple[T, ...]


class Command(NamedTuple, Generic[T]):
    """The results of a control period, as in :class:`LawOutputs`; ``basis``: code of the basis in use."""

    notch_raw: T
    notch: T
    basis: T


class Pfc(Law[T, State]):
    """The core on one arithmetic. Speeds in km/h (Q20), notch in notches.

    :param bases: one, or two: the second is used while the set-point changes by more than ``steep_change`` (eq. 22).
    """

    def __init__(
        self,
        arithmetic: Arithmetic[T],
        parameters: PfcParameters,
        table: PfcConstants,
        bases: Sequence[Basis],
        steep_change: Constant | None = None,
    ) -> None:
        self._ar = ar = arithmetic
        self._horizon = parameters.horizon
        self._orders = parameters.orders
        self._error_window = parameters.error_window
        self._point_rows = tuple(parameters.free_points.index(point) for point in parameters.fit_points)
        self._constants = flatten(table)
        self._model_rows = table.model
        self._model = tuple(ar.load(row) for row in table.model)
        self._free = tuple(ar.load(row) for row in table.free)
        self._set_point_fit = tuple(ar.load(row) for row in table.set_point_fit)
        self._error_fit = tuple(ar.load(row) for row in table.error_fit)
        self._point_powers = tuple(ar.load(row) for row in table.point_powers)
        self._deviation_max = ar.const(table.deviation_max)
        self._deviation_min = ar.neg(self._deviation_max)
        self._rise_max = ar.const(table.rise_max)
        self._rise_min = ar.neg(self._rise_max)
        self._notch_limit = table.notch_max.value
        self._notch_max = ar.const(table.notch_max)
        self._notch_min = ar.neg(self._notch_max)
        self._zero = ar.const(table.zero)
        self._bases = tuple((ar.const(basis.code), ar.load(basis.gains)) for basis in bases)
        self._steep_change = None if steep_change is None else ar.const(steep_change)

    @property
    def horizon(self) -> int:
        return self._horizon

    @property
    def constants(self) -> tuple[Constant, ...]:
        return self._constants

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        """The internal model's output and its slope under any notch inside the range (L1 norm of its pulse response).

        A millionth is added for the rounding of the model's matrices and products.
        """
        sizes = [self._notch_limit * norm * (1 + 1e-6) + 1e-6 for norm in self._model_norms()]
        return {f"model[{i}]": (-size, size) for i, size in enumerate(sizes)}

    def _model_norms(self) -> tuple[float, float]:
        (a, b, gain), (c, d, gain_slope) = ([entry.value for entry in row] for row in self._model_rows)
        y, slope, norms = gain, gain_slope, [0.0, 0.0]
        # The model is stable: after 2000 periods a pulse has decayed completely.
        for _ in range(2000):
            norms = [norms[0] + abs(y), norms[1] + abs(slope)]
            y, slope = a * y + b * slope, c * y + d * slope
        return norms[0], norms[1]

    def observe(
        self, model: tuple[T, T], notch: T, model_errors: tuple[T, ...], inputs: LawInputs[T]
    ) -> Observation[T]:
        """Eqs. (14) and (16): the model after the notch sent (Q24), and the error of the train relative to it.

        The first three arguments are the law's memory from the previous period.
        """
        ar = self._ar
        drive = (*model, notch)
        model = (
            ar.note("model[0]", ar.dot(self._model[0], drive, _GAIN_TO_GAIN), GAIN_Q, "km/h"),
            ar.note("model[1]", ar.dot(self._model[1], drive, _GAIN_TO_GAIN), GAIN_Q, "km/h/s"),
        )
        y_m = ar.note("y_m", ar.convert(model[0], GAIN_Q, SPEED_Q), SPEED_Q, "km/h")
        model_error = ar.note("model_error", ar.sub(inputs.speed, y_m), SPEED_Q, "km/h")
        tracking_error = ar.note("tracking_error", ar.sub(inputs.set_point, inputs.speed), SPEED_Q, "km/h")
        free = ar.note_all("free", [ar.dot(row, model, _GAIN_TO_SPEED) for row in self._free], SPEED_Q, "km/h")
        return Observation(model, (*model_errors[1:], model_error), tracking_error, free)

    def command(self, now: Observation[T], closed: Sequence[T], inputs: LawInputs[T]) -> Command[T]:
        """Eqs. (18) and (19), the notch clipped and quantised.

        :param closed: 1 - alpha^h at the fitting points (Q30): the share of the tracking error to be removed.
        """
        ar = self._ar
        c = self._set_point_polynomial(inputs)
        e = self._error_polynomial(now.model_errors)
        d = self._deviations(now, closed, c, e)
        basis, gains = self._basis_in_use(inputs)
        notch_raw = ar.note("notch_raw", ar.dot(gains, d, _DEVIATION_TO_NOTCH), NOTCH_RAW_Q, "notch")
        clipped = ar.clip(notch_raw, self._notch_max, self._notch_min)
        notch = ar.note("notch", ar.quantise(clipped, NOTCH_RAW_Q, NOTCH_Q), NOTCH_Q, "notch")
        return Command(notch_raw, notch, basis)

    def _basis_in_use(self, inputs: LawInputs[T]) -> tuple[T, Sequence[T]]:
        """Code and gains of the basis; with two bases the second one while the set-point changes steeply (eq. 22)."""
        ar = self._ar
        if self._steep_change is None:
            return self._bases[0]
        (calm_code, calm), (steep_code, steep) = self._bases
        change = ar.note("change", ar.abs(ar.sub(inputs.preview[-1], inputs.set_point)), SPEED_Q, "km/h")
        is_steep = ar.gt(change, self._steep_change)
        gains = [ar.where(is_steep, gain, other) for gain, other in zip(steep, calm, strict=True)]
        return ar.where(is_steep, steep_code, calm_code), gains

    def _limited(self, rises: list[T]) -> list[T]:
        """Rises (km/h, Q20) limited to the range of the polynomials' formats."""
        if self._ar.wide:
            return rises
        return [self._ar.sat(rise, self._rise_max, self._rise_min) for rise in rises]

    def _set_point_polynomial(self, inputs: LawInputs[T]) -> tuple[T, ...]:
        """Coefficients c_n of the future set-points (Q23)."""
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
        self, now: Observation[T], closed: Sequence[T], c: tuple[T, ...], e: tuple[T, ...]
    ) -> tuple[T, ...]:
        """d(k + h) of eq. (18) at the fitting points (km/h, Q19)."""
        ar = self._ar
        slopes = [self._slope(c, e, n) for n in self._orders]
        deviations = []
        for row, share, count_powers in zip(self._point_rows, closed, self._point_powers, strict=True):
            softened = ar.rmpy(share, now.tracking_error, SOFTENING_Q)
            d = ar.convert(ar.sub(softened, now.free[row]), SPEED_Q, DEVIATION_Q)
            for slope, count in zip(slopes, count_powers, strict=True):
                d = ar.add(d, ar.rmpy(slope, count, _POLYNOMIAL_BY_COUNT_TO_DEVIATION))
            if not ar.wide:
                # The format holds the sum for every input; limiting a sum that has already wrapped would be useless.
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


class PfcState(NamedTuple, Generic[T]):
    """Memory of a law with a constant softening factor; ``notch`` is the last one sent (Q24), see ``Observation``."""

    model: tuple[T, T]
    notch: T
    model_errors: tuple[T, ...]


class ConstantPfc(Pfc[T, PfcState[T]]):
    """The core with a constant softening factor (section 2.3)."""

    notes: ClassVar[tuple[Note, ...]] = (BASIS_NOTE, SOFTENING_NOTE)

    def __init__(
        self,
        arithmetic: Arithmetic[T],
        parameters: PfcParameters,
        table: ConstantPfcConstants,
        bases: Sequence[Basis],
        steep_change: Constant | None = None,
    ) -> None:
        super().__init__(arithmetic, parameters, table, bases, steep_change)
        self._softening = arithmetic.const(table.softening)
        self._closed = arithmetic.load(table.closed)

    def start(self, inputs: LawInputs[T]) -> PfcState[T]:
        """Model at rest; earlier errors are taken to equal the first ones."""
        return PfcState((self._zero, self._zero), self._zero, (inputs.speed,) * self._error_window)

    def with_sent(self, state: PfcState[T], notch: T) -> PfcState[T]:
        return state._replace(notch=self._ar.convert(notch, NOTCH_Q, GAIN_Q))

    def step(self, state: PfcState[T], inputs: LawInputs[T]) -> tuple[PfcState[T], LawOutputs[T]]:
        """One control period."""
        now = self.observe(state.model, state.notch, state.model_errors, inputs)
        command = self.command(now, self._closed, inputs)
        after = PfcState(now.model, self._ar.convert(command.notch, NOTCH_Q, GAIN_Q), now.model_errors)
        return after, LawOutputs(command.notch_raw, command.notch, (command.basis, self._softening))
