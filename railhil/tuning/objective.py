"""What the search makes small: one number from the scores of the training runs, the same formula for every law.

Of each run::

    stop error / its limit  +  time error / its limit  +  ITAE / I  +  energy / E  +  comfort / C

with the limits of the scenario's plan, and I, E, C the medians of IPFC with its published parameters on the same runs:
a fixed scale on which every score is about 1 for a law that drives well. A train that does not stop has the largest
stop and time term there are (``TERM_MAX`` each); overspeed adds ``OVERSPEED`` and its size in km/h. The objective is
the mean over the runs, so that every run matters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean, median

from railhil.scenarios.model import RunPlan
from railhil.supervisor.measures import KMH
from railhil.supervisor.score import Score

#: Goes up with every change of the formula; stands in the files.
VERSION = 1
#: Largest term of a stop or time error, and that of a train that never stops.
TERM_MAX = 100.0
#: Added for a run with overspeed, besides the overspeed in km/h.
OVERSPEED = 10.0


@dataclass(frozen=True, slots=True)
class Scale:
    """What each score is divided by: m, s, km/h s2, kJ, m/s2 per km."""

    stop_error_m: float
    time_error_s: float
    itae: float
    energy_kj: float
    comfort: float

    @classmethod
    def of(cls, plan: RunPlan, reference: Sequence[Score]) -> Scale:
        """Limits of the plan, and medians of the reference law's runs."""
        return cls(
            plan.stop_error_max_m,
            plan.time_error_max_s,
            median(float(score.itae or 0.0) for score in reference),
            median(float(score.energy_kj or 0.0) for score in reference),
            median(float(score.comfort or 0.0) for score in reference),
        )


def run_cost(scale: Scale, score: Score) -> float:
    """The sum above, of one run. Raises ``ValueError`` for a run that is no whole run."""
    if score.itae is None or score.energy_kj is None or score.comfort is None:
        raise ValueError(f"a run without scores: {', '.join(score.failures)}")
    cost = score.itae / scale.itae + score.energy_kj / scale.energy_kj + score.comfort / scale.comfort
    if score.stop_error_m is None or score.punctuality_s is None:
        cost += 2 * TERM_MAX
    else:
        cost += min(score.stop_error_m / scale.stop_error_m, TERM_MAX)
        cost += min(score.punctuality_s / scale.time_error_s, TERM_MAX)
    if score.overspeed_mps > 0:
        cost += OVERSPEED + score.overspeed_mps * KMH
    return cost


def objective(scale: Scale, scores: Sequence[Score]) -> float:
    """Mean of :func:`run_cost` over the runs."""
    return fmean(run_cost(scale, score) for score in scores)
