"""``python -m railhil.tuning`` (the same as ``railhil tune``)."""

from __future__ import annotations

import argparse
import math
import signal
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from railhil.common.command_line import run_command
from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import PASS, run_guarded
from railhil.common.output import Output, show_progress
from railhil.common.streams import print_json
from railhil.common.user_files import check_writable, whole_file
from railhil.record.run_folder import refuse_unwritable
from railhil.scenarios.load import load
from railhil.scenarios.model import AnyScenario, require_perturbations
from railhil.scenarios.parameters import load_parameters
from railhil.scenarios.run_spec import LawSpec
from railhil.tuning.command import DEFAULT_SCENARIO, arguments, check_combination
from railhil.tuning.shipped import shipped

if TYPE_CHECKING:
    from railhil.tuning.evaluation import Evaluation
    from railhil.tuning.search import Found, Protocol

# Modules that run the bench are imported where they are used: help and list do not need the extra libraries.

#: Values closer than this are the same: a search reaches the law's own through a logarithm.
_SAME = 1e-9
_INTERRUPTED = 128 + signal.SIGINT


def _list(console: Output, as_json: bool) -> int:
    if as_json:
        print_json([{"law": one.law, "scenario": one.training_scenario, "file": str(one.source)} for one in shipped()])
        return PASS
    for given in shipped():
        console.say(f"{given.law}  {given.training_scenario}  {given.source}")
    return PASS


def _seeds(namespace: argparse.Namespace) -> range:
    return range(namespace.first_seed, namespace.first_seed + namespace.runs)


def _scenario(namespace: argparse.Namespace, otherwise: str = "") -> AnyScenario:
    scenario = load(namespace.scenario or otherwise or DEFAULT_SCENARIO, namespace.set)
    require_perturbations(scenario, "tune")
    return scenario


def _evaluate(namespace: argparse.Namespace, file: Path, console: Output) -> Evaluation:
    from railhil.batch import Case, say_compiling
    from railhil.batch.nodes import kernel_of
    from railhil.tuning.document import changes
    from railhil.tuning.evaluation import evaluate, show

    given = load_parameters(file)
    if namespace.law not in (None, given.law):
        raise InputError(file, "law", given.law, f"{namespace.law}, the law asked for")
    scenario = _scenario(namespace, given.training_scenario)
    for change in changes(given, scenario.system):
        console.say(f"note: {change}")
    case = Case(scenario, LawSpec(given.law, namespace.arithmetic, namespace.indexing))
    say_compiling(Output(stderr=True).say, kernel_of(scenario))
    found = evaluate(case, given, _seeds(namespace), namespace.allow_training_seeds)
    show(console, found)
    return found


def _tune(namespace: argparse.Namespace, console: Output) -> int:
    from railhil.batch import say_compiling
    from railhil.batch.nodes import kernel_of
    from railhil.tuning.document import document
    from railhil.tuning.search import Box, Protocol, search
    from railhil.tuning.trials import ARITHMETIC

    scenario = _scenario(namespace)
    protocol = Protocol(
        scenario,
        LawSpec(namespace.law, ARITHMETIC, namespace.indexing),
        namespace.seeds,
        namespace.budget,
        namespace.search_seed,
    )
    law = protocol.law.controller
    seen = sorted(set(protocol.seeds).intersection(_seeds(namespace)))
    if seen and not namespace.allow_training_seeds:
        raise InputError(
            "command line",
            "--first-seed, --runs",
            Words(f"seed {seen[0]}, which is a training seed"),
            "other seeds for the evaluation, or --allow-training-seeds, which its table then says",
        )
    file = Path(namespace.out or f"{law}_{scenario.name}.toml")
    # Check before the work, not after it.
    with refuse_unwritable("--out", file, "file"):
        check_writable(file)
    say_compiling(Output(stderr=True).say, kernel_of(scenario))
    with show_progress(Console(stderr=True), "search", protocol.generations * protocol.population) as shown:
        found = search(protocol, lambda evaluations, best: shown(evaluations, f"objective {best:.4f}"))
    _write(file, document(protocol, found))
    own = found.objective_default
    console.say(
        f"{law} on {scenario.name}: objective {found.objective:.4f} on the training runs, "
        f"{'no law' if math.isinf(own) else f'{own:.4f}'} with the law's own parameters; {found.evaluations} "
        f"candidates, {found.infeasible} of them no law"
    )
    edges = Box.of(law).at_bounds(found.values)
    if edges:
        console.say(f"at a bound, where a wider one might give more: {', '.join(edges)}")
    console.say(f"written: {file}")
    result: dict[str, Any] = {
        "law": law,
        "scenario": scenario.name,
        "file": str(file),
        **{key: getattr(found, key) for key in ("objective", "evaluations", "infeasible", "complete")},
        "objective_default": None if math.isinf(own) else own,
        "at_bounds": edges,
        "laid_aside": None,
        "evaluation": None,
    }
    if not found.complete:
        console.say("stopped before the budget was used up", style="bold yellow")
    elif namespace.runs and not math.isinf(own):
        judged = _evaluate(namespace, file, console)
        result["evaluation"] = _evaluation_document(judged)
        result["laid_aside"] = _keep_the_better(judged, protocol, found, file, console)
    if namespace.json:
        print_json(result)
    return PASS if found.complete else _INTERRUPTED


def _evaluation_document(judged: Evaluation) -> dict[str, Any]:
    from railhil.tuning.evaluation import document

    return document(judged)


def _write(file: Path, text: str) -> None:
    with refuse_unwritable("--out", file, "file"), whole_file(file) as draft:
        draft.write_text(text, encoding="utf-8")


def _keep_the_better(judged: Evaluation, protocol: Protocol, found: Found, file: Path, console: Output) -> str | None:
    """Print the last line: whether the tuned parameters are better on other runs; if not, the file gets the law's own.

    :returns: why the tuned ones were discarded, None if they were kept.
    """
    from railhil.tuning.document import document
    from railhil.tuning.evaluation import better, worse
    from railhil.tuning.search import Box

    runs = f"on the {count_of(len(judged.tuned.seed), 'run')} of the evaluation"
    box = Box.of(protocol.law.controller)
    own = dict(zip(box.names, box.default, strict=True))
    if all(math.isclose(found.values[name], own[name], rel_tol=_SAME) for name in own):
        console.say(f"no better set was found: {file} holds the law's own parameters", style="bold yellow")
        return None
    said = worse(judged, found.scale)
    if not said:
        how = "the better set" if better(judged, found.scale) else "as good as the law's own"
        console.say(f"the tuned parameters are {how} {runs}: kept in {file}", style="bold")
        return None
    kept = replace(found, values=own, objective=found.objective_default, laid_aside=", ".join(said))
    _write(file, document(protocol, kept))
    console.say(
        f"WORSE than the law's own parameters {runs} ({', '.join(said)}): {file} holds the law's own",
        style="bold yellow",
    )
    return ", ".join(said)


def main(words: Sequence[str] | None = None) -> int:
    """Search, evaluate or list."""
    return run_command(arguments(), words, _work)


def _work(namespace: argparse.Namespace) -> int:
    check_combination(namespace)
    console = Output(stderr=namespace.json)
    if namespace.list:
        return _list(console, namespace.json)
    if namespace.evaluate is not None:
        judged = _evaluate(namespace, Path(namespace.evaluate), console)
        if namespace.json:
            print_json(_evaluation_document(judged))
        return PASS
    return _tune(namespace, console)


if __name__ == "__main__":
    sys.exit(run_guarded("railhil tune", main))
