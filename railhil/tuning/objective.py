"""The objective that the search minimises: one number from the scores of the training runs, the same formula for every
law.

For each run::

    stop error / its limit  +  time error / its limit  +  ITAE / I  +  energy / E  +  comfort / C

(each criterion of the system), with the limits of the scenario's plan. I, E and C are the medians of IPFC with its
published parameters on the same runs: a fixed scale on which every score of a good law is about 1. A train that does
not stop has the maximum stop and time terms (``TERM_MAX`` each); overspeed adds ``EXTRA`` plus its amount in km/h. The
objective is the mean over the runs, so that every run matters.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, median

from railhil.judge.criteria import Criterion, limit_key, limited
from railhil.judge.judging import Judging, judging_of
from railhil.judge.score import Score
from railhil.scenarios.model import AnyScenario

#: Increased with every change of the formula; recorded in the files.
VERSION = 1
#: Maximum term of a stop or time error, also used for a train that never stops.
TERM_MAX = 100.0
#: Added for an extra that is not 0 (overspeed), in addition to its weighted amount.
EXTRA = 10.0


@dataclass(frozen=True, slots=True)
class Scale:
    """The divisors of the scores, in their units.

    ``limits``: of the scenario, by the key of the limit; ``medians``: of the reference's runs, by criterion.
    ``judging``: of the system, with its criteria and extras.
    """

    limits: Mapping[str, float]
    medians: Mapping[str, float]
    judging: Judging

    @classmethod
    def of(cls, scenario: AnyScenario, reference: Sequence[Score]) -> Scale:
        """Limits of the scenario, and medians of the reference law's runs."""
        judging = judging_of(scenario)
        limits = {limit_key(one): one.limit.of(scenario) for one in limited(judging.criteria) if one.limit}
        medians = {
            criterion.key: median(float(score.values[criterion.key] or 0.0) for score in reference)
            for criterion in _unlimited(judging)
        }
        return cls(limits, medians, judging)


def _unlimited(judging: Judging) -> list[Criterion]:
    """Criteria without a limit: they are compared with the reference."""
    return [criterion for criterion in judging.criteria if criterion.limit is None]


def _share(criterion: Criterion, value: float, scale: float) -> float:
    """About 1 for a run that is as good as the scale, less for a better one."""
    if criterion.better == "low":
        return value / scale
    return scale / value if value > 0 else TERM_MAX


def run_cost(scale: Scale, score: Score) -> float:
    """The sum above for one run. Raises ``ValueError`` for an incomplete run."""
    cost = 0.0
    for criterion in _unlimited(scale.judging):
        value = score.values[criterion.key]
        if value is None:
            raise ValueError(f"a run without scores: {', '.join(score.failures)}")
        cost += _share(criterion, value, scale.medians[criterion.key])
    values = [(criterion, score.values[criterion.key]) for criterion in limited(scale.judging.criteria)]
    if any(value is None for _, value in values):
        cost += len(values) * TERM_MAX
    else:
        for criterion, value in values:
            cost += min(_share(criterion, value or 0.0, scale.limits[limit_key(criterion)]), TERM_MAX)
    for extra in scale.judging.extras:
        if (amount := score.extras[extra.key]) > 0:
            cost += EXTRA + amount * extra.tuning_weight
    return cost


def objective(scale: Scale, scores: Sequence[Score]) -> float:
    """Mean of :func:`run_cost` over the runs."""
    return fmean(run_cost(scale, score) for score in scores)
