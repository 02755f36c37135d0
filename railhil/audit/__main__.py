"""``python -m railhil.audit`` (the same as ``railhil audit``)."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from railhil.audit.document import document
from railhil.audit.result import Options, audit
from railhil.audit.tables import show
from railhil.batch import say_compiling
from railhil.batch.nodes import batch_of
from railhil.common.command_line import OneLineParser, run_command, whole_number
from railhil.common.exit_codes import FAIL, PASS, run_guarded
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.controller_node.arithmetic import names as arithmetics
from railhil.controller_node.laws import find
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario, require_perturbations
from railhil.scenarios.options import add_option, add_options
from railhil.scenarios.run_spec import LawSpec
from railhil.study.perturbed_runs import FIRST_SEED, how_made

_RUNS_MAX = 100_000
#: Default number of perturbed runs: with a batch, and through the nodes one after another.
_RUNS, _RUNS_NODES = 200, 20
_EXIT_CODES = """\
exit codes:
  0    all limits are met
  1    a limit is missed; the last table says which
  2    usage or bad input; one line says what was found and what is allowed
  4    TOOL ERROR: a defect of the audit"""


def arguments() -> argparse.ArgumentParser:
    """Command line of the audit."""
    parser = OneLineParser(
        prog="railhil audit",
        examples=[
            "railhil audit",
            "railhil audit yizhuang_05 --controller ipfc_plus --runs 50",
        ],
        description="Ranges, quantisation against float64, floor against rounding, effect on the scores, cycles.",
        epilog=_EXIT_CODES,
    )
    add_options(parser, "scenario", "--set")
    add_option(parser, "--controller")
    others = [name for name in arithmetics() if name != "float64"]
    add_option(parser, "--arithmetic", choices=others, default="iq", usual="iq")
    add_option(parser, "--indexing")
    add_option(parser, "--seed", ", of the run with the shadows")
    add_option(
        parser, "--runs", f", perturbed, for the effect on the scores, from seed {FIRST_SEED} on; 0: none",
        type=whole_number(0, _RUNS_MAX), usual=f"{_RUNS}, {_RUNS_NODES} in a system without a batch",
    )  # fmt: skip
    add_json_argument(parser)
    return parser


def _runs(namespace: argparse.Namespace, scenario: AnyScenario) -> int:
    """Number of perturbed runs; prints how they are made."""
    remark, kernel = how_made(scenario)
    runs: int = namespace.runs if namespace.runs is not None else _RUNS_NODES if batch_of(scenario) is None else _RUNS
    if runs:
        require_perturbations(scenario, "--runs")
        say = Output(stderr=True).say
        if remark:
            say(remark)
        say_compiling(say, kernel)
    return runs


def main(words: Sequence[str] | None = None) -> int:
    """Run the audit and print its result; exit code 1 if a limit is missed."""
    return run_command(arguments(), words, _work)


def _work(namespace: argparse.Namespace) -> int:
    scenario = load_any(namespace.scenario, namespace.set)
    system = scenario.installed_system
    system.refuse_whole_runs("audit", namespace.scenario)
    law = LawSpec(namespace.controller or scenario.usual_law, namespace.arithmetic, namespace.indexing)
    # An unknown law is refused here, before anything else is printed.
    find(law.controller, system.laws)
    options = Options(law, namespace.seed, _runs(namespace, scenario))
    result = audit(scenario, options)
    if namespace.json:
        print_json(document(result))
    else:
        show(Output(), result)
    return PASS if result.met else FAIL


if __name__ == "__main__":
    sys.exit(run_guarded("railhil audit", main))
