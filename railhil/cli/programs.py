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
#: Command -> module to run, and its line in the help.
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
    "learn": (
        "railhil.sequences",
        "sequences of runs of a law that learns from run to run, with the decrease of its errors",
    ),
    "panel": ("railhil.panel", "a page in the browser: the run on a bus, or recorded runs"),
    "reproduce": (
        "railhil.reproduce",
        "run the protocol of a paper and print its tables beside the published ones",
    ),
    "sequence": (
        "railhil.sequences.sequence_command",
        "record runs of a law that learns as one piece of evidence, verify it, make it again",
    ),
    "target": ("railhil.cli.target", "a controller in C on an emulated board: size, log, instructions"),
    "train-model": ("railhil.learning", "train the network of a law for high-speed trains on a recorded run"),
    "tune": ("railhil.tuning", "tune the parameters of a law on training runs, compare on others"),
    "vcan": (
        "railhil.machines.vcan",
        "run a command where vcan0 is up: a namespace of this kernel, else a virtual machine",
    ),
}


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register ``railhil node``."""
    node = commands.add_parser("node")
    node.add_argument("role", choices=sorted(NODES), help="which node; each has a --help of its own")
    node.add_argument("arguments", nargs=argparse.REMAINDER, help="options of the node: railhil node ROLE --help")
    node.set_defaults(work=lambda namespace: _become(NODES[namespace.role], namespace.arguments))


def become_program(arguments: list[str]) -> None:
    """Execute the program named on the command line, if there is one."""
    if arguments and arguments[0] in PROGRAMS:
        _become(PROGRAMS[arguments[0]][0], arguments[1:])


def _become(module: str, arguments: list[str]) -> int:
    if importlib.util.find_spec(module) is None:
        # The container image, for example, does not contain the tests and programs based on them.
        raise InputError("railhil", "command", module, Sentence(f"{module} is not part of this installation"))
    sys.stdout.flush()
    sys.stderr.flush()
    hold_back_interrupts()
    os.execv(sys.executable, [sys.executable, "-P", "-m", module, *arguments])
