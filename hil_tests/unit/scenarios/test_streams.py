"""Random streams of runs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import ndtri

from railhil.scenarios.streams import (
    beyond_median,
    far,
    generator,
    key_of,
    near,
    normal_at,
    normals,
    seed_sequence,
    words,
)


@pytest.mark.parametrize("seed", [0, 1, 1000, 2**31, 2**32 - 1, 2**32, 2**40 + 7])
@pytest.mark.parametrize("stream", [0, 3, 2**33])
def test_words_are_those_of_the_list(seed: int, stream: int) -> None:
    wanted = np.random.SeedSequence([seed, stream])
    assert seed_sequence(seed, stream).generate_state(6).tolist() == wanted.generate_state(6).tolist()
    assert generator(seed, stream).random() == np.random.Generator(np.random.PCG64(wanted)).random()


def test_a_negative_seed_is_refused() -> None:
    with pytest.raises(ValueError, match="must be >= 0"):
        generator(-1, 0)


WORD_MAX = 2**64 - 1


def test_words_are_those_of_splitmix64() -> None:
    """Published outputs for the seed 1234567."""
    found = words(np.uint64(1234567), np.arange(5, dtype=np.uint64))
    assert found.tolist() == [
        6457827717110365317,
        3203168211198807973,
        9817491932198370423,
        4593380528125082431,
        16408922859458223821,
    ]


@pytest.mark.parametrize(
    ("probability", "number"), [(0.25, -0.6744897501960817), (0.001, -3.090232306167814), (0.9, 1.2815515655446004)]
)
def test_numbers_are_those_of_as_241(probability: float, number: float) -> None:
    q = probability - 0.5
    assert (near(q) if abs(q) <= 0.425 else far(q)) == pytest.approx(number, rel=1e-15)


def test_the_extreme_words_give_the_extreme_numbers() -> None:
    lowest, highest = beyond_median(np.array([0, WORD_MAX], dtype=np.uint64)).tolist()
    assert (lowest, highest) == (-0.5 + 2.0**-53, 0.5 - 2.0**-53)
    assert far(highest) == -far(lowest) == pytest.approx(-ndtri(2.0**-53), rel=1e-14)


@given(st.integers(0, WORD_MAX))
def test_every_word_gives_the_number_of_its_probability(word: int) -> None:
    q = float(beyond_median(np.array([word], dtype=np.uint64))[0])
    assert q == (word // 2**12 + 0.5) / 2**52 - 0.5
    number = near(q) if abs(q) <= 0.425 else far(q)
    expected = -float(ndtri(0.5 - abs(q))) if q > 0 else float(ndtri(0.5 + q))
    assert number == pytest.approx(expected, rel=1e-13, abs=1e-15)


@given(st.integers(0, 2**63), st.integers(0, 50_000), st.integers(1, 200))
def test_a_block_is_a_part_of_the_sequence(key: int, first: int, count: int) -> None:
    whole = normals(key, max(0, first - 7), count + 20)
    assert normals(key, first, count).tolist() == whole[min(first, 7) :][:count].tolist()


def test_the_numbers_are_normal_and_streams_are_independent() -> None:
    # Every process that collects the tests would load it.
    from scipy.stats import kstest

    noise = [normals(key_of(seed, stream), 0, 50_000) for seed in (0, 1) for stream in (1, 2)]
    for numbers in noise:
        assert kstest(numbers, "norm").pvalue > 0.01
    assert abs(np.corrcoef(noise) - np.eye(4)).max() < 0.02
    neighbours = np.corrcoef(noise[0][1:], noise[0][:-1])[0, 1]
    assert abs(neighbours) < 0.02


def test_every_number_of_a_block_is_that_of_its_word_alone() -> None:
    """As an array, and one place after the other, as the batch draws them."""
    key = key_of(7, 24)
    q = beyond_median(words(np.uint64(key), np.arange(2_000, dtype=np.uint64)))
    assert (abs(q) > 0.425).sum() > 200
    found = normals(key, 0, 2_000)
    assert found == pytest.approx(ndtri(q + 0.5), rel=1e-12, abs=1e-15)
    with np.errstate(over="ignore"):
        assert found.tolist() == [normal_at(np.uint64(key), np.uint64(place)) for place in range(2_000)]


def test_keys() -> None:
    assert key_of(0, 0) == int(np.random.SeedSequence([0, 0]).generate_state(1, np.uint64)[0])
    assert len({key_of(seed, stream) for seed in range(50) for stream in range(20)}) == 1000


@pytest.mark.parametrize(("seed", "stream"), [(-1, 1), (1, -1)])
def test_negative_numbers_are_refused(seed: int, stream: int) -> None:
    with pytest.raises(ValueError, match=f"seed {seed} and stream {stream} must be >= 0"):
        key_of(seed, stream)
