"""What a page prints, compared with what is true: the same words, and which figures differ."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from hil_tests.documents.pages import Block

#: What may change while the words stay: numbers with sign, the digits of a hash.
_MOVING = re.compile(r"\b[0-9a-f]{64}\b|[+-]?\d+(?:\.\d+)*(?:e[+-]?\d+)?")
_ANYTHING = "..."


class OtherWords(Exception):
    """The words differ, not only the figures: somebody has to write them."""


@dataclass(frozen=True, slots=True)
class Change:
    """Line ``number`` (from 0) of the page has to be ``line``."""

    number: int
    line: str


def shape(text: str) -> re.Pattern[str]:
    """Pattern of the text with any other figures. Blanks may be line ends; ``...`` is anything on one line."""
    parts: list[str] = []
    at = 0
    for found in _MOVING.finditer(text):
        parts += [_words(text[at : found.start()]), "(", _figure(found[0]), ")"]
        at = found.end()
    return re.compile("".join([*parts, _words(text[at:])]))


def _words(text: str) -> str:
    pieces = [re.sub(r"(?:\\\s)+|\s+", r"\\s+", re.escape(piece)) for piece in text.split(_ANYTHING)]
    return r"[^\n]*?".join(pieces)


def _figure(text: str) -> str:
    return "[0-9a-f]{64}" if len(text) == 64 else r"[+-]?\d+(?:\.\d+)*(?:e[+-]?\d+)?"


def with_figures(text: str, figures: Sequence[str]) -> str:
    """The text with other figures in their places."""
    left = iter(figures)
    return _MOVING.sub(lambda _: next(left), text)


def printed(block: Block, first: int, expected: Sequence[str], actual: str) -> list[Change]:
    """Lines of a block that a command printed, beside what it prints: each must be there, in this order.

    :param first: number of the first of the lines within the block.
    :raises OtherWords: a line is not there, whatever its figures.
    """
    changes, at = [], 0
    # Widths of columns change with their figures.
    for offset, line in enumerate(expected):
        wanted = line.strip()
        if wanted in ("", _ANYTHING):
            continue
        found = re.compile(rf"^[ ]*{shape(wanted).pattern}[ ]*$", re.M).search(actual, at)
        if found is None:
            raise OtherWords(f"{block.page}:{block.first + first + offset + 1}: not printed: {wanted}\n{actual}")
        at = found.end()
        if list(found.groups()) != _MOVING.findall(wanted):
            full = found[0] if _ANYTHING not in wanted else with_figures(line, found.groups())
            changes.append(Change(block.first + first + offset, full.rstrip()))
    return changes


def table(block: Block, rows: Sequence[str]) -> list[Change]:
    """Rows of a table beside the true ones.

    :raises OtherWords: there are more or fewer of them.
    """
    if len(rows) != len(block.lines):
        raise OtherWords(f"{block}: {len(block.lines)} rows, {len(rows)} are computed")
    indent = block.lines[0][: len(block.lines[0]) - len(block.lines[0].lstrip())]
    pairs = enumerate(zip(block.lines, (indent + row for row in rows), strict=True))
    return [Change(block.first + n, true) for n, (line, true) in pairs if line != true]


def paragraph(block: Block, pieces: Sequence[str], given: Sequence[str] = ()) -> list[Change]:
    """A paragraph beside pieces of it with the true figures.

    :param given: figures in the paragraph that are no results.
    :raises OtherWords: a piece is not there, or a figure of the paragraph is in none.
    """
    text = block.text
    places: list[tuple[int, int, str]] = []
    for piece in pieces:
        found = list(shape(piece).finditer(text))
        if len(found) != 1:
            raise OtherWords(f"{block}: there {len(found)} times: {piece}")
        true = _MOVING.findall(piece)
        places += [(*found[0].span(n + 1), value) for n, value in enumerate(true)]
    bare = block.figures
    for begin, end, _ in places:
        if text[begin:end] in bare:
            bare.remove(text[begin:end])
    left = [figure for figure in bare if figure.lstrip("+-") not in given]
    if left:
        raise OtherWords(f"{block}: no function computes {', '.join(left)}")
    for begin, end, true_text in sorted(places, reverse=True):
        text = text[:begin] + true_text + text[end:]
    new = text.split("\n")
    return [Change(block.first + n, line) for n, line in enumerate(new) if line != block.lines[n]]
