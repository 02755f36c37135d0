"""Numbers at a few places of a sequence: those that numpy draws."""

from __future__ import annotations

import numpy as np
import pytest

from railhil.batch import ziggurat
from railhil.batch.ziggurat import numbers_at
from railhil.scenarios import streams

COUNT = 20_000


def _drawn(seed: int) -> np.ndarray:
    return streams.generator(seed, streams.SPEED_NOISE).standard_normal(COUNT)


def test_every_number_is_that_of_numpy_bit_by_bit() -> None:
    """Among them those from the tail, one in 4000, and refused words, one in 80."""
    largest = 0.0
    for seed in range(20):
        found = numbers_at(streams.generator(seed, streams.SPEED_NOISE), np.arange(COUNT))
        assert np.array_equal(found.view(np.int64), _drawn(seed).view(np.int64)), seed
        largest = max(largest, float(abs(found).max()))
    assert largest > 3.6541528853610088


def test_a_few_places_of_the_sequence() -> None:
    places = np.array([0, 1, 50, 51, 7000, COUNT - 1])
    found = numbers_at(streams.generator(3, streams.SPEED_NOISE), places)
    assert found.tolist() == _drawn(3)[places].tolist()


def test_with_too_few_words_or_without_tables_all_numbers_are_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    places, expected = np.array([5, COUNT - 1]), _drawn(4)[[5, COUNT - 1]].tolist()
    with monkeypatch.context() as patch:
        patch.setattr(ziggurat, "_MORE_WORDS", 0)
        patch.setattr(ziggurat, "_WORDS_PER_NUMBER", 1.0)
        assert numbers_at(streams.generator(4, streams.SPEED_NOISE), places).tolist() == expected
    monkeypatch.setattr(ziggurat, "TABLES", None)
    assert numbers_at(streams.generator(4, streams.SPEED_NOISE), places).tolist() == expected
