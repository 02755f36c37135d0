"""``railhil node plant|controller``: one node by itself, for a bench of several machines or a real adapter."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys

from supervisor.cli.usage import EXIT_CODES

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
    if not {"-h", "--help"} & set(namespace.arguments):
        os.execv(sys.executable, command)
    code = subprocess.run(command, check=False).returncode
    print(f"\n{EXIT_CODES}")
    return code
