"""The command line of ``railhil campaign`` (``python -m railhil.campaign``), and the request that it makes."""

from __future__ import annotations

import argparse
import sys

from railhil.campaign.plan import Plan, Request
from railhil.common.command_line import OneLineParser, accept_former_name, name_list
from railhil.common.exit_codes import run_guarded
from railhil.scenarios.options import add_option, add_options
from railhil.study.command import Command, add_engine_arguments, add_folder_arguments, add_number, exit_codes
from railhil.study.perturbed_runs import how_made

_VERIFIED_RUNS = 3


def arguments() -> argparse.ArgumentParser:
    """Command line of the campaign."""
    usual = Request()
    parser = OneLineParser(
        prog="railhil campaign",
        examples=[
            "railhil campaign --laws ipfc,ipfc_plus --runs 200 --out runs/many",
            "railhil campaign --resume runs/many",
            "railhil campaign --verify runs/many --runs 3",
        ],
        description="Thousands of perturbed runs of one or several laws on the same seeds: statistics and worst runs.",
        epilog=exit_codes("workers or scheduler were lost too often, or the bench gave no valid run"),
    )
    add_option(parser, "scenario", default=None)
    add_options(parser, "--set")
    add_number(parser, Request, "runs", f" of each law; with --verify {_VERIFIED_RUNS} of all")
    add_number(parser, Request, "first_seed")
    accept_former_name(parser, "--first-seed", "--seed")
    add_option(parser, "--laws", type=name_list, usual="the one of the scenario's system")
    add_option(parser, "--arithmetic", usual=usual.arithmetic)
    add_option(parser, "--indexing", default=None)
    add_option(parser, "--parameters", "; may be given again, for another law", action="append")
    add_option(parser, "--both")
    add_option(parser, "--allow-training-seeds", "; every table then says so")
    add_engine_arguments(parser, "batch")
    add_number(parser, Request, "chunk")
    add_folder_arguments(parser, "campaign", with_report=False)
    return parser


COMMAND: Command[Plan] = Command(
    "railhil campaign",
    "railhil.campaign.study:CAMPAIGN",
    Request,
    arguments,
    verified=("runs", _VERIFIED_RUNS),
    how=lambda plan: how_made(plan.scenario, [entry.law for entry in plan.entries]),
    code="laws",
)


if __name__ == "__main__":
    sys.exit(run_guarded("railhil campaign", COMMAND.main))
