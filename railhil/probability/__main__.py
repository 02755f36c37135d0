"""The command line of ``railhil probability`` (``python -m railhil.probability``)."""

from __future__ import annotations

import argparse
import sys

from railhil.common.command_line import OneLineParser, number, whole_number
from railhil.common.errors import OptionError
from railhil.common.exit_codes import run_guarded
from railhil.probability.plan import METHODS, Plan, Request, find_making
from railhil.scenarios.options import add_option, add_options
from railhil.study.command import Command, add_engine_arguments, add_folder_arguments, add_number, exit_codes

_VERIFIED_RUNS = 3


_share = number(lambda value: 0 <= value <= 1, "a probability, such as 1e-6")
_accuracy = number(lambda value: 0 < value <= 10, "a share of P above 0, such as 0.3")
_many = number(lambda value: 1000 <= value <= 1e8 and value == int(value), "a whole number from 1000 to 1e8")


def _runs(text: str) -> int:
    """A whole number, also as 1e6."""
    return int(_many(text))


def arguments() -> argparse.ArgumentParser:
    """Command line of the probability."""
    usual = Request()
    parser = OneLineParser(
        prog="railhil probability",
        examples=[
            "railhil probability lvshun_tieshan --says 'at stopped abs(stop_error) <= 0.05 m'",
            "railhil probability --requirement ATO-1 --at-most 1e-6 --out runs/p",
            "railhil probability --resume runs/p",
            "railhil probability --verify runs/p --runs 3",
        ],
        description="The probability that a run with drawn perturbations violates a requirement, with its interval.",
        epilog=exit_codes(
            "not resolved: the accuracy is not met, or --at-most lies inside the interval (--verify: no run has\n"
            "       violated the requirement, so nothing was compared); workers were lost too often",
            "the probability is known to the wanted accuracy",
            "--at-most lies below the interval",
        ),
    )
    add_option(parser, "scenario", default=None)
    add_options(parser, "--set")
    add_option(parser, "--requirements", default=None)
    parser.add_argument("--requirement", metavar="ID", help="the requirement, by its id")
    parser.add_argument("--says", metavar="SENTENCE", help="a sentence instead")
    add_option(parser, "--controller")
    add_option(parser, "--arithmetic")
    add_option(parser, "--parameters")
    wanted = f"half the width of the interval as a share of P (default: {usual.accuracy})"
    parser.add_argument("--accuracy", type=_accuracy, metavar="A", help=wanted)
    most = f"no repetition that would exceed it, after the pilot and the first one (default: {usual.max_runs})"
    parser.add_argument("--max-runs", type=_runs, metavar="N", help=most)
    said = f"runs of each level of a repetition (default: {usual.points})"
    parser.add_argument("--points", type=whole_number(100, 100_000), metavar="N", help=said)
    parser.add_argument("--method", choices=METHODS, help="how it is found (default: auto, that with fewer runs)")
    parser.add_argument("--at-most", type=_share, metavar="P", help="exit code 1 if P is above it")
    add_number(parser, Request, "seed")
    add_engine_arguments(parser)
    add_folder_arguments(parser, "probability", with_report=True)
    note = " that --verify makes again"
    add_option(parser, "--runs", note, type=whole_number(1, 10_000), default=None, usual=str(_VERIFIED_RUNS))
    return parser


def _check_runs(namespace: argparse.Namespace) -> None:
    if namespace.runs is not None and namespace.verify is None:
        raise OptionError("--runs", "used only with --verify")


COMMAND: Command[Plan] = Command(
    "railhil probability",
    "railhil.probability.study:PROBABILITY",
    Request,
    arguments,
    verified=("runs", _VERIFIED_RUNS),
    check=_check_runs,
    how=find_making,
)


if __name__ == "__main__":
    sys.exit(run_guarded("railhil probability", COMMAND.main))
