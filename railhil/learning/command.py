"""The command line of ``railhil train-model``."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable

from railhil.common.command_line import SEED_MAX, OneLineParser, whole_number
from railhil.common.streams import add_json_argument
from railhil.controller_node.high_speed.network import HIDDEN_MAX

#: Kind on the command line -> law that uses the networks.
LAWS = {"elm": "elm_ngpc", "bp": "bp_ngpc", "os_elm": "os_elm_ngpc"}
_RIDGE_MAX = 1e9
_PERIOD_MAX_S = 10.0
_EXIT_CODES = """\
exit codes:
  0    the file was written
  2    usage or bad input; one line says what was found and what is allowed
  4    TOOL ERROR: a defect of the training
  130  stopped by Ctrl-C, 143 by SIGTERM (nothing is written)"""


def _number(highest: float) -> Callable[[str], float]:
    """An option's type: a number above 0."""

    def number(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not 0.0 < value <= highest:
            raise argparse.ArgumentTypeError(f"found {text}, allowed a number above 0 and up to {highest:g}")
        return value

    return number


def arguments() -> argparse.ArgumentParser:
    """Command line of the training."""
    parser = OneLineParser(
        prog="railhil train-model",
        description="Train the network of a law for high-speed trains on a recorded run; the file is for --parameters.",
        epilog=_EXIT_CODES,
    )
    parser.add_argument("record", metavar="RUN", help="run folder, or its frames.log; of a run with dither")
    parser.add_argument("--kind", choices=tuple(LAWS), default="elm", help="kind of network (default elm)")
    parser.add_argument(
        "--hidden", type=whole_number(1, HIDDEN_MAX), default=20, metavar="L", help="hidden nodes (default 20)"
    )
    solver = parser.add_mutually_exclusive_group()
    solver.add_argument(
        "--ridge",
        type=_number(_RIDGE_MAX),
        default=10.0,
        metavar="X",
        help="weight of the squared output weights in the least squares of an ELM (default 10)",
    )
    solver.add_argument(
        "--pinv", action="store_true", help="no ridge: the pseudo-inverse, which fits better and controls worse"
    )
    parser.add_argument(
        "--seed", type=whole_number(0, SEED_MAX), default=1, metavar="N", help="seed of the hidden layer (default 1)"
    )
    parser.add_argument(
        "--period",
        type=_number(_PERIOD_MAX_S),
        default=1.0,
        metavar="S",
        help="sampling period T0 of the law that will use the network, in s (default 1)",
    )
    parser.add_argument("--out", metavar="FILE", help="file to write (default <law>_<scenario>.toml)")
    add_json_argument(parser)
    return parser
