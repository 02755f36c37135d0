"""The readings of a stopping law in SI units, and the bridging of gaps in its speed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.stop.interface import STOP
from railhil.controller_node.stop.numbers import DISTANCE_Q, GAIN_Q, SPEED_Q, Numbers
from railhil.wire.stop_counts import MM, SAMPLES

#: For so many cycles without speed the last one is held; then the train must not begin to brake by it.
HELD_CYCLES = 3
#: A reported error is limited to this, which is no error of a stop (:mod:`.learning`).
_REPORT_MAX_MM = 1_000_000.0
#: Counters end here.
COUNT_MAX = 1000.0
_PLACE = {reading.name: index for index, reading in enumerate(STOP.readings)}


class Measured(NamedTuple, Generic[T]):
    """``samples`` m/s; ``odometer`` and ``balise_odometer`` m since the start of the run; ``error`` of the reported
    stop, m; all others Q0: flags are 0 or 1, ``load`` is in percent, ``run`` is the number of this run, ``report`` of
    that whose stop was measured (0: none)."""

    samples: tuple[T, ...]
    number: T
    valid: T
    slide: T
    odometer: T
    balise: T
    balise_odometer: T
    load: T
    wet: T
    standstill: T
    doors: T
    run: T
    report: T
    error: T
    level: T


class Gap(NamedTuple, Generic[T]):
    """Number of the last speed telegram, cycles without one, samples since the last long gap, last sample (m/s)."""

    number: T
    missed: T
    samples: T
    last: T


class Inputs(Generic[T]):
    """Decodes the readings."""

    def __init__(self, numbers: Numbers[T]) -> None:
        self._numbers = numbers
        self._unit = numbers.hold("unit", 1.0 / MM, GAIN_Q, "port table")
        self._reported = [numbers.hold(f"report_{sign}", sign * _REPORT_MAX_MM, 0, "law") for sign in (1, -1)]
        self._none = numbers.hold("no_count", -1.0, 0, "law")
        self._five = numbers.hold("samples", SAMPLES, 0, "port table")
        self._held = numbers.hold("held_cycles", HELD_CYCLES, 0, "law")
        self._most = numbers.hold("count_max", COUNT_MAX, 0, "law")

    def measured(self, readings: Sequence[T]) -> Measured[T]:
        """The readings of the interface in SI units."""
        ar = self._numbers.ar

        def one(name: str) -> T:
            return readings[_PLACE[name]]

        def metres(count: T) -> T:
            return ar.mpy_iqx(count, 0, self._unit, GAIN_Q, DISTANCE_Q)

        return Measured(
            tuple(ar.mpy_iqx(one(f"speed{n}"), 0, self._unit, GAIN_Q, SPEED_Q) for n in range(1, SAMPLES + 1)),
            one("speed_count"),
            one("speed_valid"),
            one("slide"),
            metres(one("odometer")),
            one("balise"),
            metres(one("balise_odometer")),
            one("load"),
            one("wet"),
            one("standstill"),
            one("doors"),
            one("run"),
            one("report_run"),
            metres(ar.clip(one("report_error"), *self._reported)),
            one("level"),
        )

    def start(self, measured: Measured[T]) -> Gap[T]:
        """Before the first step."""
        zero = self._numbers.zero
        return Gap(self._none, zero, zero, measured.samples[-1])

    def bridged(self, gap: Gap[T], measured: Measured[T]) -> tuple[Gap[T], tuple[T, ...], T]:
        """The samples of this cycle, the last one repeated where there are no new ones, and 1 if there are (Q0)."""
        ar, zero, one = self._numbers.ar, self._numbers.zero, self._numbers.one
        change = ar.abs(ar.sub(measured.number, gap.number))
        fresh = ar.where(ar.gt(change, zero), measured.valid, zero)
        new = ar.gt(fresh, zero)
        samples = tuple(ar.where(new, sample, gap.last) for sample in measured.samples)
        missed = ar.where(new, zero, ar.minimum(ar.add(gap.missed, one), self._most))
        seen = ar.minimum(ar.add(gap.samples, ar.where(new, self._five, zero)), self._most)
        seen = ar.where(ar.gt(missed, self._held), zero, seen)
        return Gap(measured.number, missed, seen, samples[-1]), samples, fresh

    def refused(self, gap: Gap[T], warm_up: int) -> T:
        """1 while the estimate is not one to brake by (Q0): too long without speed, or not yet warm again."""
        ar, zero, one = self._numbers.ar, self._numbers.zero, self._numbers.one
        enough = self._numbers.hold("warm_up", warm_up - 1, 0, "filter")
        warm = ar.where(ar.gt(gap.samples, enough), zero, one)
        return ar.where(ar.gt(gap.missed, self._held), one, warm)
