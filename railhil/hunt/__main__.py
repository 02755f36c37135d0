"""The command line of ``railhil hunt`` (``python -m railhil.hunt``), and the request that it makes."""

from __future__ import annotations

import argparse
import re
import sys

from railhil.common.command_line import OneLineParser, name_list
from railhil.common.errors import OptionError
from railhil.common.exit_codes import run_guarded
from railhil.hunt.cases import STRATEGIES
from railhil.hunt.plan import DESCENT, RUNS_MAX, Plan, Request
from railhil.scenarios.options import OR_YOURS, add_option, add_options
from railhil.study.command import Command, add_engine_arguments, add_folder_arguments, add_number, exit_codes

_VERIFIED_RUNS = 3
_TIME = re.compile(r"(\d+(?:\.\d+)?)(s|min|h)", re.ASCII)
_UNITS_S = {"s": 1.0, "min": 60.0, "h": 3600.0}


def arguments() -> argparse.ArgumentParser:
    """Command line of the hunt."""
    parser = OneLineParser(
        prog="railhil hunt",
        examples=[
            "railhil hunt yizhuang_05 --requirements mine.toml --runs 200 --seed 7 --out runs/hunt",
            "railhil hunt --resume runs/hunt",
            "railhil hunt --verify runs/hunt --runs 3",
        ],
        description="Search for disturbances that violate a requirement, and shrink them to the least ones.",
        epilog=exit_codes(
            "more than half of the runs could not be judged, or workers were lost too often",
            "no violation was found (this is not absence)",
            "a requirement is violated",
            "a defect of the bench: an exception in a run is a finding of its own, or a least case is not repeated by "
            "its file",
        ),
    )
    add_option(parser, "scenario", default=None)
    add_options(parser, "--set")
    add_option(parser, "--requirements", default=None)
    note = " requirements the object of the search: ids, or their beginnings"
    add_option(parser, "--only", note, metavar="INV-4,...", type=name_list)
    add_option(parser, "--controller", OR_YOURS)
    add_option(parser, "--arithmetic")
    add_number(parser, Request, "runs", f" of the search; with --verify {_VERIFIED_RUNS} of all")
    parser.add_argument(
        "--time", type=_time_s, metavar="30min", help="end with the runs made in this time, h, min or s"
    )
    add_number(parser, Request, "seed")
    parser.add_argument(
        "--strategy", choices=(*STRATEGIES, DESCENT), help="how cases are made (default: auto, random ones in turn)"
    )
    note = "what is disturbed: faults, or levels, places and words of them, and draws (default: faults)"
    parser.add_argument("--what", type=name_list, metavar="sensors,adhesion,...", help=note)
    parser.add_argument("--all", action="store_true", help="shrink and keep every case that violates something")
    note = "state the tightest bound of each kept requirement that held in all runs, and write these sentences"
    parser.add_argument("--tighten", action="store_true", help=note)
    parser.add_argument("--no-shrink", action="store_true", help="keep the cases as they were found")
    add_engine_arguments(parser)
    add_folder_arguments(parser, "hunt", with_report=True)
    return parser


def _time_s(text: str) -> float:
    match = _TIME.fullmatch(text)
    if match is None or float(match[1]) <= 0:
        raise argparse.ArgumentTypeError(f"found {text}, allowed a time above 0, such as 90s, 30min or 2h")
    return float(match[1]) * _UNITS_S[match[2]]


def _check(namespace: argparse.Namespace) -> None:
    if namespace.time is not None:
        if namespace.shard is not None:
            raise OptionError("--time", "used only without --shard")
        if namespace.runs is None and namespace.resume is None and namespace.verify is None:
            # It ends by time.
            namespace.runs = RUNS_MAX


COMMAND: Command[Plan] = Command(
    "railhil hunt",
    "railhil.hunt.study:HUNT",
    Request,
    arguments,
    verified=("runs", _VERIFIED_RUNS),
    only_run=("json", "time"),
    check=_check,
    how=lambda plan: ("", None),
    code="controller",
    time_s=lambda namespace: namespace.time,
)


if __name__ == "__main__":
    sys.exit(run_guarded("railhil hunt", COMMAND.main))
