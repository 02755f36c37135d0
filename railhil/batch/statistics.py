"""Quantiles, shares and their confidence intervals, without an assumption on the distribution of the scores."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import bdtr, betaincinv

#: Confidence level of every interval.
CONFIDENCE = 0.95
#: Probability outside the interval on each side.
_TAIL = (1 - CONFIDENCE) / 2


@dataclass(frozen=True, slots=True)
class Estimate:
    """A quantile and its confidence interval; None where the sample is too small for a bound."""

    value: float
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True)
class Share:
    """``count`` of ``runs``, and the confidence interval of the share."""

    count: int
    runs: int
    low: float
    high: float

    @property
    def share(self) -> float:
        """Observed share."""
        return self.count / self.runs


def order_ranks(n: int, q: float) -> tuple[int, int]:
    """Ranks (from 1) of the order statistics between which the ``q`` quantile lies with :data:`CONFIDENCE`.

    The number of values at or below the quantile is binomial (n, q) for every distribution. The probability outside is
    at most half of the remainder on each side. Rank 0 or n + 1: the sample is too small for a bound on that side. See
    David and Nagaraja, Order Statistics, 3rd ed., section 7.1.
    """
    # Smallest counts that reach the probability; scipy.stats can do this too, but takes half a second to import.
    low, high = (bisect_left(range(n), p, key=lambda count: bdtr(count, n, q)) for p in (_TAIL, 1 - _TAIL))
    return low, high + 1


def quantile(ordered: NDArray[np.float64], q: float) -> float:
    """Quantile of sorted values, linear between neighbours; infinite if an infinite neighbour has any weight."""
    position = (len(ordered) - 1) * q
    # 0.95 * 20 must be 19: rounding in the last bit must not include the next value.
    position = round(position, 9)
    below = math.floor(position)
    part = position - below
    if part == 0:
        return float(ordered[below])
    low, high = float(ordered[below]), float(ordered[below + 1])
    # Test for equality first: the difference of two infinite neighbours is undefined.
    return low if low == high else low + part * (high - low) if math.isfinite(low) else low


def at_most(values: NDArray[np.float64], q: float) -> float:
    """The least value such that a share ``q`` of the values is at or below it: "in 90 % of the sequences at most 7
    runs".

    :param values: any shape, at least one.
    """
    # Rounded first: 0.95 times 20 must not be a little more than 19.
    rank = max(1, math.ceil(round(q * values.size, 9)))
    return float(np.sort(values, axis=None)[rank - 1])


def estimate(values: NDArray[np.float64], q: float) -> Estimate:
    """``q`` quantile of the values, shape (n,), n >= 1, and its confidence interval. NaN counts as +infinity."""
    ordered = np.sort(np.where(np.isnan(values), np.inf, values))
    low, high = order_ranks(len(ordered), q)
    return Estimate(
        quantile(ordered, q),
        float(ordered[low - 1]) if low >= 1 else None,
        float(ordered[high - 1]) if high <= len(ordered) else None,
    )


def share(hits: NDArray[np.bool_]) -> Share:
    """Share of the runs for which ``hits`` is true, with the interval of :func:`share_of`."""
    return share_of(int(np.count_nonzero(hits)), len(hits))


def share_of(count: int, runs: int) -> Share:
    """``count`` of ``runs`` runs, with the exact interval of Clopper and Pearson (1934)."""
    low = float(betaincinv(count, runs - count + 1, _TAIL)) if count else 0.0
    high = float(betaincinv(count + 1, runs - count, 1 - _TAIL)) if count < runs else 1.0
    return Share(count, runs, low, high)


def differences(values: NDArray[np.float64], baseline: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values minus the values of the baseline in the same runs, shape (n,).

    NaN counts as +infinity; where both are missing, the runs count as equally bad, difference 0.
    """
    ours, theirs = (np.where(np.isnan(side), np.inf, side) for side in (values, baseline))
    both = np.isinf(ours) & np.isinf(theirs)
    return np.subtract(ours, theirs, out=np.zeros(len(ours)), where=~both)
