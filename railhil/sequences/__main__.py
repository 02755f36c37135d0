"""The command line of ``railhil learn`` (``python -m railhil.sequences``), and the request that it makes."""

from __future__ import annotations

import argparse
import sys

from railhil.batch.nodes import kernel_of, one_by_one
from railhil.common.command_line import OneLineParser
from railhil.common.errors import OptionError
from railhil.common.exit_codes import run_guarded
from railhil.scenarios.options import add_option, add_options
from railhil.sequences.one import runner_of, sequence_batch_of, through_nodes
from railhil.sequences.plan import Plan, Request
from railhil.study.command import Command, add_folder_arguments, add_number, exit_codes


def arguments() -> argparse.ArgumentParser:
    """Command line of ``railhil learn``."""
    usual = Request()
    parser = OneLineParser(
        prog="railhil learn",
        examples=[
            "railhil learn yizhuang_stop --sequences 20 --out runs/learn",
            "railhil learn --verify runs/learn",
        ],
        description="Sequences of runs of a law that learns from run to run: how its errors become smaller.",
        epilog=exit_codes("workers or scheduler were lost too often"),
    )
    add_option(parser, "scenario", default=None, usual=usual.scenario)
    add_options(parser, "--set", "--fault")
    add_number(parser, Request, "runs", " of each sequence")
    add_number(parser, Request, "sequences", "; with --verify 1")
    add_option(parser, "--seed", default=None, usual=str(usual.seed))
    add_option(parser, "--controller", ", with a memory")
    add_option(parser, "--arithmetic", usual=usual.arithmetic)
    add_option(parser, "--indexing", default=None)
    add_option(parser, "--parameters")
    parser.add_argument("--nominal", action="store_true", help="draw nothing but the noise of the sensors")
    add_number(parser, Request, "chunk", usual="as suits the system")
    add_option(parser, "--jobs")
    add_folder_arguments(parser, "learn", with_report=True)
    return parser


def _check_engine(namespace: argparse.Namespace) -> None:
    if namespace.jobs is not None and namespace.scheduler is not None:
        raise OptionError("--scheduler", "cannot be given with --jobs")


def _engine(namespace: argparse.Namespace) -> tuple[str, int | None]:
    return "processes" if namespace.scheduler is None else "dask", namespace.jobs


def _how(plan: Plan) -> tuple[str, str | None]:
    if sequence_batch_of(plan.scenario) is not None:
        return one_by_one(plan.scenario), kernel_of(plan.scenario)
    if runner_of(plan.scenario) is not through_nodes:
        return "", None
    system = plan.scenario.system
    return f"system {system} has no runs without a bus, or not with its faults: the nodes make them all", None


COMMAND: Command[Plan] = Command(
    "railhil learn",
    "railhil.sequences.study:LEARN",
    Request,
    arguments,
    verified=("sequences", 1),
    only_run=("jobs", "scheduler"),
    check=_check_engine,
    engine=_engine,
    how=_how,
)


if __name__ == "__main__":
    sys.exit(run_guarded("railhil learn", COMMAND.main))
