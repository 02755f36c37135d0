"""Hundreds of perturbed runs, for statistics of the scores."""

from __future__ import annotations

from dataclasses import dataclass

from railhil.batch.case import Case
from railhil.batch.nodes import batch_of, run_nodes
from railhil.controller_node.arithmetic.base import Counters
from railhil.judge.score import Score
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec

#: Seed of the first run; the others follow.
FIRST_SEED = 1000


@dataclass(frozen=True, slots=True)
class Outcomes:
    """Scores of perturbed runs in the order of their seeds, and total events in the law's arithmetic."""

    scores: list[Score]
    arithmetic: Counters


def outcomes(scenario: AnyScenario, runs: int, law: LawSpec) -> Outcomes:
    """Runs with the seeds from :data:`FIRST_SEED` on: the same draws for every law and arithmetic.

    A system without a batch goes through the nodes of the bench, run by run.
    """
    run = batch_of(scenario) or run_nodes
    found = run(Case(scenario, law), range(FIRST_SEED, FIRST_SEED + runs))
    sums = (int(counts.sum()) for counts in (found.wraps, found.saturations, found.zero_divisions))
    return Outcomes(list(found.scores), Counters(*sums))
