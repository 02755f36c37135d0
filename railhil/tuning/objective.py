"""The objective that the search minimises: one number from the scores of the training runs, the same formula for every
law.

For each run::

    stop error / its limit  +  time error / its limit  +  ITAE / I  +  energy / E  +  comfort / C

(each criterion of the system), with the limits of the scenario's plan, and I, E,
C the medians of IPFC with its published parameters on the same runs: a fixed scale on which every score of a good law
is about 1. A train that does not stop has the maximum stop and time terms (``TERM_MAX`` each); overspeed adds
``OVERSPEED`` plus its amount in km/h. The objective is the mean over the runs, so that every run matters.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, median

from railhil.judge.criteria import Criterion, limit_key, limited
from railhil.judge.score import Score
from railhil.systems.ato.judge import criteria
from railhil.systems.ato.judge.criteria import CRITERIA
from railhil.systems.ato.judge.measures import KMH
from railhil.systems.ato.scenario.model import Scenario

#: Increased with every change of the formula; recorded in the files.
VERSION = 1
#: Maximum term of a stop or time error, also used for a train that never stops.
TERM_MAX = 100.0
#: Added for a run with overspeed, in addition to the overspeed in km/h.
OVERSPEED = 10.0
#: Criteria without a limit: they are compared with the reference.
_UNLIMITED = tuple(criterion for criterion in CRITERIA if criterion.limit is None)


@dataclass(frozen=True, slots=True)
class Scale:
    """The divisors of the scores, in their units.

    ``limits``: those of the scenario, by the key of the limit; ``medians``: of the reference's runs, by criterion.
    """

    limits: Mapping[str, float]
    medians: Mapping[str, float]

    @classmethod
    def of(cls, scenario: Scenario, reference: Sequence[Score]) -> Scale:
        """Limits of the scenario, and medians of the reference law's runs."""
        return cls(
            {limit_key(criterion): criterion.limit.of(scenario) for criterion in limited(CRITERIA) if criterion.limit},
            {
                criterion.key: median(float(score.values[criterion.key] or 0.0) for score in reference)
                for criterion in _UNLIMITED
            },
        )


def _share(criterion: Criterion, value: float, scale: float) -> float:
    """About 1 for a run that is as good as the scale, less for a better one."""
    if criterion.better == "low":
        return value / scale
    return scale / value if value > 0 else TERM_MAX


def run_cost(scale: Scale, score: Score) -> float:
    """The sum above for one run. Raises ``ValueError`` for an incomplete run."""
    cost = 0.0
    for criterion in _UNLIMITED:
        value = score.values[criterion.key]
        if value is None:
            raise ValueError(f"a run without scores: {', '.join(score.failures)}")
        cost += _share(criterion, value, scale.medians[criterion.key])
    values = [(criterion, score.values[criterion.key]) for criterion in limited(CRITERIA)]
    if any(value is None for _, value in values):
        cost += len(values) * TERM_MAX
    else:
        for criterion, value in values:
            cost += min(_share(criterion, value or 0.0, scale.limits[limit_key(criterion)]), TERM_MAX)
    if (over_mps := score.extras[criteria.OVERSPEED.key]) > 0:
        cost += OVERSPEED + over_mps * KMH
    return cost


def objective(scale: Scale, scores: Sequence[Score]) -> float:
    """Mean of :func:`run_cost` over the runs."""
    return fmean(run_cost(scale, score) for score in scores)
