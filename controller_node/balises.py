"""Balises from the wire to the law: the telegram has 16 bits of the odometer, the law gets the full reading."""

from __future__ import annotations

from collections import Counter

from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.telegrams import BalisePassed
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.loop import NO_BALISE, limited_01mm

_WORD_MM = 0x1_0000


class Balises:
    """The last balise that the law may use.

    The low 16 bits give the position of the passing modulo 65.536 m. The passing lies between the position at which the
    BALISE port was last received (the telegram of the previous balise is repeated on the port's period) and the current
    position. If that distance is less than 65.536 m, the bits determine the passing exactly; otherwise the balise is
    not used. Before the first balise the port is silent; its telegram is assumed to be at most 65 m late.

    ``counters``: telegrams not used, by cause: ``balise_check`` (check variable not correct), ``balise_number`` (number
    0), ``balise_late`` (the passing cannot be placed between the last telegram and the current position).
    """

    def __init__(self) -> None:
        self.counters: Counter[str] = Counter()
        #: For the law.
        self.last: BaliseReading[int] = NO_BALISE
        self._number = 0
        # Lower bound of the position at which the port was last received; None before the first time.
        self._heard_mm: int | None = None

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
        if furthest_mm + within_mm >= _WORD_MM or behind_mm > furthest_mm:
            self.counters["balise_late"] += 1
            return
        self.last = BaliseReading(
            telegram.balise_id, limited_01mm(telegram.surveyed_mm), limited_01mm(here_mm - behind_mm)
        )
