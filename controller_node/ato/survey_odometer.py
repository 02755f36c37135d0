"""Position of the train from balises whose survey has a tolerance.

Every balise passed at odometer o bounds the wheel error w: its true position o (1 + w) lies within the tolerance t of
the surveyed one s, so that w is between (s - t - o) / o and (s + t - o) / o. The middle of what all balises leave has
the smallest largest error, and with survey errors spread evenly over the tolerance also the smallest median (the
midrange; the fit of :class:`~railhil.controller_node.ato.balise_odometer.BaliseOdometer` is the best one for normal
errors). Where nothing is left, the tolerance was wrong, and the fit is used.
"""

from __future__ import annotations

from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.ato.balise_odometer import BaliseOdometer, BaliseState, Place
from railhil.controller_node.ato.ipfc_plus_constants import GAP_Q, SHARE_Q, UNIT_Q, WHEEL_Q
from railhil.controller_node.ato.ipfc_plus_stop_constants import IpfcPlusStopConstants
from railhil.controller_node.laws.base import TrackInputs


class WheelBounds(NamedTuple, Generic[T]):
    """Bounds of the wheel error (Q ``WHEEL_Q``)."""

    low: T
    high: T


class SurveyOdometer(Generic[T]):
    """Bounds of the wheel error, beside the fit of a :class:`BaliseOdometer`."""

    def __init__(self, arithmetic: Arithmetic[T], table: IpfcPlusStopConstants, fit: BaliseOdometer[T]) -> None:
        self._ar = ar = arithmetic
        self._per_distance = ar.const(fit.per_distance)
        self._to_share = fit.per_distance.q - SHARE_Q
        self._to_error = fit.per_distance.q - WHEEL_Q
        self._odometer_max = ar.const(table.odometer_max)
        self._wheel_max = ar.const(table.wheel_max)
        self._wheel_min = ar.neg(self._wheel_max)
        self._tolerance = ar.const(table.tolerance)
        self._bounds = ar.const(table.bound_max), ar.neg(ar.const(table.bound_max))
        self._share_min = ar.const(table.share_min)
        self._half = ar.const(table.half)
        self._zero = ar.const(table.zero)

    def start(self) -> WheelBounds[T]:
        """Before any balise: the whole range of wheels."""
        return WheelBounds(self._wheel_min, self._wheel_max)

    def step(
        self,
        state: WheelBounds[T],
        fits: tuple[BaliseState[T], BaliseState[T]],
        track: TrackInputs[T],
        fitted: Place[T],
    ) -> tuple[WheelBounds[T], Place[T]]:
        """Include a new balise.

        :param fits: the fit before it and with it; a balise that the fit did not take in bounds nothing.
        :param fitted: the place by the fit.
        """
        ar, (before, after), (_, surveyed, passed) = self._ar, fits, track.balise
        surveyed = ar.clip(surveyed, self._odometer_max, self._zero)
        passed = ar.clip(passed, self._odometer_max, self._zero)
        share = ar.rmpy(passed, self._per_distance, self._to_share)
        error = ar.clip(ar.rmpy(ar.sub(surveyed, passed), self._per_distance, self._to_error), *self._bounds)
        divisor = ar.convert(ar.maximum(share, self._share_min), SHARE_Q, WHEEL_Q)
        low = ar.div(ar.sub(error, self._tolerance), divisor, WHEEL_Q)
        high = ar.div(ar.add(error, self._tolerance), divisor, WHEEL_Q)
        taken, far = ar.gt(after.squares, before.squares), ar.gt(share, self._share_min)

        def tightened(bound: T, old: T) -> T:
            limited = ar.clip(bound, self._wheel_max, self._wheel_min)
            return ar.where(taken, ar.where(far, limited, old), old)

        low = ar.note("wheel_low", tightened(ar.maximum(low, state.low), state.low), WHEEL_Q)
        high = ar.note("wheel_high", tightened(ar.minimum(high, state.high), state.high), WHEEL_Q)
        middle = ar.rmpy(ar.add(low, high), self._half, UNIT_Q)
        wheel = ar.note("wheel_bounded", ar.where(ar.gt(low, high), fitted.wheel, middle), WHEEL_Q)
        correction = ar.rmpy(fitted.odometer, wheel, WHEEL_Q - GAP_Q)
        correction = ar.note("place_correction", correction, GAP_Q, "0.1 mm")
        return WheelBounds(low, high), Place(wheel, fitted.odometer, correction)
