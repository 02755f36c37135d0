"""Causes: how much of the variance of a margin each draw makes, from runs that were made already.

The margin keeps its sign. On the size of an error the same shares would be near 0: what moves a stop forth in one run
moves it back in another.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from railhil.probability.sampling import Floats

#: Bins of equal probability into which the runs are sorted by a draw (chosen: enough for a bent dependence).
BINS = 20


@dataclass(frozen=True, slots=True)
class Sums:
    """Sums over plain runs, from which the shares follow; those of several parts can be added.

    ``all``: number, sum and sum of squares of the margins. ``bins``: number and sum of the margins of each bin of each
    draw, shape (2, draws, bins).
    """

    all: Floats
    bins: Floats

    @classmethod
    def of(cls, draws: Floats, margins: Floats) -> Sums:
        """Of runs with draws of shape (n, draws) and margins of shape (n,); runs with an infinite margin are left
        out."""
        known = np.isfinite(margins)
        draws, margins = draws[known], margins[known]
        places = np.minimum((ndtr(draws) * BINS).astype(np.int64), BINS - 1)
        bins = np.zeros((2, draws.shape[1], BINS))
        for draw in range(draws.shape[1]):
            bins[0, draw] = np.bincount(places[:, draw], minlength=BINS)
            bins[1, draw] = np.bincount(places[:, draw], weights=margins, minlength=BINS)
        return cls(np.array([len(margins), margins.sum(), margins @ margins]), bins)

    def __add__(self, other: Sums) -> Sums:
        return Sums(self.all + other.all, self.bins + other.bins)

    @property
    def variance(self) -> float:
        """Of the margins."""
        count, total, squares = self.all
        return float(squares / count - (total / count) ** 2) if count else 0.0

    def shares(self) -> list[float]:
        """The first-order share of each draw: variance of the mean of a bin, as a share of the whole.

        The part that bins have by chance (as many shares of 1 / n as there are bins, less one) is taken off.
        """
        count, total, _ = self.all
        if not self.variance:
            return [0.0] * self.bins.shape[1]
        numbers, sums = self.bins
        means = np.divide(sums, numbers, out=np.full_like(sums, total / count), where=numbers > 0)
        between = (numbers * (means - total / count) ** 2).sum(axis=1) / count
        by_chance = (BINS - 1) / count
        shares = (between / self.variance - by_chance) / (1 - by_chance)
        return [max(0.0, float(share)) for share in shares]


def noise_share(margins: Floats, with_new_noise: Floats) -> float | None:
    """The share of the variance that noise makes, alone and together with draws, from pairs of runs with the same draws
    (pick-freeze: Sobol 1993, Janon et al. 2014); None: the margins do not differ.

    :param margins, with_new_noise: of each pair, shape (n,).
    """
    known = np.isfinite(margins) & np.isfinite(with_new_noise)
    if known.sum() < 2 or not margins[known].std() or not with_new_noise[known].std():
        return None
    return float(np.clip(1 - np.corrcoef(margins[known], with_new_noise[known])[0, 1], 0.0, 1.0))
