"""``railhil``: one module per subcommand, each with ``add_parser`` and the function that does the work."""

from __future__ import annotations

import argparse
from importlib.metadata import version

from bus.exitcodes import guarded
from supervisor.cli import bus, doctor, node, plot, ports, run, scenarios, score

_MODULES = (run, score, plot, scenarios, ports, doctor, node, bus)


def parser() -> argparse.ArgumentParser:
    """The whole command line."""
    root = argparse.ArgumentParser(
        prog="railhil",
        description="Hardware-in-the-loop bench for train controllers: MVB telegrams on a CAN bus.",
        epilog="exit codes: 0 pass, 1 fail (limits missed), 2 usage or bad input, 3 invalid run, 4 defect of the bench",
    )
    root.add_argument("--version", action="version", version=f"railhil {version('railhil')}")
    commands = root.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for module in _MODULES:
        module.add_parser(commands)
    return root


def main() -> int:
    """Entry point of the ``railhil`` command."""

    def work() -> int:
        namespace = parser().parse_args()
        return int(namespace.work(namespace))

    return guarded("railhil", work)

