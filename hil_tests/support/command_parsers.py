"""The parsers of all commands, by the words that a user types."""

from __future__ import annotations

from argparse import ArgumentParser, _SubParsersAction
from collections.abc import Iterator

from railhil.cli.completion import program_parser, whole_parser
from railhil.cli.programs import NODES


def _leaves(parser: ArgumentParser) -> Iterator[ArgumentParser]:
    below = [action for action in parser._actions if isinstance(action, _SubParsersAction)]
    for action in below:
        for inner in action.choices.values():
            yield from _leaves(inner)
    if not below:
        yield parser


COMMANDS = {
    one.prog: one
    for one in [*_leaves(whole_parser()), *map(program_parser, NODES.values())]
    if one.prog != "railhil node"
}
