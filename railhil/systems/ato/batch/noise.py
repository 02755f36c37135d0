"""Noise of the speed sensor at the ticks at which it is read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.batch import compiled
from railhil.scenarios import streams


@compiled.cached(__file__, streams)
def _draw(keys: Any, coefficients: Any, ends: Any, ticks: Any, numbers: Any) -> None:
    for row in range(ticks.size):
        place = 0
        for column in range(ends.size):
            number = 0.0
            while place < ends[column]:
                number += coefficients[place] * streams.normal_at(keys[place], ticks[row])
                place += 1
            numbers[row, column] = number


def renew_noise(
    noise: NDArray[np.float64], ticks: NDArray[np.int64], changes: Sequence[tuple[int, int]]
) -> NDArray[np.float64]:
    """Noise of :func:`standard_noise`, which each run has anew from a tick on.

    :param changes: of each run the tick, and the seed of its later noise.
    """
    later = standard_noise([streams.chain_of(seed) for _, seed in changes], ticks)
    return np.where(ticks[:, None] < [tick for tick, _ in changes], noise, later)


def standard_noise(chains: Sequence[streams.Chain], ticks: NDArray[np.int64]) -> NDArray[np.float64]:
    """Standard normal numbers of :class:`~railhil.plant_sim.ato.plant_readings.AxleSensors`, shape (ticks, chains).

    :param ticks: each >= 0, shape (ticks,).
    """
    flat = [part for chain in chains for part in streams.keys_of(chain, streams.AXLE_NOISE)]
    keys = np.array([key for key, _ in flat], dtype=np.uint64)
    coefficients = np.array([coefficient for _, coefficient in flat], dtype=np.float64)
    ends = np.cumsum([len(chain) for chain in chains])
    numbers = np.empty((ticks.size, ends.size))
    _draw(keys, coefficients, ends, ticks.astype(np.uint64), numbers)
    return numbers
