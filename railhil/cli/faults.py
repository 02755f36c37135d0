"""``railhil faults``: the words of the fault language."""

from __future__ import annotations

import argparse
from typing import Any

from railhil.common.output import Output, add_json_argument, print_json
from railhil.faults.page import lines
from railhil.faults.words import CLEAR, PLACES, WORDS


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("faults", help="list what railhil run --fault can inject, word by word")
    add_json_argument(parser)
    parser.set_defaults(work=work)


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


def work(namespace: argparse.Namespace) -> int:
    """Print all words; exit code 0."""
    if namespace.json:
        print_json(_document())
    else:
        console = Output()
        for line in lines():
            console.say(line)
    return 0
