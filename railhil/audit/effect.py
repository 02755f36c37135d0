"""Effect on the scores: medians over perturbed runs in the audited arithmetic and in float64, with the same draws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import median

from railhil.controller_node.arithmetic.base import Counters
from railhil.judge.criteria import Criterion
from railhil.judge.judging import judging_of
from railhil.judge.score import Score
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec
from railhil.study.perturbed_runs import FIRST_SEED, run_seeds

#: Allowed difference of a median from float64's, relative to float64's, if the criterion sets none.
_ALLOWED_SHARE = 0.01


@dataclass(frozen=True, slots=True)
class ScoreEffect:
    """Medians of one score over the runs that have it, and the largest difference of a single run (same draw).

    ``audited`` or ``reference`` is None if no run in that arithmetic has the score; ``missing`` counts the draws with
    the score in only one of the two arithmetics.
    """

    score: str
    unit: str
    audited: float | None
    reference: float | None
    allowed: float
    largest_single: float
    missing: int

    @property
    def difference(self) -> float | None:
        """Median of the audited arithmetic minus the median of float64."""
        return None if self.audited is None or self.reference is None else self.audited - self.reference

    @property
    def met(self) -> bool:
        """The medians differ by no more than allowed, and no draw has the score in only one arithmetic.

        A score that no run has proves nothing.
        """
        return not self.missing and self.difference is not None and abs(self.difference) <= self.allowed


@dataclass(frozen=True, slots=True)
class Effect:
    """Effect on each score, and the event counters of the audited arithmetic, summed over its runs."""

    scores: list[ScoreEffect]
    counters: Counters


def _effect(criterion: Criterion, audited: Sequence[Score], reference: Sequence[Score]) -> ScoreEffect:
    name, allowed = criterion.key, criterion.audit_allowed
    pairs = [(a.values[name], b.values[name]) for a, b in zip(audited, reference, strict=True)]
    ours, theirs = [a for a, _ in pairs if a is not None], [b for _, b in pairs if b is not None]
    wanted = median(theirs) if theirs else None
    return ScoreEffect(
        name,
        criterion.unit,
        median(ours) if ours else None,
        wanted,
        _ALLOWED_SHARE * abs(wanted or 0.0) if allowed is None else allowed,
        max((abs(a - b) for a, b in pairs if a is not None and b is not None), default=0.0),
        sum((a is None) != (b is None) for a, b in pairs),
    )


def effect(scenario: AnyScenario, runs: int, law: LawSpec) -> Effect:
    """Run ``runs`` draws in each of the two arithmetics and compare the scores that apply to the scenario."""
    seeds = range(FIRST_SEED, FIRST_SEED + runs)
    audited, reference = (run_seeds(scenario, each, seeds) for each in (law, replace(law, arithmetic="float64")))
    counters = Counters(*(int(one.sum()) for one in (audited.wraps, audited.saturations, audited.zero_divisions)))
    criteria = [criterion for criterion in judging_of(scenario).criteria if criterion.applies(scenario)]
    return Effect(compared(audited.scores, reference.scores, criteria), counters)


def compared(audited: Sequence[Score], reference: Sequence[Score], criteria: Sequence[Criterion]) -> list[ScoreEffect]:
    """Compare the scores of the same draws."""
    return [_effect(criterion, audited, reference) for criterion in criteria]
