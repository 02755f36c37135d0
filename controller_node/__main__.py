"""``python -m controller_node`` (the same as ``railhil node controller``): the train controller as one process."""

from __future__ import annotations

import argparse
import gc
import sys

from can.cli import add_bus_arguments

from bus.exitcodes import guarded
from bus.ident import ARITHMETICS
from bus.link import open_link
from bus.select import choose_bus
from bus.usage import OneLineParser, parse
from controller_node.laws import names
from controller_node.node import ControllerNode, ControllerOptions, run_controller
from scenarios.load import load


def arguments() -> argparse.ArgumentParser:
    """Command line of the controller node."""
    parser = OneLineParser(prog="railhil node controller", description="Train speed controller on the bus.")
    parser.add_argument("scenario", nargs="?", default="lvshun_tieshan", help="shipped name or TOML file")
    parser.add_argument("--controller", default="ipfc", help=f"control law: {', '.join(names())} (default ipfc)")
    parser.add_argument("--arithmetic", choices=sorted(ARITHMETICS[1:]), default="iq")
    parser.add_argument("--indexing", choices=("time", "distance"), default="time", help="set-point indexing")
    add_bus_arguments(parser)
    return parser


def main() -> int:
    """Serve one run; exit code 0 when it came to its end."""
    namespace = parse(arguments())
    scenario = load(namespace.scenario)
    choice = choose_bus(namespace)
    print(f"controller: {choice.transport} ({choice.reason})", file=sys.stderr)
    options = ControllerOptions(namespace.controller, namespace.arithmetic, namespace.indexing, choice.fd)
    node = ControllerNode(scenario, options)
    link = open_link(choice.config)
    gc.freeze()
    gc.disable()
    return run_controller(node, link)


if __name__ == "__main__":
    sys.exit(guarded("controller", main))
