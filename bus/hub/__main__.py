"""``python -m bus.hub -c PATH``."""

from __future__ import annotations

import argparse
import sys

from bus.hub.cli import add_arguments, run


def main() -> int:
    """Parse the command line and run the hub."""
    parser = argparse.ArgumentParser(prog="python -m bus.hub", description="software CAN switch")
    add_arguments(parser)
    return run(parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
