"""Random streams of runs."""

from __future__ import annotations

import numpy as np
import pytest

from railhil.scenarios.streams import generator, seed_sequence


@pytest.mark.parametrize("seed", [0, 1, 1000, 2**31, 2**32 - 1, 2**32, 2**40 + 7])
@pytest.mark.parametrize("stream", [0, 3, 2**33])
def test_words_are_those_of_the_list(seed: int, stream: int) -> None:
    wanted = np.random.SeedSequence([seed, stream])
    assert seed_sequence(seed, stream).generate_state(6).tolist() == wanted.generate_state(6).tolist()
    assert generator(seed, stream).random() == np.random.Generator(np.random.PCG64(wanted)).random()


def test_a_negative_seed_is_refused() -> None:
    with pytest.raises(ValueError, match="must be >= 0"):
        generator(-1, 0)
