"""The command line of ``railhil``: one module per subcommand, each with ``add_parser`` and its implementation."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module
from typing import NoReturn

from railhil.common.command_line import OneLineParser, parse
from railhil.common.output import accept_any_text, flush_output
from railhil.dbc import wire_contract

#: The modules in the order of the help; each has one command of the same name, except ``programs``.
_MODULES = (
    "run",
    "rerun",
    "replay",
    "compare",
    "faults",
    "score",
    "report",
    "plot",
    "export",
    "watch",
    "memory",
    "scenarios",
    "ports",
    "new",
    "doctor",
    "programs",
    "bus",
)
#: Command -> its module.
_MODULE_OF = {name: name for name in _MODULES if name != "programs"} | {"node": "programs"}


class _Version(argparse.Action):
    """``--version``: looked up only if somebody asks."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        from importlib.metadata import version

        print(f"railhil {version('railhil')}")
        parser.exit()


def parser(command: str | None = None) -> argparse.ArgumentParser:
    """The whole command line.

    :param command: if it is the name of a command, only that one is included: loading the others takes a third of a
        second.
    """
    root = OneLineParser(
        prog="railhil",
        description="Hardware-in-the-loop bench for train controllers: MVB telegrams on a CAN bus.",
    )
    root.add_argument("--version", action=_Version, nargs=0, help="show program's version number and exit")
    commands = root.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name in (_MODULE_OF[command],) if command in _MODULE_OF else _MODULES:
        import_module(f"railhil.cli.{name}").add_parser(commands)
    return root


def work(words: Sequence[str]) -> int:
    """Execute the command line; returns the exit code."""
    accept_any_text()
    namespace = parse(parser(words[0] if words else None), words)
    # Every command must detect a DBC that does not match the port table, even commands that never use a telegram.
    wire_contract()
    try:
        return int(namespace.work(namespace))
    finally:
        flush_output()
