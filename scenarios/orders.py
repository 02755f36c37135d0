"""Orders of an operator in a run, as text: ``75 inject 1`` is sent with the 75th SUP_CMD of the run.

SUP_CMD is polled at fixed instants of simulation time, so the same orders make the same run again.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from railhil.common.errors import InputError

#: The option of ``railhil run``.
ORDER = "--order"
#: What can be ordered; the first two with the number of a fault of the run.
WORDS = ("inject", "clear", "pause", "stop")
_OF_FAULTS = WORDS[:2]
#: Faults are numbered in 8 bits.
_FAULT_MAX = 255
_TEXT = re.compile(r"(?P<answer>[0-9]{1,9}) (?P<word>[a-z]+)(?: (?P<fault>[0-9]{1,3}))?")
_ALLOWED = "'N inject FAULT', 'N clear FAULT', 'N pause' or 'N stop', with N from 2: the number of the SUP_CMD"


@dataclass(frozen=True, slots=True)
class Order:
    """One order: the number of the SUP_CMD that carries it (1 is the start), the word, the fault or 0."""

    answer: int
    word: str
    fault: int = 0

    @property
    def text(self) -> str:
        """As in a certificate."""
        return f"{self.answer} {self.word}" + (f" {self.fault}" if self.fault else "")


def order_of(text: str, source: str | Path = ORDER) -> Order:
    """The order of a text.

    :param source: what errors name as its source.
    :raises InputError: it is none.
    """
    found = _TEXT.fullmatch(text)
    if found is not None:
        one = Order(int(found["answer"]), found["word"], int(found["fault"] or 0))
        names_fault = one.word in _OF_FAULTS and 1 <= one.fault <= _FAULT_MAX
        if (
            one.answer >= 2
            and one.word in WORDS
            and (names_fault or (one.word not in _OF_FAULTS and not found["fault"]))
        ):
            return one
    raise InputError(source, "order", text, _ALLOWED)


def orders_of(texts: Iterable[str], source: str | Path = ORDER) -> dict[int, Order]:
    """The orders of a run by the number of their SUP_CMD.

    :raises InputError: a text is none, or two are for one SUP_CMD.
    """
    found: dict[int, Order] = {}
    for text in texts:
        one = order_of(text, source)
        if one.answer in found:
            raise InputError(source, "order", text, f"one order for each SUP_CMD (there is '{found[one.answer].text}')")
        found[one.answer] = one
    return found
