"""Descent of a margin: it finds rare vectors in few runs, leaves a local minimum, and depends on the seed alone."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest

from railhil.common.errors import InputError
from railhil.study.descent import Descent, descend, generation_size

pytest.importorskip("cmaes", reason="MISSING CAPABILITY cmaes (extra campaign)")


def linear(beta):
    """Violated beyond ``beta`` standard deviations along the diagonal."""
    return lambda block: beta - block.sum(axis=1) / math.sqrt(block.shape[1])


@pytest.mark.parametrize(("dimensions", "seed"), [(1, 0), (2, 1), (15, 2), (40, 3)])
def test_a_half_space_that_one_of_300_000_vectors_enters_is_found_within_300_runs(dimensions, seed):
    found = descend(linear(4.5), dimensions, 600, seed, until_violated=True)
    assert found.first is not None
    assert found.first <= 300
    assert found.margin < 0
    assert found.margin == linear(4.5)(found.vector[None])[0]
    assert found.run <= found.runs <= found.first + generation_size(dimensions)


def test_the_least_vector_of_a_failing_set_is_found_by_its_length():
    def length_where_violated(block):
        margin = linear(4.5)(block)
        return np.where(margin < 0, np.linalg.norm(block, axis=1), 100 + margin)

    found = descend(length_where_violated, 10, 3000, 0)
    assert found.first is None
    assert found.margin == pytest.approx(4.5, rel=0.01)
    assert found.vector == pytest.approx(np.full(10, 4.5 / math.sqrt(10)), abs=0.2)


def test_a_start_that_is_stuck_is_given_up_for_another_one():
    """Behind a rise the margin falls below 0 in one direction; the slope at 0 leads the other way."""

    def two_valleys(block):
        return np.minimum(1 + (block[:, 0] + 1) ** 2, 10 * (block[:, 0] - 2) ** 2 - 0.1) + 0.1 * block[:, 1] ** 2

    founds = [descend(two_valleys, 2, 6000, seed, start=[-1, 0], step=0.1) for seed in range(3)]
    assert all(found.starts > 1 for found in founds)
    assert all(found.first is not None and found.vector[0] > 1.9 for found in founds)


def test_the_vectors_follow_from_the_seed_and_from_the_margins_alone():
    def proposals(seed):
        descent = Descent(15, seed)
        blocks = []
        for _ in range(40):
            blocks.append(descent.propose())
            descent.learn(linear(3)(blocks[-1]))
        return np.concatenate(blocks)

    assert np.array_equal(proposals(3), proposals(3))
    assert not np.array_equal(proposals(3), proposals(4))


def test_a_margin_that_a_different_order_of_addition_gives_changes_no_vector():
    """What another BLAS does: each margin differs in its last bits."""
    plain, other = Descent(15, 1), Descent(15, 1)
    for number in range(30):
        block, same = plain.propose(), other.propose()
        assert np.array_equal(block, same)
        margins = linear(3)(block)
        plain.learn(margins)
        other.learn(margins * (1 + 1e-15 * (number % 3)))


def test_every_vector_lies_within_the_bounds():
    bounds = np.array([[0.0, 1.0], [-3.0, -2.0], [0.0, 100.0]])
    seen = []

    def margins(block):
        seen.append(block)
        return block.sum(axis=1)

    found = descend(margins, 3, 400, 0, start=[0.5, -2.5, 50], step=0.3, bounds=bounds)
    blocks = np.concatenate(seen)
    assert (blocks >= bounds[:, 0]).all()
    assert (blocks <= bounds[:, 1]).all()
    assert len(blocks) == found.runs <= 400


def test_a_run_without_a_margin_counts_and_leads_nowhere():
    def half_known(block):
        return np.where(block[:, 0] < 0, np.nan, 1 + block[:, 0])

    found = descend(half_known, 2, 300, 0)
    assert found.margin == pytest.approx(1, abs=0.01)
    assert found.first is None


def test_margins_that_are_all_infinite_are_no_finding():
    found = descend(lambda block: np.full(len(block), np.inf), 3, 200, 0)
    assert (found.margin, found.first, found.run) == (math.inf, None, 0)
    assert found.starts > 1


@pytest.mark.parametrize("wrong", [{"dimensions": 0}, {"step": 0}, {"size": 3}, {"bounds": [[0, 1]]}, {"start": [1]}])
def test_what_does_not_fit_is_refused(wrong):
    with pytest.raises(ValueError, match=r"found .* allowed"):
        Descent(**{"dimensions": 2, "seed": 0} | wrong)


def test_margins_are_told_once_for_each_generation():
    descent = Descent(2, 0)
    block = descent.propose()
    with pytest.raises(ValueError, match="not known yet"):
        descent.propose()
    with pytest.raises(ValueError, match="found 1 margins"):
        descent.learn(np.zeros(1))
    descent.learn(np.zeros(len(block)))
    with pytest.raises(ValueError, match="after a proposal"):
        descent.learn(np.zeros(len(block)))


def test_a_missing_library_names_its_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "cmaes", None)
    with pytest.raises(InputError, match="campaign"):
        Descent(2, 0)
