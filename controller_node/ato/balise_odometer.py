"""Position of the train, from a wheel of unknown circumference and balises surveyed to a few centimetres.

The odometer o starts at 0 and has a constant scale error, so that the true position is o (1 + w). At every balise o (1
+ w) should equal the surveyed position s, and w is the least squares fit to all of them::

    z = o / D      w = sum z (s - o) / D / (lambda + sum z^2)

with D the planned distance and lambda the weight of the nominal wheel. The error at the stop is the error of a weighted
mean of all balises, not of the last one, and a missed balise is only one equation fewer.
"""

from __future__ import annotations

from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.ato.ipfc_plus_constants import (
    GAP_Q,
    SHARE_Q,
    SUM_Q,
    WHEEL_Q,
    IpfcPlusConstants,
    per_distance,
)
from railhil.controller_node.laws.base import TrackInputs

_SHARE_SQUARED_TO_SUM = SHARE_Q + SHARE_Q - SUM_Q
_SHARE_BY_ERROR_TO_SUM = SHARE_Q + WHEEL_Q - SUM_Q


class BaliseState(NamedTuple, Generic[T]):
    """Number of the last balise taken in (Q0), sum of z^2 and lambda, sum of z (s - o) / D (both Q ``SUM_Q``)."""

    number: T
    squares: T
    errors: T


class Place(NamedTuple, Generic[T]):
    """Position in two parts, so that a small difference of large numbers keeps its fractions.

    ``wheel`` w (Q ``WHEEL_Q``), ``odometer`` o (0.1 mm, Q0), ``correction`` w o (0.1 mm, Q ``GAP_Q``).
    """

    wheel: T
    odometer: T
    correction: T


class BaliseOdometer(Generic[T]):
    """The odometer with the wheel error corrected."""

    def __init__(self, arithmetic: Arithmetic[T], table: IpfcPlusConstants, distance_m: float) -> None:
        self._ar = ar = arithmetic
        self.per_distance = per_distance(distance_m)
        self._per_distance = ar.const(self.per_distance)
        self._to_share = self.per_distance.q - SHARE_Q
        self._to_error = self.per_distance.q - WHEEL_Q
        self._odometer_max = ar.const(table.odometer_max)
        self._wheel_max = ar.const(table.wheel_max)
        self._wheel_min = ar.neg(self._wheel_max)
        self._prior = ar.const(table.prior)
        self._slack = ar.const(table.balise_slack)
        self._sum_max = ar.const(table.sum_max)
        self._sum_min = ar.neg(self._sum_max)
        self._zero = ar.const(table.zero)

    def start(self) -> BaliseState[T]:
        """Before any balise: the nominal wheel."""
        return BaliseState(self._zero, self._prior, self._zero)

    def step(self, state: BaliseState[T], track: TrackInputs[T]) -> tuple[BaliseState[T], Place[T]]:
        """Include a new balise."""
        ar, zero = self._ar, self._zero
        number, surveyed, passed = track.balise
        surveyed = ar.clip(surveyed, self._odometer_max, zero)
        passed = ar.clip(passed, self._odometer_max, zero)
        share = ar.rmpy(passed, self._per_distance, self._to_share)
        error = ar.rmpy(ar.sub(surveyed, passed), self._per_distance, self._to_error)
        squares = ar.add(state.squares, ar.rmpy(share, share, _SHARE_SQUARED_TO_SUM))
        believed = ar.clip(error, self._wheel_max, self._wheel_min)
        errors = ar.add(state.errors, ar.rmpy(share, believed, _SHARE_BY_ERROR_TO_SUM))
        errors = ar.clip(errors, self._sum_max, self._sum_min)
        # A balise whose error no wheel could explain is ignored, and so is one already included.
        new = ar.gt(ar.abs(ar.sub(number, state.number)), zero)
        reach = ar.add(ar.rmpy(share, self._wheel_max, SHARE_Q), self._slack)
        likely = ar.gt(reach, ar.abs(error))
        room = ar.gt(self._sum_max, squares)

        def taken(value: T, old: T) -> T:
            return ar.where(new, ar.where(likely, ar.where(room, value, old), old), old)

        squares = ar.note("balise_squares", taken(squares, state.squares), SUM_Q)
        errors = ar.note("balise_errors", taken(errors, state.errors), SUM_Q)
        wheel = ar.clip(ar.div(errors, squares, WHEEL_Q), self._wheel_max, self._wheel_min)
        wheel = ar.note("wheel", wheel, WHEEL_Q)
        odometer = ar.clip(track.position_01mm, self._odometer_max, zero)
        correction = ar.rmpy(odometer, wheel, WHEEL_Q - GAP_Q)
        correction = ar.note("correction", correction, GAP_Q, "0.1 mm")
        return BaliseState(number, squares, errors), Place(wheel, odometer, correction)
