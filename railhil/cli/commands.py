"""The command line of ``railhil``: a module for each command, with ``add_parser`` and ``work``, which executes it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any, NoReturn

from railhil.cli import programs
from railhil.common.command_line import OneLineParser, run_command
from railhil.common.errors import did_you_mean
from railhil.common.exit_codes import USAGE
from railhil.dbc import wire_contract

#: Groups of commands in the help, with the line of each command.
GROUPS: Mapping[str, Mapping[str, str]] = {
    "set up": {
        "new": "write a line, law, scenario, controller or system to start from",
        "scenarios": "list the shipped scenarios, or check a file of yours",
        "bound": "least traction work of a scenario's sections, and shortest times",
        "doctor": "timing, interfaces and limits of this machine",
        "completion": "print a completion script for bash or zsh",
    },
    "make runs": {
        "run": "run a scenario over the bus, record it, score it",
        "compare": "run several laws, one after another, and compare them",
        "faults": "run the fault catalogue, or random pairs of faults",
        "campaign": "thousands of perturbed runs: statistics, worst runs",
        "hunt": "search for faults that violate a requirement, shrink them",
        "bench-suite": "planted defects for searches, and a table of who found them",
        "probability": "how often drawn runs violate a requirement, down to 1e-7",
        "learn": "sequences of runs of a law that learns: how its errors decrease",
        "sequence": "record runs of a law that learns as one piece of evidence",
        "reproduce": "run the protocol of a paper, compare with its tables",
    },
    "look at runs": {
        "runs": "an index of all run folders: table, groups, page",
        "query": "SQL over this index",
        "panel": "a page in the browser: the run on a bus, or recorded runs",
        "watch": "the run on a bus in the terminal (listens only)",
        "score": "score a recorded log",
        "report": "write report.html of recorded runs",
        "plot": "draw a recorded run",
        "export": "write a recorded run as files of other tools",
        "memory": "show, check or export the memory that a law has kept",
    },
    "check runs": {
        "verify": "check the files of a folder against its hashes and signature",
        "dossier": "what runs, tests and hunts show of each requirement",
        "branch": "make a recorded run again with other faults from an instant on",
        "rerun": "repeat a recorded run, name the first frame that differs",
        "replay": "drive one node with a recorded log, compare its answers",
    },
    "work on a law": {
        "audit": "fixed point: ranges, quantisation, cycles, effect on scores",
        "tune": "tune the parameters of a law on training runs",
        "train-model": "train the network of a law on a recorded run",
        "export-c": "write a law as C99 for the target",
        "target": "a controller in C on an emulated board",
    },
    "bus and nodes": {
        "ports": "print ports, telegram layouts and bus load",
        "board": "check a controller on a bus before its first run",
        "node": "run one node by itself",
        "bus": "the software CAN switch",
        "vcan": "run a command where the kernel has vcan0",
    },
}
_LINES = {name: line for group in GROUPS.values() for name, line in group.items()}
#: Command -> its module, unless it is that of its name in this package. A program has none.
_MODULES = {"bench-suite": "railhil.cli.bench_suite", "node": "railhil.cli.programs", "bus": "railhil.bus.hub.cli"}
_WHAT = "Hardware-in-the-loop bench for train controllers: MVB telegrams on a CAN bus."
#: The first commands of a new user, and what each does.
_FIRST_STEPS = {
    "railhil run --controller ipfc_plus": "a run with a good law: verdict, scores, report",
    "railhil new line myline": "a line and a train of your own",
    "railhil new law mylaw": "a law of your own",
    "railhil new c-controller mine": "a controller of your own in C, C++ or Python",
    "railhil COMMAND --help": "options and examples of a command",
}


def _columns(rows: Mapping[str, str]) -> list[str]:
    width = max(map(len, rows))
    return [f"  {name:{width}}  {line}" for name, line in rows.items()]


def _begin() -> str:
    """Where to begin."""
    return "\n".join([_WHAT, "", "where to begin:", *_columns(_FIRST_STEPS)])


def _whole_description() -> str:
    """All commands in their groups."""
    width = max(map(len, _LINES))
    lines = [_begin()]
    for title, group in GROUPS.items():
        lines += ["", f"{title}:", *(f"  {name:{width}}  {line}" for name, line in group.items())]
    return "\n".join(lines)


class _Commands(argparse._SubParsersAction):  # type: ignore[type-arg]
    """Gives each command its line, which a completion shows."""

    def add_parser(self, name: str, **given: Any) -> argparse.ArgumentParser:
        given.setdefault("description", f"{_LINES[name][0].upper()}{_LINES[name][1:]}.")
        made: argparse.ArgumentParser = super().add_parser(name, help=_LINES[name], **given)
        return made


class _Version(argparse.Action):
    """``--version``, looked up only on request."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        from railhil.common.version import full_version

        print(f"railhil {full_version()}")
        parser.exit()


def parser(words: Sequence[str] | None = None) -> argparse.ArgumentParser:
    """The needed part of the command line: modules of other commands are not loaded.

    :param words: the words to parse. If they begin with a command, only that one is included; if it names none, as
        for the help, the commands have no options. None: everything.
    """
    root = OneLineParser(prog="railhil", usage="railhil COMMAND [options]", description=_whole_description())
    root.add_argument("--version", action=_Version, nargs=0, help="show program's version number and exit")
    # The groups of the description show the commands.
    commands = root.add_subparsers(
        action=_Commands, prog="railhil", dest="command", required=True, metavar="COMMAND", help=argparse.SUPPRESS
    )
    bare = words is not None and not any(word in _LINES for word in words)
    for name in words[:1] if words and words[0] in _LINES else _LINES:
        if bare or name in programs.PROGRAMS:
            # A program parses its own command line and has its own help.
            commands.add_parser(name, add_help=False)
        else:
            module = import_module(_MODULES.get(name, f"railhil.cli.{name}"))
            module.add_parser(commands)
            # A command of several verbs has a work of each.
            if hasattr(module, "work"):
                commands.choices[name].set_defaults(work=module.work)
    return root


def work(words: Sequence[str]) -> int:
    """Execute the command line; returns the exit code."""
    if not words:
        # In a script, a command that is missing is no success.
        print(_begin(), "all commands: railhil --help", sep="\n\n", file=sys.stderr)
        return USAGE
    asked = parser(words)
    if not words[0].startswith("-") and words[0] not in _LINES:
        hint = did_you_mean(words[0], _LINES)
        asked.error(f"there is no command {words[0]!r}{f', {hint}' if hint else ''}")
    return run_command(asked, words, _work)


def _work(namespace: argparse.Namespace) -> int:
    # Every command must detect a DBC that does not match the port table, even commands that never use a telegram.
    wire_contract()
    return int(namespace.work(namespace))
