"""``python -m bus.hub -c PATH``."""

from __future__ import annotations

import sys

from bus.exitcodes import guarded


def main() -> int:
    """Parse the command line and run the hub; modules are loaded here, so that Ctrl-C while they are ends as later."""
    from bus.hub.cli import add_arguments, run
    from bus.usage import OneLineParser

    parser = OneLineParser(prog="python -m bus.hub", description="software CAN switch")
    add_arguments(parser)
    return run(parser.parse_args())


if __name__ == "__main__":
    sys.exit(guarded("railhil hub", main))
