"""Commands whose code the supervisor must not import (nodes communicate over the bus): the process executes that
program instead.

``railhil node plant|controller`` is a single node, for a bench of several machines or a real adapter.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import sys

from railhil.common.errors import InputError, Sentence
from railhil.common.exit_codes import hold_back_interrupts

NODES = {"plant": "railhil.plant_sim", "controller": "railhil.controller_node"}
#: Command -> module to run.
PROGRAMS = {
    "audit": "railhil.audit",
    "campaign": "railhil.campaign",
    "completion": "railhil.cli.completion",
    "export-c": "railhil.cli.export_c",
    "hunt": "railhil.hunt",
    "learn": "railhil.sequences",
    "panel": "railhil.panel",
    "probability": "railhil.probability",
    "reproduce": "railhil.reproduce",
    "sequence": "railhil.sequences.sequence_command",
    "target": "railhil.cli.target",
    "train-model": "railhil.learning",
    "tune": "railhil.tuning",
    "vcan": "railhil.machines.vcan",
}


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register ``railhil node``."""
    node = commands.add_parser(
        "node",
        examples=[
            "railhil node plant yizhuang_05 -i socketcan -c vcan0",
            "railhil node controller yizhuang_05 --controller ipfc_plus -i socketcan -c vcan0",
        ],
    )
    node.add_argument(
        "role",
        metavar="ROLE",
        choices=sorted(NODES),
        help="controller or plant: which node; each has a --help of its own",
    )
    node.add_argument("arguments", nargs=argparse.REMAINDER, help="options of the node: railhil node ROLE --help")


def work(namespace: argparse.Namespace) -> int:
    """Execute the node."""
    return _become(NODES[namespace.role], namespace.arguments)


def become_program(arguments: list[str]) -> None:
    """Execute the program named on the command line, if there is one."""
    if arguments and arguments[0] in PROGRAMS:
        _become(PROGRAMS[arguments[0]], arguments[1:])


def _become(module: str, arguments: list[str]) -> int:
    if importlib.util.find_spec(module) is None:
        # The container image, for example, does not contain the tests and programs based on them.
        raise InputError("railhil", "command", module, Sentence(f"{module} is not part of this installation"))
    sys.stdout.flush()
    sys.stderr.flush()
    hold_back_interrupts()
    os.execv(sys.executable, [sys.executable, "-P", "-m", module, *arguments])
