"""The command line of ``railhil tune``."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, fields

from railhil.common.command_line import (
    SEED_MAX,
    USUAL_SCENARIO,
    OneLineParser,
    accept_former_name,
    seed_list,
    whole_number,
)
from railhil.common.errors import InputError, OptionError, Words
from railhil.common.streams import add_json_argument
from railhil.controller_node.laws import names as laws
from railhil.scenarios.options import add_option

#: Evaluations of a search, at least two generations of the smallest population.
_BUDGET_MIN, _BUDGET_MAX = 10, 1_000_000
_SEEDS_MAX = 10_000
DEFAULT_SCENARIO = USUAL_SCENARIO
_EXIT_CODES = """\
exit codes:
  0    the search or the evaluation was made, whatever it found
  2    usage or bad input; one line says what was found and what is allowed
  4    TOOL ERROR: a defect of the search, or the disk is full
  130  stopped by Ctrl-C: the best parameters so far are written, and the file says so; 143 by SIGTERM (nothing is)"""


@dataclass(frozen=True, slots=True)
class Request:
    """What the command line asks for, named as its options. ``law``, ``scenario``, ``out``: None where not given."""

    law: str | None
    scenario: str | None
    set: list[str]
    out: str | None
    budget: int
    seeds: tuple[int, ...]
    search_seed: int
    indexing: str
    runs: int
    first_seed: int
    arithmetic: str
    allow_training_seeds: bool

    @classmethod
    def of(cls, namespace: argparse.Namespace) -> Request:
        """The request of a parsed command line."""
        return cls(**{item.name: getattr(namespace, item.name) for item in fields(cls)})

    @property
    def evaluation_seeds(self) -> range:
        """Seeds of the runs of the evaluation."""
        return range(self.first_seed, self.first_seed + self.runs)


def _training_seeds(text: str) -> tuple[int, ...]:
    """An option's type: in order and each once."""
    return tuple(sorted(set(seed_list(text, _SEEDS_MAX))))


def arguments() -> argparse.ArgumentParser:
    """Command line of the search."""
    parser = OneLineParser(
        prog="railhil tune",
        examples=[
            "railhil tune ipfc yizhuang_05 --budget 200 --out tuned.toml",
            "railhil tune --evaluate tuned.toml --runs 200",
            "railhil tune --list",
        ],
        description="Tune the parameters of a law on training runs, then compare them with its own on other runs.",
        epilog=_EXIT_CODES,
    )
    add_option(parser, "law", nargs="?")
    add_option(parser, "scenario", default=None)
    add_option(parser, "--set")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--evaluate", metavar="FILE", help="no search: compare this file with the law's own parameters")
    add_option(what, "--list", " shipped parameter files and their paths, no search")
    add_option(parser, "--out FILE", ", with parameters", usual="<law>_<scenario>.toml")
    parser.add_argument(
        "--budget",
        type=whole_number(_BUDGET_MIN, _BUDGET_MAX),
        default=800,
        metavar="N",
        help="candidates to judge, each on all training runs (default: 800)",
    )
    add_option(parser, "--seeds", " of the training", type=_training_seeds, default=_training_seeds("0-7"), usual="0-7")
    parser.add_argument(
        "--search-seed", type=whole_number(0, SEED_MAX), default=0, metavar="N", help="seed of the search (default: 0)"
    )
    add_option(parser, "--indexing")
    add_option(parser, "--runs", " of the evaluation; 0: none", default=200, usual="200")
    add_option(parser, "--seed", ", of the evaluation", dest="first_seed", default=1000, usual="1000")
    accept_former_name(parser, "--first-seed", "--seed")
    add_option(parser, "--arithmetic", ", in the evaluation", default="float64", usual="float64")
    add_option(parser, "--allow-training-seeds", "; every table then says so")
    add_json_argument(parser)
    return parser


def check_combination(namespace: argparse.Namespace) -> None:
    """Refuse options that do not go together. Raises InputError."""
    if namespace.first_seed + namespace.runs - 1 > SEED_MAX:
        raise InputError("command line", "--seed, --runs", namespace.first_seed, f"a last seed of at most {SEED_MAX}")
    if namespace.list and namespace.law is not None:
        raise OptionError("--list", "cannot be given with a law")
    if namespace.evaluate is not None:
        if namespace.out is not None:
            raise OptionError("--out", "cannot be given with --evaluate")
        if namespace.runs == 0:
            raise InputError("command line", "--runs", namespace.runs, "at least 1 beside --evaluate")
    elif namespace.law is None and not namespace.list:
        raise InputError("command line", "LAW", Words(), f"one of {', '.join(laws())}, --evaluate FILE or --list")
