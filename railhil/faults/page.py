"""``docs/reference/faults.md``: all words of the fault language and the places where each can be injected.

The page is made from the tables of this package.

``python -m railhil.faults.page`` writes it; a test compares the file with the generated text.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from railhil.faults.capability import PACES, REFUSALS, TRANSPORTS, Refusal
from railhil.faults.model import Parameter, Word
from railhil.faults.notation import allowed_text, number_text
from railhil.faults.words import CLEAR, PLACES, WORDS, levels_of

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "faults.md"
_HEAD = """\
# Faults

Written by `python -m railhil.faults.page` from the tables that check the faults. How a fault is written and what it
does to a run: [inject faults](../howto/faults.md).
"""
_TITLES = {
    "train": "Train",
    "sensor": "Sensors",
    "actuator": "Actuators",
    "command": "Commands",
    "clock": "Clock",
    "telegram": "Telegrams",
    "node": "Nodes",
    "bus": "Bus",
}
_PARTS = {"counter": "`PORT.counter`", "checksum": "`PORT.checksum`", "signal": "`PORT.Signal`", "line": "`bus.a`"}


def page() -> str:
    """The whole page."""
    text = _HEAD
    for level, words in levels_of().items():
        text += f"\n## {_TITLES[level]}\n\n"
        places = [f"`{name}` ({what})" for name, what in PLACES.get(level, {}).items() if name]
        text += f"Places: {'; '.join(places)}.\n\n" if places else ""
        text += "| word | values | what | after | from |\n|---|---|---|---|---|\n"
        for word in words:
            if word.name != CLEAR:
                text += f"| {' | '.join(row(word))} |\n"
    text += "\n## What can be injected where\n\n"
    text += "Everything above can be injected on each of these, except for the faults of the second table. These are\n"
    text += "refused in one line before the run begins.\n\n| transport | what it is |\n|---|---|\n"
    text += "".join(f"| {name} | {what} |\n" for name, what in TRANSPORTS.items())
    text += "\n| not injected | on | pace | why |\n|---|---|---|---|\n"
    text += "".join(f"| {' | '.join(_refusal(entry))} |\n" for entry in REFUSALS)
    return text


def row(word: Word) -> list[str]:
    """A word as cells: name with its place, values, meaning, words after it, origin."""
    at = _PARTS.get(word.part) or (", ".join(f"`{name}`" for name in word.names))
    values = "; ".join(_parameter(one) for one in word.parameters) or "-"
    after = ", ".join(f"`{one}`" for one in word.after) or "-"
    return [f"`{word.name}`{f' of {at}' if at else ''}", values, word.meaning, after, word.origin]


def _parameter(one: Parameter) -> str:
    usual = (
        f"required, such as {one.example or allowed_text(one.unit)}"
        if one.usual is None
        else one.usual
        if isinstance(one.usual, str)
        else number_text(one.usual, one.unit)
    )
    keyword = f"`{one.keyword}` " if one.keyword not in ("", one.name) else ""
    # The name alone says what begins with the same word.
    said = (one.name.rpartition("_")[0] or one.name).replace("_", " ")
    meaning = one.meaning.removeprefix(said).lstrip(" ,")
    return f"{keyword}`{one.name}`{f' {meaning}' if meaning else ''} ({usual})"


def _refusal(entry: Refusal) -> list[str]:
    words = [word for word in WORDS if entry.fits(word, "") or any(entry.fits(word, name) for name in entry.names)]
    levels = entry.levels or tuple(levels_of())
    what = ", ".join(entry.words) or ("lines" if entry.parts else "everything")
    assert words, entry.why
    of = "" if len(levels) == len(levels_of()) else f" of {', '.join(entry.names or levels)}"
    at = f" at the {', '.join(entry.sources)}" if entry.sources else ""
    return [f"{what}{of}{at}", ", ".join(entry.transports) or "all", ", ".join(entry.paces or PACES), entry.why]


def lines() -> Iterator[str]:
    """All words for the console, level by level."""
    for level, words in levels_of().items():
        names = ", ".join(name for name in PLACES.get(level, {}) if name) or level
        yield f"{level} ({names if level != 'telegram' else 'PORT, PORT.counter, PORT.checksum, PORT.Signal'})"
        for word in words:
            if word.name != CLEAR:
                name, values, meaning, *_ = (cell.replace("`", "") for cell in row(word))
                yield f"  {name}: {meaning}" + ("" if values == "-" else f" [{values}]")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    sys.stdout.write(f"{PAGE}\n")
