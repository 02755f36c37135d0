"""Place by odometer and balises: a Kalman filter of the odometer's error and of its growth (wheel diameter).

Unlike a jump to each balise, this weighs the 3 cm of a balise against earlier balises.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.stop.interface import Measured
from railhil.controller_node.stop.numbers import DISTANCE_Q, GAIN_Q, Numbers

#: Growth is counted in m per this many m, so that its variance is not too small for a format.
_SPAN_M = 100.0
_Q = 24
#: Uncertainty of the place of the start, and limit of the corrections, m.
_START_SIGMA_M = 0.01
_FAR_M = 20.0
#: Bound of the growth, m per 100 m.
_GROWTH_M = 2.0
#: Largest change of the place by a balise, m.
_JUMP_M = 5.0


class Position(NamedTuple, Generic[T]):
    """Last balise and the odometer at it (m); correction (m, Q24) and growth (m per 100 m); their covariance."""

    balise: T
    odometer: T
    correction: T
    growth: T
    cc: T
    cg: T
    gg: T


class Odometry(Generic[T]):
    """Corrects the odometer.

    :param places_m: of the balises by their id from 1, from the start of the run.
    :param wheel_sigma: of the wheel diameter, relative. :param balise_sigma_m: of a balise.
    """

    def __init__(
        self, numbers: Numbers[T], places_m: Sequence[float], wheel_sigma: float, balise_sigma_m: float
    ) -> None:
        self._numbers = numbers
        hold = numbers.hold
        self._places = numbers.hold_all("balise_place", places_m, DISTANCE_Q, "scenario")
        self._ids = numbers.hold_all("balise_id", range(1, len(places_m) + 1), 0, "scenario")
        self._variance = hold("balise_variance", balise_sigma_m**2, _Q, "parameters")
        self._start = hold("start_variance", _START_SIGMA_M**2, _Q, "law")
        self._growth = hold("growth_variance", (wheel_sigma * _SPAN_M) ** 2, _Q, "parameters")
        self._per_span = hold("per_span", 1.0 / _SPAN_M, GAIN_Q, "law")
        self._none = hold("no_distance", 0.0, DISTANCE_Q, "law")
        self._long = hold("span_max", 10.0 * _SPAN_M, DISTANCE_Q, "law")
        self._zero = hold("no_correction", 0.0, _Q, "law")
        self._far = [hold("correction_max", _FAR_M, _Q, "law"), hold("correction_min", -_FAR_M, _Q, "law")]
        self._grown = [hold("growth_max", _GROWTH_M, _Q, "law"), hold("growth_min", -_GROWTH_M, _Q, "law")]
        self._jump = [hold("jump_max", _JUMP_M, _Q, "law"), hold("jump_min", -_JUMP_M, _Q, "law")]
        self._most = [hold("variance_top", 4.0, _Q, "law"), hold("variance_bottom", -4.0, _Q, "law")]

    def start(self) -> Position[T]:
        """Before the first step."""
        zero, none = self._numbers.zero, self._zero
        return Position(zero, self._none, none, none, self._start, none, self._growth)

    def _spans(self, before: T, after: T) -> T:
        ar = self._numbers.ar
        gone = ar.clip(ar.sub(after, before), self._long, self._none)
        return ar.mpy_iqx(gone, DISTANCE_Q, self._per_span, GAIN_Q, _Q)

    def step(self, old: Position[T], measured: Measured[T]) -> tuple[Position[T], T]:
        """One cycle; the second result is the distance run, m (Q ``DISTANCE_Q``)."""
        ar = self._numbers.ar
        at = measured.balise_odometer
        known = self._none
        is_new = self._numbers.zero
        for number, place in zip(self._ids, self._places, strict=True):
            same = ar.gt(self._numbers.one, ar.abs(ar.sub(measured.balise, number)))
            known = ar.where(same, place, known)
            is_new = ar.where(same, self._numbers.one, is_new)
        changed = ar.gt(ar.abs(ar.sub(measured.balise, old.balise)), self._numbers.zero)
        is_new = ar.where(changed, is_new, self._numbers.zero)

        spans = self._spans(old.odometer, at)
        half = ar.add(old.cg, ar.mpy(spans, old.gg, _Q))
        cc = ar.clip(ar.add(old.cc, ar.mpy(spans, ar.add(old.cg, half), _Q)), self._most[0], self._zero)
        cg = ar.clip(half, *self._most)
        total = ar.add(cc, self._variance)
        on_correction, on_growth = (ar.clip(ar.div(x, total, _Q), *self._most) for x in (cc, cg))
        guess = ar.clip(ar.add(old.correction, ar.mpy(spans, old.growth, _Q)), *self._far)
        off = ar.sub(ar.sub(known, at), ar.convert(guess, _Q, DISTANCE_Q))
        off = ar.clip(ar.convert(ar.clip(off, *self._jump_m()), DISTANCE_Q, _Q), *self._jump)
        new = Position(
            measured.balise,
            at,
            ar.clip(ar.add(guess, ar.mpy(on_correction, off, _Q)), *self._far),
            ar.clip(ar.add(old.growth, ar.mpy(on_growth, off, _Q)), *self._grown),
            ar.mpy(on_correction, self._variance, _Q),
            ar.mpy(on_growth, self._variance, _Q),
            ar.clip(ar.sub(old.gg, ar.mpy(on_growth, cg, _Q)), self._growth, self._zero),
        )
        after = Position(*(ar.where(ar.gt(is_new, self._numbers.zero), a, b) for a, b in zip(new, old, strict=True)))
        since = self._spans(after.odometer, measured.odometer)
        correction = ar.clip(ar.add(after.correction, ar.mpy(since, after.growth, _Q)), *self._far)
        return after, ar.add(measured.odometer, ar.convert(correction, _Q, DISTANCE_Q))

    def _jump_m(self) -> tuple[T, T]:
        hold = self._numbers.hold
        return hold("jump_m", _JUMP_M, DISTANCE_Q, "law"), hold("minus_jump_m", -_JUMP_M, DISTANCE_Q, "law")
