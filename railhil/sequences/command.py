"""The command line of ``railhil learn``, and the request that it makes."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.batch.nodes import kernel_of, one_by_one
from railhil.common.command_line import USUAL_SCENARIO, OneLineParser, whole_number
from railhil.common.errors import InputError
from railhil.common.extras import install_command
from railhil.common.output import Output
from railhil.scenarios.options import add_option, add_options
from railhil.sequences.one import runner_of, sequence_batch_of, through_nodes
from railhil.sequences.plan import CHUNK_MAX, RUNS_MAX, SEQUENCES_MAX, Chunk, Plan, Request
from railhil.study.command import Command, add_folder_arguments, check_options, exit_codes
from railhil.study.plan import Study

if TYPE_CHECKING:
    from railhil.study.execute import Outcome
    from railhil.study.finished import Verified


def arguments() -> argparse.ArgumentParser:
    """Command line of ``railhil learn``."""
    usual = Request()
    parser = OneLineParser(
        prog="railhil learn",
        description="Sequences of runs of a law that learns from run to run: how its errors become smaller.",
        epilog=exit_codes("workers or scheduler were lost too often"),
    )
    add_option(parser, "scenario", default=None, help=f"shipped name or TOML file (default {USUAL_SCENARIO})")
    add_options(parser, "--set", "--fault")
    parser.add_argument(
        "--runs", type=whole_number(1, RUNS_MAX), metavar="N", help=f"runs of each sequence (default {usual.runs})"
    )
    parser.add_argument(
        "--sequences",
        type=whole_number(1, SEQUENCES_MAX),
        metavar="N",
        help=f"sequences (default {usual.sequences}); --verify: 1",
    )
    said = f"of the first sequence (default {usual.seed})"
    add_option(parser, "--seed", default=None, metavar="N", help=said)
    add_option(parser, "--controller", help="a law with a memory (default: that of the system)")
    add_option(parser, "--arithmetic", help=f"(default {usual.arithmetic})")
    add_option(parser, "--indexing", default=None)
    add_option(parser, "--parameters")
    parser.add_argument("--nominal", action="store_true", help="draw nothing but the noise of the sensors")
    parser.add_argument(
        "--chunk",
        type=whole_number(1, CHUNK_MAX),
        metavar="N",
        help="sequences per part (default: as suits the system)",
    )
    add_option(parser, "--jobs")
    add_folder_arguments(parser, "learn", "sequences of a finished study", with_report=True)
    return parser


def check_combination(namespace: argparse.Namespace) -> None:
    """Refuse options that do not go together. Raises InputError."""
    check_options(Request, namespace, "sequences", ("jobs", "scheduler"))
    if namespace.jobs is not None and namespace.scheduler is not None:
        raise InputError("command line", "--scheduler", namespace.scheduler, "one of --jobs and --scheduler")


def _engine(namespace: argparse.Namespace) -> tuple[str, int]:
    jobs = namespace.jobs or os.cpu_count() or 1
    return "dask" if namespace.scheduler is not None else "batch" if jobs == 1 else "joblib", jobs


def _how(plan: Plan) -> tuple[str, str | None]:
    if sequence_batch_of(plan.scenario) is not None:
        return one_by_one(plan.scenario), kernel_of(plan.scenario)
    if runner_of(plan.scenario) is not through_nodes:
        return "", None
    system = plan.scenario.system
    return f"system {system} has no runs without a bus, or not with its faults: the nodes make them all", None


def _verify(namespace: argparse.Namespace, plan: Plan) -> Iterator[Verified]:
    from railhil.sequences.study import verify

    return verify(plan, Path(namespace.verify), namespace.sequences or 1, namespace.draw)


def _report(namespace: argparse.Namespace, plan: Plan, made: Outcome) -> str:
    if namespace.no_report:
        return ""
    try:
        from railhil.sequences.report import report_line
    except ImportError as error:
        return f"no report: {error.name} is not installed ({install_command('report')})"
    return report_line(plan, made.summary, made.table, made.folder)


def _show(console: Output, plan: Plan, made: Outcome, line: str) -> None:
    from railhil.sequences.show import show

    show(console, made.summary, made.folder, line)


def _study() -> Study[Plan, Chunk]:
    from railhil.sequences.study import LEARN

    return LEARN


COMMAND = Command("railhil learn", _study, arguments, check_combination, _engine, _how, _verify, _report, _show)
