"""A probability and its interval: from repetitions of subset simulation, or from counted runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from railhil.batch.statistics import CONFIDENCE, Share

#: With fewer repetitions no interval is given (chosen: the deviation of fewer is not known well enough).
REPETITIONS_MIN = 10


@dataclass(frozen=True, slots=True)
class Probability:
    """``p``, and its interval at :data:`railhil.batch.statistics.CONFIDENCE`; None: there is none."""

    p: float
    low: float | None = None
    high: float | None = None

    @property
    def accuracy(self) -> float:
        """Half the width of the interval as a share of ``p``; infinite without an interval."""
        if self.low is None or self.high is None or not self.p:
            return math.inf
        return (self.high - self.low) / (2 * self.p)


def from_repetitions(estimates: Sequence[float]) -> Probability:
    """The mean of unbiased estimates of independent repetitions, and the t-interval of the mean on the scale of the
    logarithm (delta method): estimates of small probabilities are skewed to the right, and so is this interval.

    No interval: fewer than :data:`REPETITIONS_MIN` repetitions, or one of them has found nothing.
    """
    found = np.array(estimates, dtype=np.float64)
    mean = float(found.mean()) if len(found) else 0.0
    if len(found) < REPETITIONS_MIN or not found.all():
        return Probability(mean)
    share = float(found.std(ddof=1) / math.sqrt(len(found))) / mean
    factor = math.exp(share * float(stdtrit(len(found) - 1, (1 + CONFIDENCE) / 2)))
    return Probability(mean, mean / factor, min(1.0, mean * factor))


def from_count(found: Share) -> Probability:
    """The share of counted runs, and its exact interval (Clopper, Pearson 1934)."""
    return Probability(found.share, found.low, found.high)


def repetitions_for(have: int, accuracy: float, wanted: float) -> int:
    """How many repetitions the wanted accuracy takes, as far as the present one tells; at least one more, twice as many
    where there is no interval."""
    ratio = accuracy / wanted
    return max(have + 1, math.ceil(have * ratio**2)) if math.isfinite(ratio) else 2 * have


def runs_for(p: float, accuracy: float) -> int:
    """How many counted runs give an interval of this accuracy, as the normal distribution has it."""
    return math.ceil((1 - p) / p * (float(stdtrit(1e6, (1 + CONFIDENCE) / 2)) / accuracy) ** 2)
