"""``railhil bus hub``: the user-space CAN switch alone."""

from __future__ import annotations

import argparse

from railhil.bus.hub import cli as hub


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("bus")
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="KIND")
    hub_parser = kinds.add_parser("hub", help="software CAN switch (python-can interface 'railhil')")
    hub.add_arguments(hub_parser)
    hub_parser.set_defaults(work=hub.run)
