"""``python -m railhil.bus.hub -c PATH``."""

from __future__ import annotations

import sys

from railhil.common.exit_codes import run_guarded


def main() -> int:
    """Parse the command line and run the hub; modules are imported here, so that Ctrl-C during the import ends it in
    the same way as later."""
    from railhil.bus.hub.cli import add_arguments, work
    from railhil.common.command_line import OneLineParser

    parser = OneLineParser(prog="python -m railhil.bus.hub", description="software CAN switch")
    add_arguments(parser)
    return work(parser.parse_args())


if __name__ == "__main__":
    sys.exit(run_guarded("railhil hub", main))
