"""Commands whose code the supervisor must not import (nodes meet on the bus): the process becomes that program.

``railhil node plant|controller`` is one node by itself, for a bench of several machines or a real adapter.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import sys

from railhil.common.errors import InputError
from railhil.common.exit_codes import hold_back_interrupts

NODES = {"plant": "railhil.plant_sim", "controller": "railhil.controller_node"}
#: Command -> module that is run, and its line in the help.
PROGRAMS = {
    "audit": (
        "railhil.audit",
        "a law's fixed point: ranges, quantisation, cycles, effect on the scores",
    ),
    "campaign": (
        "railhil.campaign",
        "thousands of perturbed runs of several laws: statistics, worst runs, resume",
    ),
    "completion": ("railhil.cli.completion", "print a completion script for bash or zsh"),
    "export-c": ("railhil.cli.export_c", "write a control law as C99 for the target"),
    "tune": ("railhil.tuning", "tune the parameters of a law on training runs, compare on others"),
    "vcan": (
        "railhil.machines.vcan",
        "run a command where vcan0 is up: a namespace of this kernel, else a virtual machine",
    ),
}


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommands."""
    node = commands.add_parser("node", help="run one node by itself")
    node.add_argument("role", choices=sorted(NODES))
    node.add_argument("arguments", nargs=argparse.REMAINDER, help="options of the node: railhil node ROLE --help")
    node.set_defaults(work=lambda namespace: _become(NODES[namespace.role], namespace.arguments))
    for name, (_, words) in PROGRAMS.items():
        # For the list of commands; the program reads its command line and has a help of its own.
        commands.add_parser(name, help=words, add_help=False)


def become_program(arguments: list[str]) -> None:
    """Become the program that the command line asks for, if it asks for one."""
    if arguments and arguments[0] in PROGRAMS:
        _become(PROGRAMS[arguments[0]][0], arguments[1:])


def _become(module: str, arguments: list[str]) -> int:
    if importlib.util.find_spec(module) is None:
        # The container image, for one, leaves the tests and what is built on them out.
        raise InputError("railhil", "command", module, "a program of this installation, which leaves it out")
    sys.stdout.flush()
    sys.stderr.flush()
    hold_back_interrupts()
    os.execv(sys.executable, [sys.executable, "-m", module, *arguments])
