"""Commands of an operator in a run, as text: ``75 inject 1`` is sent with the 75th SUP_CMD of the run.

SUP_CMD is polled at fixed instants of simulation time, so the same commands make the same run again. ``76 value 61``
sends an octet of the values of the fault that is injected next (:mod:`railhil.faults.operator_values`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from railhil.common.errors import InputError

#: The option of ``railhil run``.
ORDER = "--order"
#: Words of an order; the first two with the number of a fault of the run, the third with an octet.
WORDS = ("inject", "clear", "value", "pause", "stop")
#: The smallest number of each word that has one; faults are numbered in 8 bits.
_LOWEST = {"inject": 1, "clear": 1, "value": 0}
_NUMBER_MAX = 255
_TEXT = re.compile(r"(?P<answer>[0-9]{1,9}) (?P<word>[a-z]+)(?: (?P<number>[0-9]{1,3}))?")
_ALLOWED = "'N inject FAULT', 'N clear FAULT', 'N value OCTET', 'N pause' or 'N stop', N from 2: number of the SUP_CMD"


@dataclass(frozen=True, slots=True)
class OperatorCommand:
    """One order: the number of the SUP_CMD that carries it (1 is the start), the word, the fault, the octet or 0."""

    answer: int
    word: str
    number: int = 0

    @property
    def text(self) -> str:
        """As in a certificate."""
        return f"{self.answer} {self.word}" + (f" {self.number}" if self.word in _LOWEST else "")


def parse_command(text: str, source: str | Path = ORDER) -> OperatorCommand:
    """The order of a text.

    :param source: source named in errors.
    :raises InputError: it is no order.
    """
    found = _TEXT.fullmatch(text)
    if found is not None:
        one = OperatorCommand(int(found["answer"]), found["word"], int(found["number"] or 0))
        lowest = _LOWEST.get(one.word)
        fits = not found["number"] if lowest is None else found["number"] and lowest <= one.number <= _NUMBER_MAX
        if one.answer >= 2 and one.word in WORDS and fits:
            return one
    raise InputError(source, "order", text, _ALLOWED)


def parse_commands(texts: Iterable[str], source: str | Path = ORDER) -> dict[int, OperatorCommand]:
    """The orders of a run by the number of their SUP_CMD.

    :raises InputError: a text is no order, or two are for one SUP_CMD.
    """
    found: dict[int, OperatorCommand] = {}
    for text in texts:
        one = parse_command(text, source)
        if one.answer in found:
            raise InputError(source, "order", text, f"one order for each SUP_CMD (there is '{found[one.answer].text}')")
        found[one.answer] = one
    return found
