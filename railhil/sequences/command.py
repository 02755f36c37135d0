"""The command line of ``railhil learn``, and the request that it makes."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import Any

from railhil.common.choices import USUAL_SCENARIO
from railhil.common.command_line import SEED_MAX, OneLineParser, whole_number
from railhil.common.errors import InputError
from railhil.common.streams import add_json_argument
from railhil.record.signature import add_sign_argument
from railhil.scenarios.load import stable_name
from railhil.scenarios.options import add_option, add_options
from railhil.sequences.plan import CHUNK_MAX, RUNS_MAX, SEQUENCES_MAX, Request

_EXIT_CODES = """\
exit codes:
  0    every run was made (whatever its verdict); --verify: the bench gives the same results
  1    --verify: the bench gives other results
  2    usage or bad input; one line says what was found and what is allowed
  3    workers or scheduler were lost too often; what is done is kept
  4    TOOL ERROR: a defect, or the record could not be written (what is done is kept)
  130  stopped by Ctrl-C; 143 by SIGTERM, 129 by SIGHUP (what is done is kept, --resume continues)"""
#: Options that define the work: None when not given, so that --resume takes them from the folder.
_REQUEST = ("scenario", "runs", "sequences", "seed", "controller", "arithmetic", "indexing", "parameters", "chunk")


def arguments() -> argparse.ArgumentParser:
    """Command line of ``railhil learn``."""
    usual = Request()
    parser = OneLineParser(
        prog="railhil learn",
        description="Sequences of runs of a law that learns from run to run: how its errors become smaller.",
        epilog=_EXIT_CODES,
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
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="workers of the dask scheduler at tcp://HOST:PORT instead"
    )
    parser.add_argument("--out", metavar="DIR", help="folder (default runs/<utc>-<scenario>-learn); resumes there")
    parser.add_argument("--resume", metavar="DIR", help="go on in this folder")
    add_option(parser, "--no-report")
    add_sign_argument(parser)
    add_json_argument(parser)
    parser.add_argument("--verify", metavar="DIR", help="run some sequences again through the nodes of the bench")
    parser.add_argument(
        "--draw", type=whole_number(0, SEED_MAX), default=0, metavar="N", help="--verify: which ones (default 0)"
    )
    return parser


def check_combination(namespace: argparse.Namespace) -> None:
    """Refuse options that do not go together. Raises InputError."""
    given = [name for name in _REQUEST if getattr(namespace, name) is not None]
    given += [name for name in ("set", "fault", "nominal") if getattr(namespace, name)]
    if namespace.verify is not None:
        others = [name for name in (*given, "out", "resume", "jobs", "scheduler") if getattr(namespace, name)]
        if extra := [name for name in others if name != "sequences"]:
            raise InputError("command line", "--verify", _option(extra[0]), "beside it only --sequences and --draw")
    for one, other in (("resume", "out"), ("jobs", "scheduler")):
        if getattr(namespace, one) is not None and getattr(namespace, other) is not None:
            raise InputError("command line", f"--{other}", getattr(namespace, other), f"one of --{one} and --{other}")


def _option(name: str) -> str:
    return name if name == "scenario" else f"--{name}"


def request_from(namespace: argparse.Namespace, begun: Request) -> Request:
    """The request: options from the command line, all others from ``begun`` (existing work, or the defaults)."""
    said: dict[str, Any] = {name: getattr(namespace, name) for name in _REQUEST if getattr(namespace, name) is not None}
    if "scenario" in said:
        said["scenario"] = stable_name(said["scenario"])
    if "parameters" in said:
        said["parameters"] = str(said["parameters"].resolve())
    if namespace.set:
        said["settings"] = tuple(namespace.set)
    if namespace.fault:
        said["faults"] = tuple(namespace.fault)
    return replace(begun, **said, nominal=begun.nominal or namespace.nominal)
