"""Perturbed runs of a law: made by the batch of its system or by the nodes, on seeds that its parameters have not
seen."""

from __future__ import annotations

from collections.abc import Sequence

from railhil.batch.case import Batch, Case
from railhil.batch.nodes import batch_of, kernel_of, one_by_one, run_nodes
from railhil.common.errors import InputError, Words
from railhil.judge.training_seeds import chosen_on
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import OTHER_SEEDS
from railhil.scenarios.run_spec import LawSpec
from railhil.study.plan import law_named

#: Default seed of the first run; the others follow.
FIRST_SEED = 1000


def run_seeds(scenario: AnyScenario, law: LawSpec, seeds: Sequence[int]) -> Batch:
    """A run with each seed: the same draws for every law and arithmetic.

    :raises InputError: the law cannot be made, or has failed.
    """
    made_by = run_nodes if law.given is not None else batch_of(scenario) or run_nodes
    result: Batch = made_by(Case(scenario, law), seeds)
    return result


def how_made(scenario: AnyScenario, laws: Sequence[LawSpec] = ()) -> tuple[str, str | None]:
    """A remark if the runs are made one by one, else empty; the module with the compiled loops, None without any.

    :param laws: that are run, where that is known.
    """
    if laws and all(law.given is not None for law in laws):
        return "code of a user goes through the nodes, one run after the other", None
    if batch_of(scenario) is None:
        return f"no batch of trains for system {scenario.system}: every run goes through the nodes, one by one", None
    return one_by_one(scenario), kernel_of(scenario)


def training_seeds(scenario: AnyScenario, law: LawSpec, seeds: range) -> list[int]:
    """The given seeds on which the law's parameters were tuned, or its own ones chosen.

    The law's own seeds count also with a parameter file, because parameters that it does not name keep the law's own
    values. A controller that is no law has none.
    """
    if law.given is not None:
        return []
    tuned = set() if law.parameters is None else set(law.parameters.find_seen(seeds))
    declared = law_named(law.controller, scenario.system).design_seeds
    return sorted(tuned.union(chosen_on(declared, scenario, seeds)))


def check_unseen(
    scenario: AnyScenario, law: LawSpec, seeds: range, option: str = "--seed", allowed: str = OTHER_SEEDS
) -> None:
    """Refuse to evaluate parameters on runs that were used to find them.

    :param option: that names the seeds; ``allowed``: what the user can do instead.
    :raises InputError: they were used.
    """
    if law.parameters is not None:
        law.parameters.check_unseen(seeds, allowed)
    if seen := training_seeds(scenario, law, seeds):
        origin = law_named(law.controller, scenario.system).parameters_origin
        found = Words(f"seed {seen[0]}, on which {law.controller}'s own parameters were chosen ({origin})")
        raise InputError("command line", option, found, allowed)
