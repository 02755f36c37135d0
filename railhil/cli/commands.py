"""The command line of ``railhil``: a module for each command, with ``add_parser`` and its implementation."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module
from typing import Any, NoReturn

from railhil.cli import programs
from railhil.common.command_line import OneLineParser, run_command
from railhil.dbc import wire_contract

#: Command -> its line in the help, in the order of the help.
_COMMANDS = {
    "run": "run a scenario over the bus, record it, score it",
    "rerun": "repeat a recorded run, name the first frame that differs",
    "replay": "drive one node with a recorded log, compare its answers",
    "compare": "run several laws over the bus, one after another, and compare them",
    "faults": "run the fault catalogue, or random pairs of faults, and print the reactions",
    "score": "score a recorded log",
    "verify": "check the files of a folder against its list of hashes, and who has signed it",
    "report": "write report.html of recorded runs (needs the extra [report])",
    "plot": "draw a recorded run (needs the extra [report])",
    "export": "write a recorded run as files of other tools",
    "watch": "watch a run on a bus in the terminal (listens only)",
    "memory": "show, check or export the memory that a law has kept",
    "scenarios": "list the shipped scenarios, or check one file",
    "ports": "print ports, telegram layouts and bus load",
    "new": "write a law, a scenario or a system to start from",
    "doctor": "timing and limits of this machine and its transports",
    "node": "run one node by itself",
    **{name: line for name, (_, line) in programs.PROGRAMS.items()},
    "board": "check a controller on a bus before its first run",
    "bus": "bus processes",
}


#: Command -> its module, unless it is that of its name in this package. A program has none.
_MODULES = {"node": "railhil.cli.programs", "bus": "railhil.bus.hub.cli"}


class _Commands(argparse._SubParsersAction):  # type: ignore[type-arg]
    """Gives each command its line in the help."""

    def add_parser(self, name: str, **given: Any) -> argparse.ArgumentParser:
        made: argparse.ArgumentParser = super().add_parser(name, help=_COMMANDS[name], **given)
        return made


class _Version(argparse.Action):
    """``--version``, looked up only on request."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        from importlib.metadata import version

        print(f"railhil {version('railhil')}")
        parser.exit()


def parser(words: Sequence[str] | None = None) -> argparse.ArgumentParser:
    """The needed part of the command line: modules of other commands are not loaded.

    :param words: the words to parse. If they begin with a command, only that one is included; if it names none, as
        for the help, the commands have no options. None: everything.
    """
    root = OneLineParser(
        prog="railhil",
        description="Hardware-in-the-loop bench for train controllers: MVB telegrams on a CAN bus.",
    )
    root.add_argument("--version", action=_Version, nargs=0, help="show program's version number and exit")
    commands = root.add_subparsers(action=_Commands, dest="command", required=True, metavar="COMMAND")
    bare = words is not None and not any(word in _COMMANDS for word in words)
    for name in words[:1] if words and words[0] in _COMMANDS else _COMMANDS:
        if bare or name in programs.PROGRAMS:
            # A program parses its own command line and has its own help.
            commands.add_parser(name, add_help=False)
        else:
            import_module(_MODULES.get(name, f"railhil.cli.{name}")).add_parser(commands)
    return root


def work(words: Sequence[str]) -> int:
    """Execute the command line; returns the exit code."""
    return run_command(parser(words), words, _work)


def _work(namespace: argparse.Namespace) -> int:
    # Every command must detect a DBC that does not match the port table, even commands that never use a telegram.
    wire_contract()
    return int(namespace.work(namespace))
