"""Compares default and tuned parameters on runs not used in the search."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from rich.table import Table

from railhil.batch import Batch, Case
from railhil.batch.statistics import quantile
from railhil.common.output import Output, number, table, whole
from railhil.judge.criteria import DID_NOT_STOP, Criterion, limited
from railhil.judge.judging import judging_of
from railhil.scenarios.model import watch_sentence
from railhil.scenarios.parameters import ParameterSet
from railhil.study.perturbed_runs import check_unseen, run_seeds, training_seeds
from railhil.tuning.objective import Scale, objective

_QUANTILES = (("median", 0.5), ("p95", 0.95))


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Runs of one law with its own parameters and with the parameters of a file, on the same seeds.

    ``seen``: seeds among them on which the file's parameters were tuned.
    """

    case: Case
    given: ParameterSet
    seen: tuple[int, ...]
    default: Batch
    tuned: Batch


def evaluate(case: Case, given: ParameterSet, seeds: range, allow_training_seeds: bool = False) -> Evaluation:
    """Run both.

    :param case: the parameters of its law are ignored.
    :raises InputError: the parameters are not the law's, or were tuned on one of the seeds.
    """
    laws = [replace(case.law, parameters=each) for each in (None, given)]
    # As on the bench: it refuses an indexing that the system does not have.
    case.scenario.installed_system.part("controller")(case.scenario, laws[0])
    if not allow_training_seeds:
        check_unseen(case.scenario, laws[1], seeds)
    default, tuned = (run_seeds(case.scenario, law, seeds) for law in laws)
    return Evaluation(case, given, tuple(training_seeds(case.scenario, laws[1], seeds)), default, tuned)


def quantiles(result: Batch, criterion: Criterion) -> list[float]:
    """Median and 95th percentile, from the best run to the worst; one that did not stop is infinitely bad in stop and
    time error."""
    worse = criterion.badness(np.asarray(result.values[criterion.key], dtype=np.float64))
    ordered = np.sort(np.where(np.isnan(worse), np.inf, worse))
    found = criterion.badness(np.array([quantile(ordered, share) for _, share in _QUANTILES]))
    return [float(value) for value in found]


def _criteria(found: Evaluation) -> list[Criterion]:
    """The criteria that runs of the scenario have."""
    scenario = found.case.scenario
    return [criterion for criterion in judging_of(scenario).criteria if criterion.applies(scenario)]


def _digits(criterion: Criterion) -> int:
    return criterion.digits if criterion.tuning_digits is None else criterion.tuning_digits


def better(found: Evaluation, scale: Scale) -> bool:
    """Whether the objective of the search is smaller with the tuned parameters on these runs."""
    return objective(scale, found.tuned.scores) < objective(scale, found.default.scores)


def worse(found: Evaluation, scale: Scale) -> list[str]:
    """The respects in which the tuned parameters are worse than the law's own; empty if they are kept.

    They are discarded if the objective of the search is larger on these runs, if fewer runs pass, or if the median of
    an error with a limit has increased and exceeds the limit.
    """
    before, after = (objective(scale, result.scores) for result in (found.default, found.tuned))
    said = [f"objective {before:.3f} -> {after:.3f}"] if after > before else []
    passes = [int(result.passed.sum()) for result in (found.default, found.tuned)]
    said += [f"PASS {passes[0]} -> {passes[1]}"] if passes[1] < passes[0] else []
    for criterion in (term.criterion for term in scale.limits):
        own, tuned = (np.array(quantiles(result, criterion)[:1]) for result in (found.default, found.tuned))
        grown = criterion.badness(tuned) > criterion.badness(own)
        if (grown & ~criterion.inside(found.case.scenario, tuned)).any():
            digits = _digits(criterion)
            change = f"{own[0]:.{digits}f} -> {tuned[0]:.{digits}f} {criterion.unit}"
            said.append(f"median {criterion.title} {change}")
    return said


def _title(found: Evaluation) -> str:
    case, seeds = found.case, found.tuned.seed
    title = (
        f"{case.law.controller} on {case.scenario.name}, {len(seeds)} perturbed runs, seeds {seeds[0]} to {seeds[-1]}, "
        f"{case.law.said}"
    )
    if found.seen:
        title += f"\nTHESE ARE TRAINING RUNS: {len(found.seen)} of the seeds were used to make the parameters"
    return title


def _cells(found: Evaluation) -> Table:
    heads = [f"{who}\n{name}" for who in ("default", "tuned") for name, _ in _QUANTILES]
    made = table(whole("score"), whole("unit"), *map(number, heads))
    for criterion in _criteria(found):
        values = [*quantiles(found.default, criterion), *quantiles(found.tuned, criterion)]
        none = "no stop" if criterion.without == DID_NOT_STOP else criterion.without
        cells = (criterion.shown(value, _digits(criterion)) if np.isfinite(value) else none for value in values)
        made.add_row(criterion.title, criterion.unit, *cells)
    return made


def _counts(found: Evaluation, result: Batch) -> dict[str, tuple[str, int]]:
    """Numbers of runs: by their keys in documents, the words for a line and the number."""
    counts = {"passed": ("PASS", int(result.passed.sum()))}
    stops = [
        np.isfinite(result.values[criterion.key])
        for criterion in limited(judging_of(found.case.scenario).criteria, found.case.scenario)
        if criterion.without == DID_NOT_STOP
    ]
    if stops:
        counts["stopped"] = ("stopped", int(np.logical_and.reduce(stops).sum()))
    for extra in judging_of(found.case.scenario).extras:
        counts[extra.counted] = (extra.name, int((result.extras[extra.key] > 0).sum()))
    return counts


def _counts_said(found: Evaluation, result: Batch) -> str:
    (_, passed), *others = _counts(found, result).values()
    return ", ".join([f"PASS {passed} of {len(result.seed)}", *(f"{words} {count}" for words, count in others)])


def document(found: Evaluation) -> dict[str, Any]:
    """The comparison as JSON; a quantile of runs that did not stop is the text ``inf``."""

    def of(result: Batch) -> dict[str, Any]:
        scores = {
            criterion.key: {
                key: value if np.isfinite(value) else str(value)
                for (key, _), value in zip(_QUANTILES, quantiles(result, criterion), strict=True)
            }
            for criterion in _criteria(found)
        }
        return {"scores": scores, **{key: count for key, (_, count) in _counts(found, result).items()}}

    case, seeds = found.case, found.tuned.seed
    return {
        "law": case.law.controller,
        "scenario": case.scenario.name,
        "scenario_sha256": case.scenario.sha256,
        "parameters_sha256": found.given.sha256,
        **case.law.how,
        "runs": len(seeds),
        "first_seed": int(seeds[0]),
        "training_seeds": list(found.seen),
        "watch_weakened": case.scenario.watch_weakened,
        "default": of(found.default),
        "tuned": of(found.tuned),
    }


def show(console: Output, found: Evaluation) -> None:
    """Print the comparison."""
    console.say(_title(found), style="bold red" if found.seen else "bold")
    console.print(_cells(found))
    if sentence := watch_sentence(found.case.scenario):
        console.say(sentence, style="bold yellow")
    console.say(f"default: {_counts_said(found, found.default)}")
    console.say(f"tuned:   {_counts_said(found, found.tuned)}")
