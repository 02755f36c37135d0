"""Own estimate of the train's position on the line: the last balise, and the odometer since.

A balise that the odometer contradicts is not used, unless the next one contradicts it as well: a balise may be shifted,
or its telegram damaged.
"""

from __future__ import annotations

from typing import Final

from railhil.controller_node.ato.control_loop import NO_BALISE
from railhil.controller_node.laws.base import BALISE_ERROR_MAX_M, BaliseReading

#: Error of a balise that is explained, 0.1 mm, and the share of the way since the last one that a wheel explains.
BALISE_ERROR_01MM: Final = round(BALISE_ERROR_MAX_M * 1e4)
WHEEL_PARTS: Final = 64


class Place:
    """Position in run coordinates; all lengths in 0.1 mm.

    ``refused``: balises that were not used.
    """

    def __init__(self) -> None:
        self.refused = 0
        # Position and odometer at the last balise used; at first the start of the run.
        self._anchor_01mm = 0
        self._passed_01mm = 0
        self._last: BaliseReading[int] = NO_BALISE
        self._is_doubtful = False

    def take(self, balise: BaliseReading[int]) -> None:
        """Use a balise, once."""
        if balise == self._last:
            return
        self._last = balise
        _, surveyed_01mm, passed_01mm = balise
        since_01mm = passed_01mm - self._passed_01mm
        off_01mm = surveyed_01mm - self._anchor_01mm - since_01mm
        if abs(off_01mm) > BALISE_ERROR_01MM + abs(since_01mm) // WHEEL_PARTS and not self._is_doubtful:
            self.refused += 1
            self._is_doubtful = True
            return
        self._is_doubtful = False
        self._anchor_01mm, self._passed_01mm = surveyed_01mm, passed_01mm

    def at(self, odometer_01mm: int) -> int:
        """Position of the train with this odometer."""
        return self._anchor_01mm + odometer_01mm - self._passed_01mm
