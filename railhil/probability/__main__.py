"""The command line of ``railhil probability`` (``python -m railhil.probability``)."""

from __future__ import annotations

import argparse
import sys

from railhil.common.command_line import OneLineParser, whole_number
from railhil.common.errors import InputError, Sentence
from railhil.common.exit_codes import run_guarded
from railhil.probability.plan import METHODS, Plan, Request, find_making
from railhil.scenarios.options import add_option, add_options
from railhil.study.command import Command, add_folder_arguments, add_number
from railhil.study.engines import ENGINES

_VERIFIED_RUNS = 3
_EXIT_CODES = """\
exit codes:
  0    the probability is known to the wanted accuracy; --verify: the bench gives the same margins
  1    --at-most lies below the interval; --verify: the bench gives other margins
  2    usage or bad input; one line says what was found and what is allowed
  3    not resolved: the accuracy is not met, or --at-most lies inside the interval; workers were lost too
       often; --verify: no run has violated the requirement, so nothing was compared
  4    TOOL ERROR: a defect, or the record could not be written (what is done is kept)
  130  stopped by Ctrl-C; 143 by SIGTERM, 129 by SIGHUP (what is done is kept, --resume continues)"""


def _share(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value <= 1:
        raise argparse.ArgumentTypeError(f"found {text}, allowed a probability, such as 1e-6")
    return value


def _accuracy(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value <= 10:
        raise argparse.ArgumentTypeError(f"found {text}, allowed a share of P above 0, such as 0.3")
    return value


def _runs(text: str) -> int:
    """A whole number, also as 1e6."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1000 <= value <= 1e8 or value != int(value):
        raise argparse.ArgumentTypeError(f"found {text}, allowed a whole number from 1000 to 1e8")
    return int(value)


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
        epilog=_EXIT_CODES,
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
    parser.add_argument("--engine", choices=ENGINES, default="processes", help="this process, cores, machines")
    add_option(parser, "--jobs")
    add_folder_arguments(parser, "probability", with_report=True)
    note = " that --verify makes again"
    add_option(parser, "--runs", note, type=whole_number(1, 10_000), default=None, usual=str(_VERIFIED_RUNS))
    return parser


def _check_engine(namespace: argparse.Namespace) -> None:
    if namespace.jobs is not None and namespace.engine != "processes":
        raise InputError("command line", "--jobs", namespace.jobs, Sentence("used only with --engine processes"))
    if namespace.scheduler is not None and namespace.engine != "dask":
        raise InputError("command line", "--scheduler", namespace.scheduler, Sentence("used only with --engine dask"))
    if namespace.runs is not None and namespace.verify is None:
        raise InputError("command line", "--runs", namespace.runs, Sentence("used only with --verify"))


COMMAND: Command[Plan] = Command(
    "railhil probability",
    "railhil.probability.study:PROBABILITY",
    Request,
    arguments,
    verified=("runs", _VERIFIED_RUNS),
    only_run=("json",),
    check=_check_engine,
    engine=lambda namespace: (namespace.engine, namespace.jobs),
    how=find_making,
)


if __name__ == "__main__":
    sys.exit(run_guarded("railhil probability", COMMAND.main))
