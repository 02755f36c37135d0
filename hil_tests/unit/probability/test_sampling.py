"""Subset simulation on limit states whose probability is known: the judge is Phi."""

from __future__ import annotations

import numpy as np
import pytest

from hil_tests.unit.probability.linear_states import Linear, estimates, pilots
from railhil.probability.interval import from_repetitions
from railhil.probability.sampling import Level, Points, draw_points, find_levels, join_points

STATES = {
    "2 draws at 2.5": Linear(2.5, 2),
    "15 draws at 4.5": Linear(4.5, 15),
    "15 draws and noise at 5.2": Linear(5.2, 15, noise=True),
    "ties of 1/20 deviation at 3.09": Linear(3.09, 15, tick=0.05),
    "two sides at 4.5": Linear(4.5, 10, sides=2),
    "430 draws at 3.7": Linear(3.7, 430),
}
_QUICK = "15 draws at 4.5"


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name == _QUICK else pytest.mark.long) for name in STATES]
)
def test_the_mean_of_sixty_repetitions_is_within_a_tenth_of_the_truth(name: str) -> None:
    state = STATES[name]
    found = estimates(state, 2000 if state.draws < 100 else 1000, 60, seed=3)
    assert abs(found.mean() / state.p - 1) < 0.1


@pytest.mark.long
def test_estimates_have_no_bias_even_with_few_points() -> None:
    """Bounds that each repetition takes from its own points give 7 % too much at 200 points."""
    state = Linear(2.5, 2, tick=0.05)
    found = np.concatenate([estimates(state, 100, 20, seed) for seed in range(100)])
    error = found.std() / np.sqrt(len(found))
    assert error < 0.02 * state.p
    assert abs(found.mean() - state.p) < 3 * error


@pytest.mark.long
def test_printed_intervals_cover_the_truth_in_nine_of_ten_trials() -> None:
    covered = 0
    trials = 200
    for seed in range(trials):
        state = list(STATES.values())[seed % 5]
        found = from_repetitions(estimates(state, 1000, 10, seed + 1000).tolist())
        assert found.low is not None
        assert found.high is not None
        covered += found.low <= state.p <= found.high
    assert covered >= 0.9 * trials


def test_fewer_than_ten_repetitions_and_one_without_a_failure_give_no_interval() -> None:
    assert from_repetitions([1e-4] * 9).low is None
    assert from_repetitions([1e-4] * 9 + [0.0]).low is None
    assert from_repetitions([1e-4, 2e-4] * 5).low == pytest.approx(1.5e-4 / np.exp(2.262 * 0.1111), rel=0.01)


def test_a_chain_of_noise_stays_standard_normal_and_gets_one_stream_with_each_accepted_proposal() -> None:
    random = np.random.default_rng(1)
    points = draw_points(50, 3, True, random)
    level = Level(0.0, (0.5, 0.5, 0.5), 0.3)
    for _ in range(20):
        proposed = level.propose(points, random)
        is_taken = random.random(50) < 0.4
        points = join_points([points, proposed]).take(np.arange(50) + 50 * is_taken)
    assert np.allclose((points.weights**2).sum(axis=1), 1.0, atol=1e-12, rtol=0)
    chains = points.chains()
    assert {len(chain) for chain in chains} > {8}
    assert all(len(chain) == np.count_nonzero(row) for chain, row in zip(chains, points.weights, strict=True))
    assert all(0 <= seed < 2**32 for chain in chains for seed, _ in chain)


def test_a_step_of_one_draws_new_noise_instead_of_a_longer_chain() -> None:
    random = np.random.default_rng(1)
    points = draw_points(5, 1, True, random)
    chains = Level(0.0, (1.0,), 1.0).propose(points, random).chains()
    assert [[weight for _, weight in chain] for chain in chains] == [[1.0]] * 5


def test_a_margin_that_shows_no_way_leaves_the_pilot_stuck() -> None:
    random = np.random.default_rng(1)
    plain = draw_points(200, 2, False, random)

    def flat(points: Points) -> np.ndarray:
        return np.ones((len(points), 1))

    found = find_levels(flat, 0, plain, flat(plain), 200, random)
    assert (found.is_whole, found.estimate, found.levels) == (False, 0.0, ())


def test_equal_margins_give_a_bound_that_leaves_some_of_them() -> None:
    """Nine tenths of the runs have the same margin: the bound is the next one below."""

    def steps(points: Points) -> np.ndarray:
        return np.where(points.draws[:, :1] > 1.2816, 0.5 - (points.draws[:, :1] > 2.3263), 2.0)

    random = np.random.default_rng(2)
    plain = draw_points(1000, 2, False, random)
    found = find_levels(steps, 0, plain, steps(plain), 1000, random)
    assert found.is_whole
    assert found.estimate == pytest.approx(0.01, rel=0.4)


def test_levels_fall_to_zero_and_steps_shrink_with_them() -> None:
    (found,) = pilots(Linear(4.5, 15), 1000, np.random.default_rng(4))
    bounds = [level.bound for level in found.levels]
    assert bounds == sorted(bounds, reverse=True)
    assert bounds[-1] == 0
    assert all(0 < step <= 1 for level in found.levels for step in (*level.draw_steps, level.noise_step))
