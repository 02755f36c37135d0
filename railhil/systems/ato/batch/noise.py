"""Noise of the speed sensor at the ticks at which it is read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.batch import compiled
from railhil.scenarios import streams


@compiled.cached(__file__, streams)
def _draw(keys: Any, ticks: Any, numbers: Any) -> None:
    for row in range(ticks.size):
        for column in range(keys.size):
            numbers[row, column] = streams.normal_at(keys[column], ticks[row])


def standard_noise(seeds: Sequence[int], ticks: NDArray[np.int64]) -> NDArray[np.float64]:
    """Standard normal numbers of :class:`~railhil.plant_sim.ato.plant_readings.AxleSensors`, shape (ticks, seeds).

    :param ticks: each >= 0, shape (ticks,).
    """
    keys = np.array([streams.key_of(seed, streams.AXLE_NOISE) for seed in seeds], dtype=np.uint64)
    numbers = np.empty((ticks.size, keys.size))
    _draw(keys, ticks.astype(np.uint64), numbers)
    return numbers
