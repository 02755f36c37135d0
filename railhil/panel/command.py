"""The command line of ``railhil panel``."""

from __future__ import annotations

import argparse

from railhil.bus.can_settings import add_bus_arguments
from railhil.common.command_line import OneLineParser, whole_number
from railhil.scenarios.options import PANEL_PORT, PORT_MAX, add_option, add_options

_EXIT_CODES = """\
exit codes:
  0    the page was served until the end of what it shows
  2    usage or bad input; one line says what was found and what is allowed
  4    TOOL ERROR: a defect of the panel
  130  stopped by Ctrl-C, 143 by SIGTERM"""


def arguments() -> argparse.ArgumentParser:
    """Command line of the panel."""
    parser = OneLineParser(
        prog="railhil panel",
        examples=[
            "railhil panel runs/mine",
            "railhil panel runs",
            "railhil panel -i socketcan -c vcan0",
        ],
        description="A page in the browser, served on 127.0.0.1 only: the run on a bus, or recorded runs.",
        epilog=_EXIT_CODES,
    )
    parser.add_argument(
        "what",
        nargs="*",
        default=[],
        metavar="SCENARIO|RUN",
        help="scenario that runs on the bus, if it is no shipped one (default: as the plant tells), or run folders, or "
        "a directory of them",
    )
    parser.add_argument(
        "--port",
        type=whole_number(0, PORT_MAX),
        default=PANEL_PORT,
        metavar="N",
        help=f"TCP port of the page (default: {PANEL_PORT}, or a free one if that is taken; 0: any)",
    )
    add_option(parser, "--foxglove")
    add_option(parser, "--controller", ", whose notes are then named", usual="")
    parser.add_argument("--socket", metavar="PATH", help="listen at this Unix socket instead, for containers")
    parser.add_argument(
        "--public-port",
        type=whole_number(1, PORT_MAX),
        metavar="N",
        help="with --socket: port of 127.0.0.1 under which it is published",
    )
    add_option(parser, "--operator")
    parser.add_argument(
        "--follow",
        metavar="RUN",
        help="instead of a bus: the run that is being made in this folder, in lockstep without a hub",
    )
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    add_options(parser, "--set", "--fault", "--requirements")
    add_bus_arguments(parser)
    return parser
