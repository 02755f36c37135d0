"""Statistics of campaigns against known values, by simulation and against scipy."""

from __future__ import annotations

import math
from importlib import import_module
from types import ModuleType

import numpy as np
import pytest

from railhil.batch.statistics import Estimate, at_most, differences, estimate, order_ranks, quantile, share


def stats() -> ModuleType:
    """Every process that collects the tests would load it."""
    return import_module("scipy.stats")


@pytest.mark.parametrize(
    ("n", "q", "ranks"),
    [
        # Conover, Practical Nonparametric Statistics, and the usual tables of the sign test.
        (10, 0.5, (2, 9)),
        (20, 0.5, (6, 15)),
        (100, 0.5, (40, 61)),
        # 0.95^72 = 0.0249 < 0.025: from here on there is an upper bound of the 95th percentile, the largest value.
        (71, 0.95, (63, 72)),
        (72, 0.95, (64, 72)),
        (5, 0.5, (0, 6)),
    ],
)
def test_ranks_of_the_interval(n, q, ranks):
    assert order_ranks(n, q) == ranks


@pytest.mark.parametrize("q", [0.5, 0.95])
@pytest.mark.parametrize("n", [40, 400])
def test_intervals_cover_the_quantile_as_often_as_they_say(n, q):
    generator = np.random.default_rng(7)
    # Skewed, as absolute errors are: nothing may hang on a normal distribution.
    samples = generator.exponential(size=(4000, n))
    truth = -math.log(1 - q)
    found = [estimate(sample, q) for sample in samples]
    # No upper bound is one that is always above.
    covered = np.mean([one.low <= truth <= (math.inf if one.high is None else one.high) for one in found])
    low, high = order_ranks(n, q)
    exact = stats().binom.cdf(high - 1, n, q) - stats().binom.cdf(low - 1, n, q)
    # Discrete ranks give a little more than asked for; four standard errors of this simulation.
    assert exact >= 0.95
    assert covered == pytest.approx(exact, abs=4 * math.sqrt(exact * (1 - exact) / 4000))
    assert np.median([one.value for one in found]) == pytest.approx(truth, rel=0.1)


def test_quantiles():
    values = np.arange(1.0, 22.0)
    assert quantile(values, 0.5) == 11
    assert quantile(values, 0.95) == 20
    assert quantile(values[:20], 0.5) == 10.5
    assert quantile(values[:20], 0.95) == pytest.approx(np.percentile(values[:20], 95))


def test_a_run_without_the_score_is_infinitely_bad():
    values = np.array([0.1] * 18 + [math.nan] * 2)
    assert estimate(values, 0.5).value == 0.1
    assert estimate(values, 0.95).value == math.inf
    assert estimate(values, 0.95).high is None
    assert estimate(np.full(9, math.nan), 0.5).value == math.inf


@pytest.mark.parametrize(
    ("count", "runs", "low", "high"),
    [
        # Clopper and Pearson (1934); closed forms at the ends: 1 - 0.025^(1/n).
        (10, 10, 0.025 ** (1 / 10), 1.0),
        (0, 10_000, 0.0, 1 - 0.025 ** (1 / 10_000)),
        (5, 10, 0.18709, 0.81291),
    ],
)
def test_shares(count, runs, low, high):
    found = share(np.arange(runs) < count)
    assert (found.count, found.runs, found.share) == (count, runs, count / runs)
    assert (found.low, found.high) == (pytest.approx(low, abs=1e-5), pytest.approx(high, abs=1e-5))


@pytest.mark.parametrize("n", [1, 2, 71, 72, 1000, 9999, 10_000])
def test_ranks_and_shares_are_those_of_scipy(n):
    for q in (0.5, 0.95):
        assert order_ranks(n, q) == (int(stats().binom.ppf(0.025, n, q)), int(stats().binom.ppf(0.975, n, q)) + 1)
    for count in {0, 1, n // 3, n - 1, n}:
        found, wanted = share(np.arange(n) < count), stats().binomtest(count, n).proportion_ci(0.95, method="exact")
        assert (found.low, found.high) == (pytest.approx(wanted.low, rel=1e-9), pytest.approx(wanted.high, rel=1e-9))


def test_bounds_of_a_share_are_where_the_tails_hold_two_and_a_half_percent():
    found = share(np.arange(263) < 81)
    assert stats().binom.sf(80, 263, found.low) == pytest.approx(0.025)
    assert stats().binom.cdf(81, 263, found.high) == pytest.approx(0.025)


def test_paired_differences():
    ours, theirs = np.array([1.0, math.nan, 2.0, math.nan]), np.array([3.0, 1.0, math.nan, math.nan])
    assert differences(ours, theirs).tolist() == [-2.0, math.inf, -math.inf, 0.0]


def test_no_bound_is_not_an_infinite_one():
    assert estimate(np.full(9, math.nan), 0.95) == Estimate(math.inf, math.inf, None)
    assert estimate(np.full(9, -math.inf), 0.5) == Estimate(-math.inf, -math.inf, -math.inf)
    assert estimate(np.arange(5.0), 0.5) == Estimate(2.0, None, None)


@pytest.mark.parametrize("count", [1, 2, 3, 10, 11, 20, 60, 150, 299])
@pytest.mark.parametrize("q", [0.5, 0.9, 0.95])
def test_at_most_is_the_least_value_that_a_share_of_the_values_reaches(count, q):
    values = np.arange(1.0, count + 1.0)
    found = at_most(values, q)
    assert np.mean(values <= found) >= q - 1e-12
    assert np.mean(values <= found - 1) < q - 1e-12


def test_in_90_percent_of_ten_sequences_at_most_the_ninth():
    assert at_most(np.array([10.0, 1, 9, 2, 8, 3, 7, 4, 6, 5]), 0.9) == 9.0
    assert at_most(np.array([1.0, np.inf]), 0.5) == 1.0
