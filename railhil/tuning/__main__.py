"""``python -m railhil.tuning`` (the same as ``railhil tune``)."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Sequence
from pathlib import Path

import railhil.controller_node
from railhil.common.command_line import run_command
from railhil.common.exit_codes import PASS, run_guarded
from railhil.common.output import Output
from railhil.common.streams import print_json
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.tuning.command import Request, arguments, check_combination


def shipped() -> list[ParameterSet]:
    """The parameter files of the package, ``controller_node/<system>/tuned/<scenario>/<law>.toml``, by scenario and
    law.

    :raises InputError: an invalid file.
    """
    folder = Path(railhil.controller_node.__file__).parent
    return [load_parameters(path) for path in sorted(folder.glob("*/tuned/*/*.toml"))]


def _list(console: Output, as_json: bool) -> int:
    if as_json:
        print_json([{"law": one.law, "scenario": one.training_scenario, "file": str(one.source)} for one in shipped()])
        return PASS
    for given in shipped():
        console.say(f"{given.law}  {given.training_scenario}  {given.source}")
    return PASS


def main(words: Sequence[str] | None = None) -> int:
    """Search, evaluate or list."""
    return run_command(arguments(), words, _work)


def _work(namespace: argparse.Namespace) -> int:
    check_combination(namespace)
    console = Output(stderr=namespace.json)
    if namespace.list:
        return _list(console, namespace.json)
    # It runs the bench: help and list do not need the extra libraries.
    from railhil.tuning import procedure

    request = Request.of(namespace)
    if namespace.evaluate is not None:
        result = procedure.evaluate_file(request, Path(namespace.evaluate), console)
    else:
        result = procedure.tune(request, console)
    if namespace.json:
        print_json(result)
    return PASS if result.get("complete", True) else 128 + signal.SIGINT


if __name__ == "__main__":
    sys.exit(run_guarded("railhil tune", main))
