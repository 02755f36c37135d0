"""Noise of the speed sensor at the ticks at which it is read."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from railhil.batch.ziggurat import numbers_at
from railhil.scenarios import streams

#: Number of runs whose noise is cached, 3 kB each: searches and comparisons repeat the same seeds.
_KEPT = 4096
_kept: OrderedDict[tuple[int, int, int], NDArray[np.float64]] = OrderedDict()


def standard_noise(seeds: Sequence[int], ticks: NDArray[np.int64]) -> NDArray[np.float64]:
    """Standard normal numbers of :class:`railhil.plant_sim.sensors.AxleSensors` at some ticks, shape (ticks, seeds).

    :param ticks: rising from 0, shape (ticks,).
    """
    found = np.empty((len(seeds), ticks.size))
    which = hash(ticks.tobytes())
    for row, seed in enumerate(seeds):
        key = (seed, ticks.size, which)
        numbers = _kept.pop(key, None)
        if numbers is None:
            numbers = numbers_at(streams.generator(seed, streams.SPEED_NOISE), ticks)
        _kept[key] = numbers
        found[row] = numbers
    while len(_kept) > _KEPT:
        _kept.popitem(last=False)
    return np.ascontiguousarray(found.T)
