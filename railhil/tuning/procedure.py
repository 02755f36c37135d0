"""What ``railhil tune`` does with its options: search, file, evaluation on other runs, and the set that is kept."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

from rich.console import Console

from railhil.batch import Case, say_compiling
from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.output import Output, show_progress
from railhil.common.user_files import check_writable, refuse_unwritable, whole_file
from railhil.record.hash_list import check_free
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario, require_perturbations
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import names as systems
from railhil.scenarios.system import system_named
from railhil.study.perturbed_runs import how_made
from railhil.tuning import document, evaluation
from railhil.tuning.command import DEFAULT_SCENARIO, Request
from railhil.tuning.evaluation import Evaluation
from railhil.tuning.search import Found, Protocol, search
from railhil.tuning.trials import ARITHMETIC

#: Values closer than this are the same: a search reaches the law's own through a logarithm.
_SAME = 1e-9


def _scenario(request: Request, otherwise: str = "") -> AnyScenario:
    named = request.scenario or otherwise or DEFAULT_SCENARIO
    scenario = load_any(named, request.set)
    scenario.installed_system.refuse_whole_runs("tune", named)
    require_perturbations(scenario, "tune")
    return scenario


def _say_how_made(scenario: AnyScenario) -> None:
    remark, kernel = how_made(scenario)
    errors = Output(stderr=True)
    if remark:
        errors.say(remark)
    say_compiling(errors.say, kernel)


def _evaluate(request: Request, scenario: AnyScenario, given: ParameterSet, console: Output) -> Evaluation:
    case = Case(scenario, LawSpec(given.law, request.arithmetic, request.indexing))
    found = evaluation.evaluate(case, given, request.evaluation_seeds, request.allow_training_seeds)
    evaluation.show(console, found)
    return found


def evaluate_file(request: Request, file: Path, console: Output) -> dict[str, Any]:
    """Compare the parameters of a file with the law's own; returns the comparison as JSON."""
    given = load_parameters(file)
    if request.law not in (None, given.law):
        raise InputError(given.source, "law", given.law, f"{request.law}, the law asked for")
    scenario = _scenario(request, given.training_scenario)
    for change in document.changes(given, scenario.system):
        console.say(f"note: {change}")
    _say_how_made(scenario)
    return evaluation.document(_evaluate(request, scenario, given, console))


def _protocol(request: Request) -> Protocol:
    """The search that a command line asks for.

    :raises InputError: no such law, nothing to tune, or runs that cannot be an evaluation.
    """
    scenario, law = _scenario(request), request.law
    # Only an evaluation needs no law.
    assert law is not None
    if request.scenario is None and law not in scenario.installed_system.law_names():
        others = [name for name in systems() if law in system_named(name).law_names()]
        if others:
            allowed = f"a scenario of system {' or '.join(others)}, whose law {law} is"
            raise InputError("command line", "SCENARIO", None, allowed)
    protocol = Protocol(
        scenario, LawSpec(law, ARITHMETIC, request.indexing), request.seeds, request.budget, request.search_seed
    )
    seen = sorted(set(protocol.seeds).intersection(request.evaluation_seeds))
    if seen and not request.allow_training_seeds:
        raise InputError(
            "command line",
            "--seed, --runs",
            Words(f"seed {seen[0]}, which is a training seed"),
            "other seeds for the evaluation, or --allow-training-seeds, which its table then says",
        )
    return protocol


def tune(request: Request, console: Output) -> dict[str, Any]:
    """Search, write the file, and compare it with the law's own parameters on other runs; returns the result as JSON.

    ``complete`` in it is false after Ctrl-C.
    """
    protocol = _protocol(request)
    scenario, law, box = protocol.scenario, protocol.law.controller, protocol.box
    file = Path(request.out or f"{law}_{scenario.name}.toml")
    # Check before the work, not after it.
    check_free("--out", file)
    with refuse_unwritable("--out", file, "file"):
        check_writable(file)
    _say_how_made(scenario)
    with show_progress(Console(stderr=True), "search", protocol.generations * protocol.population) as shown:
        found = search(protocol, lambda evaluations, best: shown(evaluations, f"objective {best:.4f}"))
    _write(file, protocol, found)
    own = found.objective_default
    console.say(
        f"{law} on {scenario.name}: objective {found.objective:.4f} on the training runs, "
        f"{'no law' if math.isinf(own) else f'{own:.4f}'} with the law's own parameters; {found.evaluations} "
        f"candidates, {found.infeasible} of them no law"
    )
    if left_out := ", ".join(criterion.title for criterion in found.scale.left_out):
        console.say(f"not in the objective, as the runs of the reference law give no scale: {left_out}")
    edges = box.at_bounds(found.values)
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
    elif request.runs and not math.isinf(own):
        judged = _evaluate(request, scenario, load_parameters(file), console)
        result["evaluation"] = evaluation.document(judged)
        result["laid_aside"] = _keep_the_better(judged, protocol, found, file, console)
    return result


def _write(file: Path, protocol: Protocol, found: Found) -> None:
    with refuse_unwritable("--out", file, "file"), whole_file(file) as draft:
        draft.write_text(document.document(protocol, found), encoding="utf-8")


def _keep_the_better(judged: Evaluation, protocol: Protocol, found: Found, file: Path, console: Output) -> str | None:
    """Print the last line: whether the tuned parameters are better on other runs; if not, the file gets the law's own.

    :returns: why the tuned ones were discarded, None if they were kept.
    """
    runs = f"on the {count_of(len(judged.tuned.seed), 'run')} of the evaluation"
    box = protocol.box
    own = dict(zip(box.names, box.default, strict=True))
    if all(math.isclose(found.values[name], own[name], rel_tol=_SAME) for name in own):
        console.say(f"no better set was found: {file} holds the law's own parameters", style="bold yellow")
        return None
    said = evaluation.worse(judged, found.scale)
    if not said:
        how = "the better set" if evaluation.better(judged, found.scale) else "as good as the law's own"
        console.say(f"the tuned parameters are {how} {runs}: kept in {file}", style="bold")
        return None
    reason = ", ".join(said)
    _write(file, protocol, replace(found, values=own, objective=found.objective_default, laid_aside=reason))
    console.say(
        f"WORSE than the law's own parameters {runs} ({reason}): {file} holds the law's own", style="bold yellow"
    )
    return reason
