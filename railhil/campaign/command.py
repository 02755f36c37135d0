"""The command line of ``railhil campaign``, and the request that it makes."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import Any

from railhil.campaign.plan import ALL_LAWS, CHUNK_MAX, RUNS_MAX, Request
from railhil.common.command_line import SEED_MAX, OneLineParser, whole_number
from railhil.common.errors import InputError
from railhil.common.streams import add_json_argument
from railhil.controller_node.laws import names as laws
from railhil.record.signature import add_sign_argument
from railhil.scenarios.load import stable_name
from railhil.scenarios.options import add_option, add_options

ENGINES = ("batch", "joblib", "dask")
_EXIT_CODES = """\
exit codes:
  0    every run was made (whatever its verdict); --verify: the bench gives the same results
  1    --verify: the bench gives other results
  2    usage or bad input; one line says what was found and what is allowed
  3    workers or scheduler were lost too often, or the bench gave no valid run; what is done is kept
  4    TOOL ERROR: a defect of the campaign, or its record could not be written (what is done is kept)
  130  stopped by Ctrl-C; 143 by SIGTERM, 129 by SIGHUP (what is done is kept, --resume continues)"""
#: Options that define the campaign: None when not given, so that --resume takes them from the campaign.
_REQUEST = ("scenario", "runs", "first_seed", "laws", "arithmetic", "indexing", "parameters", "chunk")


def _law_list(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(","))


def arguments() -> argparse.ArgumentParser:
    """Command line of the campaign."""
    usual = Request()
    parser = OneLineParser(
        prog="railhil campaign",
        description="Thousands of perturbed runs of one or several laws on the same seeds: statistics and worst runs.",
        epilog=_EXIT_CODES,
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
    parser.add_argument("--engine", choices=ENGINES, default="batch", help="this process, cores, machines")
    add_option(parser, "--jobs", help="joblib: processes (default: one per core)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="dask: tcp://HOST:PORT of the scheduler")
    parser.add_argument(
        "--chunk", type=whole_number(1, CHUNK_MAX), metavar="N", help=f"runs per part (default {usual.chunk})"
    )
    parser.add_argument("--out", metavar="DIR", help="folder (default runs/<utc>-<scenario>-campaign); resumes there")
    parser.add_argument("--resume", metavar="DIR", help="resume the campaign of this folder")
    add_sign_argument(parser)
    add_json_argument(parser)
    parser.add_argument("--verify", metavar="DIR", help="run some runs of a finished campaign again on the bench")
    parser.add_argument(
        "--draw", type=whole_number(0, SEED_MAX), default=0, metavar="N", help="--verify: which runs (default 0)"
    )
    return parser


def check_combination(namespace: argparse.Namespace) -> None:
    """Refuse options that do not go together. Raises InputError."""
    given = [name for name in _REQUEST if getattr(namespace, name) is not None]
    given += [name for name in ("set", "both", "allow_training_seeds") if getattr(namespace, name)]
    if namespace.verify is not None:
        others = [name for name in (*given, "out", "resume") if getattr(namespace, name, None) is not None]
        others += ["json"] * namespace.json
        if extra := [name for name in others if name != "runs"]:
            raise InputError("command line", "--verify", _option(extra[0]), "beside it only --runs and --draw")
    if namespace.resume is not None and namespace.out is not None:
        raise InputError("command line", "--out", namespace.out, "one of --out and --resume")
    if namespace.jobs is not None and namespace.engine != "joblib":
        raise InputError("command line", "--jobs", namespace.jobs, "only with --engine joblib")
    if namespace.scheduler is not None and namespace.engine != "dask":
        raise InputError("command line", "--scheduler", namespace.scheduler, "only with --engine dask")


def _option(name: str) -> str:
    return name if name == "scenario" else f"--{name.replace('_', '-')}"


def request_from(namespace: argparse.Namespace, begun: Request) -> Request:
    """The request: options from the command line, all others from ``begun`` (an existing campaign, or the defaults)."""
    said: dict[str, Any] = {name: getattr(namespace, name) for name in _REQUEST if getattr(namespace, name) is not None}
    if "scenario" in said:
        said["scenario"] = stable_name(said["scenario"])
    if namespace.set:
        said["settings"] = tuple(namespace.set)
    if "parameters" in said:
        said["parameters"] = tuple(str(path.resolve()) for path in said["parameters"])
    return replace(
        begun,
        **said,
        both=begun.both or namespace.both,
        allow_training_seeds=begun.allow_training_seeds or namespace.allow_training_seeds,
    )
