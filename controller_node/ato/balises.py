"""Balises from the wire to the law: the telegram has 16 bits of the odometer, the law gets the full reading."""

from __future__ import annotations

from collections import Counter
from typing import Final

from railhil.bus.layout import CHECK_CORRECT
from railhil.controller_node.ato.control_loop import NO_BALISE, limited_01mm
from railhil.controller_node.laws.base import BALISE_ERROR_MAX_M, WHEEL_ERROR_MAX, BaliseReading
from railhil.wire.ato import BalisePassed

_WORD_MM: Final = 0x1_0000
#: Inverse of the largest relative error of a wheel.
WHEEL_PARTS: Final = round(1 / WHEEL_ERROR_MAX)
BALISE_ERROR_MM: Final = round(BALISE_ERROR_MAX_M * 1000)


class Balises:
    """The last balise that the law may use.

    The low 16 bits give the position of the passing modulo 65.536 m. The passing lies between the position at which the
    BALISE port was last received (the telegram of the previous balise is repeated on the port's period) and the current
    position. If that distance is less than 65.536 m, the bits determine the passing exactly; otherwise the balise is
    not used.

    The first telegram received may belong to a balise passed long ago: before a restart, or while the port was lost.
    The passing is then taken to be the last one possible, unless a worn wheel (:data:`WHEEL_PARTS`) and the survey also
    allow one that is earlier by a multiple of 65.536 m; the balise is then not used.

    ``counters``: telegrams not used, by cause: ``balise_check`` (check variable not correct), ``balise_number`` (number
    0), ``balise_late`` (there is not exactly one place where the passing can have been).
    """

    def __init__(self) -> None:
        self.counters: Counter[str] = Counter()
        #: For the law.
        self.last: BaliseReading[int] = NO_BALISE
        self._number = 0
        # Lower bound of the position at which the port was last received; None before the first time.
        self._heard_mm: int | None = None
        # Surveyed position of the last balise that a worn wheel explains, and the odometer there; the start of the run.
        self._sure_mm = 0, 0

    def take(self, telegram: BalisePassed, here_01mm: int, within_01mm: int) -> None:
        """Take a BALISE telegram that passed the traffic store.

        :param here_01mm: position of the train, by its odometer.
        :param within_01mm: its possible error.
        """
        if telegram.check != CHECK_CORRECT:
            self.counters["balise_check"] += 1
            return
        if telegram.balise_id == 0:
            self.counters["balise_number"] += 1
            return
        here_mm, within_mm = here_01mm // 10, within_01mm // 10 + 1
        before_mm, self._heard_mm = self._heard_mm, here_mm - within_mm
        number_before, self._number = self._number, telegram.balise_id
        if self._number in (number_before, self.last.number):
            return
        furthest_mm = _WORD_MM - 1 - within_mm
        # A balise under a train that has not moved was read when the train arrived.
        if before_mm is not None and here_mm > within_mm:
            furthest_mm = here_mm - before_mm
        behind_mm = (here_mm + within_mm - telegram.odometer_low_mm) % _WORD_MM - within_mm
        passed_mm, surveyed_mm = here_mm - behind_mm, telegram.surveyed_mm
        if (
            furthest_mm + within_mm >= _WORD_MM
            or behind_mm > furthest_mm
            or (before_mm is None and _may_be_earlier(surveyed_mm, passed_mm, within_mm))
        ):
            self.counters["balise_late"] += 1
            return
        self.last = BaliseReading(telegram.balise_id, limited_01mm(surveyed_mm), limited_01mm(passed_mm))
        if _is_explained(surveyed_mm, passed_mm, 0):
            self._sure_mm = surveyed_mm, passed_mm

    def is_beyond(self, here_01mm: int, place_01mm: int) -> bool:
        """Whether a train at ``here_01mm`` by its odometer is beyond a place on the line with any wheels: counted from
        the last balise, or from the start of the run before the first."""
        surveyed_mm, passed_mm = self._sure_mm
        since_mm = here_01mm // 10 - passed_mm
        return surveyed_mm + since_mm - since_mm // WHEEL_PARTS - BALISE_ERROR_MM > place_01mm // 10


def _is_explained(surveyed_mm: int, passed_mm: int, within_mm: int) -> bool:
    """Whether a worn wheel explains the odometer at a balise."""
    unexplained_mm = abs(surveyed_mm - passed_mm) - BALISE_ERROR_MM - within_mm
    return unexplained_mm * WHEEL_PARTS <= abs(passed_mm)


def _may_be_earlier(surveyed_mm: int, passed_mm: int, within_mm: int) -> bool:
    """Whether the passing may have been a multiple of 65.536 m before ``passed_mm``, but after the start of the run."""
    earlier = range(passed_mm - _WORD_MM, -within_mm - 1, -_WORD_MM)
    return any(_is_explained(surveyed_mm, place_mm, within_mm) for place_mm in earlier)
