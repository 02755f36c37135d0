"""The words of a sentence, each with its column."""

from __future__ import annotations

import re
from typing import Final, NamedTuple

#: Words of the language. No signal, name or unit has one of them as its name.
KEYWORDS: Final = frozenset(
    (
        *("always", "never", "whenever", "at", "eventually", "from", "to", "after", "between", "and", "or", "not"),
        *("within", "once", "for", "until", "longer", "than", "in", "begin", "end", "of", "start"),
    )
)
#: Functions of the language, and their arguments: v a value, t a time, p a port, e an event.
FUNCTIONS: Final = {
    "abs": "v",
    "min": "vv",
    "max": "vv",
    "rate": "vt",
    "mean": "vt",
    "before": "vt",
    "lowest": "vt",
    "highest": "vt",
    "age": "p",
    "good": "p",
    "bad": "p",
    "since": "e",
}
#: Longer sentences and definitions are refused.
SENTENCE_MAX: Final = 1000
NUMBER, NAME, SIGN, END = "number", "name", "sign", "end"
_WORD = re.compile(
    r"(?P<number>\d+(?:\.\d+)?(?:[eE][+-]?\d\d?)?)|(?P<name>[A-Za-z_]\w*)|(?P<sign><=|>=|!=|[<>=+*/(),.-])", re.ASCII
)
_UNIT = re.compile(r"\s*([A-Za-z%]+[2-9]?(?:/[A-Za-z]+[2-9]?)*)(?![\w(])", re.ASCII)


class Word(NamedTuple):
    """A word: its kind, text and column (from 0), and the end of its text; ``unit``: behind a number."""

    kind: str
    text: str
    column: int
    after: int
    unit: str = ""


class SentenceError(Exception):
    """A sentence that is not of the language, or does not fit the scenario.

    :param text: the part that is wrong. ``problem``: what is wrong with it. ``column``: its place, from 0.
    """

    def __init__(self, text: str, problem: str, column: int) -> None:
        super().__init__(text, problem, column)
        self.text, self.problem, self.column = text, problem, column


def words_of(text: str) -> list[Word]:
    """The words of a sentence, with one of kind ``end`` behind them.

    :raises SentenceError: a character that no word has, or a text longer than :data:`SENTENCE_MAX`.
    """
    if len(text) > SENTENCE_MAX:
        raise SentenceError(f"{text[:20]}...", f"has more than {SENTENCE_MAX} characters", SENTENCE_MAX)
    found, place = [], 0
    while place < len(text):
        if text[place].isspace():
            place += 1
            continue
        match = _WORD.match(text, place)
        if match is None:
            raise SentenceError(text[place], "no word of the language has this character", place)
        kind, column, place = str(match.lastgroup), place, match.end()
        unit = _UNIT.match(text, place) if kind == NUMBER else None
        if unit is not None and unit[1] not in KEYWORDS:
            found.append(Word(kind, match[0], column, unit.end(), unit[1]))
            place = unit.end()
        else:
            found.append(Word(kind, match[0], column, place))
    return [*found, Word(END, "", len(text), len(text))]
