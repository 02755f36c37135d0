"""``python -m railhil.learning`` (the same as ``railhil train-model``): its command line, training, the file."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from railhil.common.command_line import OneLineParser, number, run_command, whole_number
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import PASS, run_guarded
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.common.user_files import check_writable, refuse_unwritable, whole_file
from railhil.controller_node.high_speed.network import HIDDEN_MAX
from railhil.controller_node.high_speed.training import Recipe
from railhil.judge.record import checked_record
from railhil.learning.models import describe_training, render_file, train_models
from railhil.record.hash_list import check_free
from railhil.scenarios.options import add_option

#: Kind on the command line -> law that uses the networks.
_LAWS = {"elm": "elm_ngpc", "bp": "bp_ngpc", "os_elm": "os_elm_ngpc"}
_RIDGE_MAX = 1e9
_PERIOD_MAX_S = 10.0
_EXIT_CODES = """\
exit codes:
  0    the file was written
  2    usage or bad input; one line says what was found and what is allowed
  4    TOOL ERROR: a defect of the training, or the disk is full
  130  stopped by Ctrl-C, 143 by SIGTERM (nothing is written)"""


def _positive(highest: float) -> Callable[[str], float]:
    return number(lambda value: 0.0 < value <= highest, f"a number above 0 and up to {highest:g}")


def arguments() -> argparse.ArgumentParser:
    """Command line of the training."""
    parser = OneLineParser(
        prog="railhil train-model",
        examples=["railhil train-model runs/dither --kind elm --out network.toml"],
        description="Train the network of a law for high-speed trains on a recorded run; the file is for --parameters.",
        epilog=_EXIT_CODES,
    )
    add_option(parser, "log", ", of a run with dither")
    parser.add_argument("--kind", choices=tuple(_LAWS), default="elm", help="kind of network (default: elm)")
    parser.add_argument(
        "--hidden", type=whole_number(1, HIDDEN_MAX), default=20, metavar="L", help="hidden nodes (default: 20)"
    )
    solver = parser.add_mutually_exclusive_group()
    solver.add_argument(
        "--ridge",
        type=_positive(_RIDGE_MAX),
        default=10.0,
        metavar="X",
        help="weight of the squared output weights in the least squares of an ELM (default: 10)",
    )
    solver.add_argument(
        "--pinv", action="store_true", help="no ridge: the pseudo-inverse, which fits better and controls worse"
    )
    add_option(parser, "--seed", ", of the hidden layer", default=1, usual="1")
    parser.add_argument(
        "--period",
        type=_positive(_PERIOD_MAX_S),
        default=1.0,
        metavar="S",
        help="sampling period T0 of the law that will use the network, in s (default: 1)",
    )
    add_option(parser, "--out FILE", usual="<law>_<scenario>.toml")
    add_json_argument(parser)
    return parser


def main(words: Sequence[str] | None = None) -> int:
    """Train and write the file."""
    return run_command(arguments(), words, _work)


def _work(namespace: argparse.Namespace) -> int:
    console = Output(stderr=namespace.json)
    record = checked_record(namespace.log, None)
    if record.invalid:
        raise InputError(record.log, "verdict", Words(f"INVALID: {record.invalid}"), "a run that can be trusted")
    if not record.certificate:
        raise InputError(record.log, "certificate.json", Words("does not exist"), "a run that came to its end")
    law = _LAWS[namespace.kind]
    file = Path(namespace.out or f"{law}_{record.scenario.name}.toml")
    # Check before the work, not after it.
    check_free("--out", file)
    with refuse_unwritable("--out", file, "file"):
        check_writable(file)
    ridge = None if namespace.pinv else namespace.ridge
    recipe = Recipe("bp" if namespace.kind == "bp" else "elm", namespace.hidden, ridge, namespace.seed)
    models = train_models(record, recipe, namespace.period)
    notes = describe_training(record, recipe, namespace.period, models)
    with refuse_unwritable("--out", file, "file"), whole_file(file) as draft:
        draft.write_text(render_file(law, record, models, notes), encoding="utf-8")
    for period_s, error in models.errors.items():
        console.say(
            f"one step of {period_s:g} s: {error.linear_kmh:.4f} km/h by the linear model, "
            f"{error.integrated_kmh:.4f} km/h with the network"
        )
    console.say(f"written: {file}")
    if namespace.json:
        print_json({"law": law, "file": str(file), "networks": len(models.networks), **notes})
    return PASS


if __name__ == "__main__":
    sys.exit(run_guarded("railhil train-model", main))
