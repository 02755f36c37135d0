"""The objective that the search minimises: one number from the scores of the training runs, the same formula for every
law of a system.

For each run it is a sum over the criteria of the system::

    value / limit        of each criterion with a limit of the scenario, at most ``TERM_MAX``
    value / median       of every other criterion

The medians are those of a reference law on the same runs (:class:`railhil.tuning.trials.Tuning`): a fixed scale on
which every score of a good law is about 1. A criterion whose median is not positive has no such scale and is left out.
A run without a value, such as that of a train that does not stop, costs ``TERM_MAX``. An extra that is not 0 adds
``EXTRA`` plus its weighted amount. The objective is the mean over the runs, so that every run matters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean, median

from railhil.common.errors import InputError, Words
from railhil.judge.criteria import Criterion, Extra, limited
from railhil.judge.judging import judging_of
from railhil.judge.score import Score
from railhil.scenarios.model import AnyScenario

#: Increased with every change of the formula; recorded in the files.
VERSION = 1
#: Largest term of a criterion with a limit, and the term of a run that has no value.
TERM_MAX = 100.0
#: Added for an extra that is not 0 (overspeed), in addition to its weighted amount.
EXTRA = 10.0


@dataclass(frozen=True, slots=True)
class Term:
    """One criterion of the sum, and its divisor in the unit of the criterion."""

    criterion: Criterion
    divisor: float

    def cost(self, value: float | None) -> float:
        """About 1 for a run that is as good as the divisor, less for a better one."""
        if value is None:
            return TERM_MAX
        if self.criterion.better == "low":
            cost = value / self.divisor
        else:
            cost = self.divisor / value if value > 0 else TERM_MAX
        return cost if self.criterion.limit is None else min(cost, TERM_MAX)


@dataclass(frozen=True, slots=True)
class Scale:
    """The terms of the sum, in its order, and the extras; ``left_out``: the criteria without a scale."""

    terms: tuple[Term, ...]
    extras: tuple[Extra, ...]
    left_out: tuple[Criterion, ...] = ()

    @classmethod
    def of(cls, scenario: AnyScenario, reference: Sequence[Score], source: str = "tune") -> Scale:
        """Limits of the scenario, and medians of the reference law's runs.

        :param reference: none: only the criteria with a limit.
        :param source: named in the error.
        :raises InputError: no criterion of the system has a scale.
        """
        judging = judging_of(scenario)
        compared = [one for one in judging.criteria if one.limit is None and one.applies(scenario)]
        scaled = [(criterion, _median(criterion, reference)) for criterion in compared]
        scaled += [
            (criterion, criterion.limit_in(scenario) or 0.0) for criterion in limited(judging.criteria, scenario)
        ]
        terms = tuple(Term(criterion, divisor) for criterion, divisor in scaled if divisor > 0)
        if not terms:
            keys = ", ".join(criterion.key for criterion in judging.criteria) or "no criterion"
            allowed = "a criterion with a positive limit, or a positive median over the runs of the reference law"
            raise InputError(source, scenario.name, Words(keys), allowed)
        return cls(terms, judging.extras, tuple(criterion for criterion, divisor in scaled if not divisor > 0))

    @property
    def limits(self) -> list[Term]:
        """The terms whose divisors are limits of the scenario."""
        return [term for term in self.terms if term.criterion.limit is not None]

    @property
    def medians(self) -> list[Term]:
        """The terms whose divisors are medians of the reference law."""
        return [term for term in self.terms if term.criterion.limit is None]


def _median(criterion: Criterion, scores: Sequence[Score]) -> float:
    """Median over the runs that have a value; 0 if none has."""
    values = [value for score in scores if (value := score.values[criterion.key]) is not None]
    return median(values) if values else 0.0


def run_cost(scale: Scale, score: Score) -> float:
    """The sum above for one run."""
    cost = 0.0
    for term in scale.terms:
        cost += term.cost(score.values[term.criterion.key])
    for extra in scale.extras:
        if (amount := score.extras[extra.key]) > 0:
            cost += EXTRA + amount * extra.tuning_weight
    return cost


def objective(scale: Scale, scores: Sequence[Score]) -> float:
    """Mean of :func:`run_cost` over the runs."""
    return fmean(run_cost(scale, score) for score in scores)
