"""``railhil faults --list``: the words of the fault language."""

from __future__ import annotations

from typing import Any

from railhil.common.output import Output
from railhil.common.streams import print_json
from railhil.faults.page import lines
from railhil.faults.words import CLEAR, PLACES, WORDS


def _document() -> dict[str, Any]:
    words = [
        {
            "level": word.level,
            "part": word.part,
            "word": word.name,
            "places": list(word.names or PLACES.get(word.level, {})),
            "what": word.meaning,
            "after": list(word.after),
            "values": [
                {"name": one.name, "unit": one.unit, "usual": one.usual, "keyword": one.keyword, "what": one.meaning}
                for one in word.parameters
            ],
            "origin": word.origin,
        }
        for word in WORDS
        if word.name != CLEAR
    ]
    return {"words": words}


def print_words(as_json: bool) -> None:
    """Print all words."""
    if as_json:
        print_json(_document())
    else:
        console = Output()
        for line in lines():
            console.say(line)
