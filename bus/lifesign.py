"""Life sign of a telegram: the 4-bit counter by which a receiver distinguishes fresh telegrams from stuck, repeated and
old ones."""

from __future__ import annotations

from enum import Enum
from typing import Final

_MODULUS: Final = 16
#: Counter steps up to this are a gap (lost telegrams); a telegram with a larger step is considered old.
MAX_STEP: Final = 7


class Life(Enum):
    """The verdict of a life sign on its telegram."""

    FIRST = "first"
    NEXT = "next"
    GAP = "gap"
    DUPLICATE = "duplicate"
    OUT_OF_ORDER = "out_of_order"

    @property
    def fresh(self) -> bool:
        """True when the telegram is new and may be used."""
        return self is _NEXT or self is _GAP or self is _FIRST


# Looking up a member of an enum costs as much as a call on CPython 3.11, and every telegram is judged.
_FIRST: Final = Life.FIRST
_NEXT: Final = Life.NEXT
_GAP: Final = Life.GAP
_DUPLICATE: Final = Life.DUPLICATE
_OUT_OF_ORDER: Final = Life.OUT_OF_ORDER


class LifeSign:
    """Remembers the last fresh life sign of one source."""

    __slots__ = ("_last",)

    def __init__(self) -> None:
        self._last = -1

    def judge(self, life: int) -> Life:
        """Compare with the last fresh one without storing anything (:meth:`accept` does that)."""
        if self._last < 0:
            return _FIRST
        step = (life - self._last) % _MODULUS
        if step == 1:
            return _NEXT
        if step == 0:
            return _DUPLICATE
        return _GAP if step <= MAX_STEP else _OUT_OF_ORDER

    def accept(self, life: int) -> None:
        """Store the life sign of a telegram that was used."""
        self._last = life
