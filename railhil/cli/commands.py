"""The whole command line of ``railhil``: one module per subcommand, each with ``add_parser`` and what it does."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module
from importlib.metadata import version

from railhil.common.command_line import OneLineParser, parse
from railhil.common.output import accept_any_text, flush_output
from railhil.dbc import wire_contract

#: The modules in the order of the help; each has one command of its own name, but for ``programs``.
_MODULES = ("run", "compare", "score", "report", "plot", "scenarios", "ports", "new", "doctor", "programs", "bus")
#: Command -> module that has it.
_MODULE_OF = {name: name for name in _MODULES if name != "programs"} | {"node": "programs"}


def parser(command: str | None = None) -> argparse.ArgumentParser:
    """The whole command line.

    :param command: when it is the name of a command, only that one is there: what the others need takes a third of a
        second to load.
    """
    root = OneLineParser(
        prog="railhil",
        description="Hardware-in-the-loop bench for train controllers: MVB telegrams on a CAN bus.",
    )
    root.add_argument("--version", action="version", version=f"railhil {version('railhil')}")
    commands = root.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name in (_MODULE_OF[command],) if command in _MODULE_OF else _MODULES:
        import_module(f"railhil.cli.{name}").add_parser(commands)
    return root


def work(words: Sequence[str]) -> int:
    """Do what the command line asks for; returns the exit code."""
    accept_any_text()
    namespace = parse(parser(words[0] if words else None), words)
    # A DBC that is not the one of the port table must be noticed by every command, also by those that never look at a
    # telegram.
    wire_contract()
    try:
        return int(namespace.work(namespace))
    finally:
        flush_output()
