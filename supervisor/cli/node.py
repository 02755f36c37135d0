"""``railhil node plant|controller``: one node by itself, for a bench of several machines or a real adapter."""

from __future__ import annotations

import argparse
import os
import sys

_MODULES = {"plant": "plant_sim", "controller": "controller_node"}


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("node", help="run one node by itself")
    parser.add_argument("role", choices=sorted(_MODULES))
    parser.add_argument("arguments", nargs=argparse.REMAINDER, help="options of the node: railhil node ROLE --help")
    parser.set_defaults(work=work)


def work(namespace: argparse.Namespace) -> int:
    """Become the node: the supervisor's code must not import the nodes, so the process is replaced."""
    command = [sys.executable, "-m", _MODULES[namespace.role], *namespace.arguments]
    sys.stdout.flush()
    sys.stderr.flush()
    os.execv(sys.executable, command)
