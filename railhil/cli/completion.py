"""``railhil completion bash|zsh``: a completion script for the shell, made by shtab from the parsers themselves."""

from __future__ import annotations

import argparse
import sys
from importlib import import_module

from railhil.cli import commands, programs
from railhil.common.command_line import OneLineParser, parse
from railhil.common.exit_codes import PASS, run_guarded
from railhil.common.extras import missing_library
from railhil.scenarios.load import short_names
from railhil.scenarios.system import DEFAULT, system_named

#: Module with the command line of a program, if not its ``__main__``.
_ARGUMENTS = {
    "railhil.panel": "railhil.panel.command",
    "railhil.sequences.sequence_command": "railhil.sequences.sequence_command",
    "railhil.tuning": "railhil.tuning.command",
    "railhil.machines.vcan": "railhil.machines.vcan",
    "railhil.cli.completion": "railhil.cli.completion",
    "railhil.cli.export_c": "railhil.cli.export_c",
    "railhil.cli.target": "railhil.cli.target",
    "railhil.plant_sim": "railhil.plant_sim.command",
    "railhil.controller_node": "railhil.controller_node.command",
}
_SCENARIO = {"bash": "_railhil_scenario", "zsh": "_railhil_scenario"}
_BASH = """
_railhil_scenario() {{ compgen -W "{names}" -- "$1"; compgen -f -X '!*.toml' -- "$1"; compgen -d -- "$1"; }}
"""
_ZSH = """
_railhil_scenario() {{ _alternative 'scenarios:scenario:({names})' 'files:file:_files -g "*.toml"' }}
"""


def program_parser(module: str) -> argparse.ArgumentParser:
    """The command line of a program that ``railhil`` executes."""
    found: argparse.ArgumentParser = import_module(_ARGUMENTS.get(module, f"{module}.__main__")).arguments()
    return found


def whole_parser() -> argparse.ArgumentParser:
    """Every command with its options, including those of other programs; for inspection, not for parsing."""
    root = commands.parser()
    below = next(action for action in root._actions if isinstance(action, argparse._SubParsersAction))
    # The description of the help shows the commands; a completion needs them as arguments.
    below.help, choices = "command", below.choices
    for name, module in programs.PROGRAMS.items():
        choices[name] = program_parser(module)
    return root


def arguments() -> argparse.ArgumentParser:
    """Command line of this program."""
    parser = OneLineParser(
        prog="railhil completion",
        description="Print a completion script for the shell.",
        examples=['eval "$(railhil completion bash)"', "railhil completion zsh > _railhil"],
    )
    parser.add_argument("shell", choices=sorted(_SCENARIO), metavar="SHELL", help="bash or zsh")
    return parser


def _mark(parser: argparse.ArgumentParser, file: object, folder: object) -> None:
    """Mark each argument with its kind for completion: a scenario, a law, a file, a folder."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for inner in dict.fromkeys(action.choices.values()):
                _mark(inner, file, folder)
        elif action.dest in ("scenario", "extends"):
            action.complete = _SCENARIO  # type: ignore[attr-defined]
        elif action.dest in ("controller", "law"):
            action.choices = system_named(DEFAULT).law_names()
        elif action.metavar in ("FILE", "DIR", "RUN"):
            action.complete = file if action.metavar == "FILE" else folder  # type: ignore[attr-defined]


def script(shell: str) -> str:
    """The script. Raises InputError without shtab."""
    try:
        import shtab
    except ImportError as error:
        raise missing_library("railhil completion", error, "completion") from None
    root = whole_parser()
    _mark(root, shtab.FILE, shtab.DIRECTORY)
    names = " ".join(sorted({*short_names().values()}))
    preamble = {"bash": _BASH.format(names=names), "zsh": _ZSH.format(names=names)}
    return str(shtab.complete(root, shell=shell, preamble=preamble[shell]))


def main() -> int:
    """Print the script."""
    namespace = parse(arguments())
    sys.stdout.write(script(namespace.shell) + "\n")
    return PASS


if __name__ == "__main__":
    sys.exit(run_guarded("railhil completion", main))
