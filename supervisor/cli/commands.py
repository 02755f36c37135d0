"""The whole command line of ``railhil``: one module per subcommand, each with ``add_parser`` and what it does."""

from __future__ import annotations

import argparse
import sys
from importlib.metadata import version

from bus.usage import OneLineParser, parse
from dbc import wire_contract
from supervisor.cli import bus, compare, doctor, outside, plot, ports, report, run, scenarios, score
from supervisor.cli.output import accept_any_text, flush_output

_MODULES = (run, compare, score, report, plot, scenarios, ports, doctor, outside, bus)


def parser() -> argparse.ArgumentParser:
    """The whole command line."""
    root = OneLineParser(
        prog="railhil",
        description="Hardware-in-the-loop bench for train controllers: MVB telegrams on a CAN bus.",
    )
    root.add_argument("--version", action="version", version=f"railhil {version('railhil')}")
    commands = root.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for module in _MODULES:
        module.add_parser(commands)
    return root


def work() -> int:
    """Do what the command line asks for; returns the exit code."""
    accept_any_text()
    outside.become_program(sys.argv[1:])
    namespace = parse(parser())
    # A DBC that is not the one of the port table must be noticed by every command, also by those that never look at a
    # telegram.
    wire_contract()
    try:
        return int(namespace.work(namespace))
    finally:
        flush_output()
