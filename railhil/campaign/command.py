"""The command line of ``railhil campaign``, and the request that it makes."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.campaign.plan import ALL_LAWS, CHUNK_MAX, RUNS_MAX, Chunk, Plan, Request
from railhil.common.command_line import SEED_MAX, OneLineParser, whole_number
from railhil.common.errors import InputError
from railhil.common.extras import need
from railhil.common.output import Output
from railhil.controller_node.laws import names as laws
from railhil.scenarios.options import add_option, add_options
from railhil.study.command import Command, add_folder_arguments, check_options, exit_codes
from railhil.study.perturbed_runs import how_made
from railhil.study.plan import Study

if TYPE_CHECKING:
    from railhil.study.execute import Outcome
    from railhil.study.finished import Verified

_ENGINES = ("batch", "joblib", "dask")
_VERIFIED_RUNS = 3


def _law_list(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(","))


def arguments() -> argparse.ArgumentParser:
    """Command line of the campaign."""
    usual = Request()
    parser = OneLineParser(
        prog="railhil campaign",
        description="Thousands of perturbed runs of one or several laws on the same seeds: statistics and worst runs.",
        epilog=exit_codes("workers or scheduler were lost too often, or the bench gave no valid run"),
    )
    add_option(parser, "scenario", default=None, help=f"shipped name or TOML file (default {usual.scenario})")
    add_options(parser, "--set")
    parser.add_argument(
        "--runs",
        type=whole_number(1, RUNS_MAX),
        metavar="N",
        help=f"runs of each law (default {usual.runs}); --verify: 3",
    )
    parser.add_argument(
        "--first-seed",
        type=whole_number(0, SEED_MAX),
        metavar="N",
        help=f"seeds from here on (default {usual.first_seed})",
    )
    parser.add_argument(
        "--laws", type=_law_list, metavar="A,B,...", help=f"{ALL_LAWS}, or some of {', '.join(laws())} (default ipfc)"
    )
    add_option(parser, "--arithmetic", help=f"(default {usual.arithmetic})")
    add_option(parser, "--indexing", default=None)
    add_option(parser, "--parameters", action="append", help="parameters of one law; may be given again")
    add_option(parser, "--both")
    said = "also seeds on which parameters were tuned or chosen; every table then says so"
    add_option(parser, "--allow-training-seeds", help=said)
    parser.add_argument("--engine", choices=_ENGINES, default="batch", help="this process, cores, machines")
    add_option(parser, "--jobs", help="joblib: processes (default: one per core)")
    parser.add_argument(
        "--chunk", type=whole_number(1, CHUNK_MAX), metavar="N", help=f"runs per part (default {usual.chunk})"
    )
    add_folder_arguments(parser, "campaign", "runs of a finished campaign", with_report=False)
    return parser


def check_combination(namespace: argparse.Namespace) -> None:
    """Refuse options that do not go together. Raises InputError."""
    check_options(Request, namespace, "runs", ("json",))
    if namespace.jobs is not None and namespace.engine != "joblib":
        raise InputError("command line", "--jobs", namespace.jobs, "only with --engine joblib")
    if namespace.scheduler is not None and namespace.engine != "dask":
        raise InputError("command line", "--scheduler", namespace.scheduler, "only with --engine dask")


def _verify(namespace: argparse.Namespace, plan: Plan) -> Iterator[Verified]:
    need("numba", "campaign")
    from railhil.campaign.verify import verify

    return verify(plan, Path(namespace.verify), namespace.runs or _VERIFIED_RUNS, namespace.draw)


def _show(console: Output, plan: Plan, made: Outcome, line: str) -> None:
    from railhil.campaign.show import show

    show(console, made.summary, made.folder, plan.judging)


def _study() -> Study[Plan, Chunk]:
    from railhil.campaign.study import CAMPAIGN

    return CAMPAIGN


COMMAND = Command(
    "railhil campaign",
    _study,
    arguments,
    check_combination,
    engine=lambda namespace: (namespace.engine, namespace.jobs or -1),
    how=lambda plan: how_made(plan.scenario),
    verify=_verify,
    # `railhil report DIR` writes it.
    report=lambda namespace, plan, made: "",
    show=_show,
)
