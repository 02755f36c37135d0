"""The docking loop: whether a standing train is within the door window of the stopping point."""

from __future__ import annotations

from typing import Final

import numpy as np

from railhil.scenarios import streams

#: Largest error of a measurement, and the time between two of them.
ERROR_MAX_M: Final = 0.02
PERIOD_S: Final = 0.1
_BLOCK: Final = 512


class DockingLoop:
    """Measures where the train stands; its error is uniform, and depends only on the seed and the tick.

    :param window_m: largest distance from the stopping point.
    :ivar is_in_window: result of the last measurement.
    :ivar stuck: what it says instead (a fault); None: it works.
    :ivar has_failed: it has said that a moving train was in the window; from then on it counts for nothing.
    """

    def __init__(self, window_m: float, seed: int, tick_s: float) -> None:
        self.is_in_window = False
        self.stuck: bool | None = None
        self.has_failed = False
        self.period_ticks = max(1, round(PERIOD_S / tick_s))
        self._window_m = window_m
        self._key = streams.key_of(seed, streams.DOCKING)
        self._first = 0
        self._errors_m: list[float] = []

    def measure(self, offset_m: float, tick: int) -> None:
        """Measure the distance from the stopping point.

        :param tick: a multiple of ``period_ticks``.
        """
        measured_m = offset_m + self._error_m(tick // self.period_ticks)
        found = abs(measured_m) <= self._window_m if self.stuck is None else self.stuck
        self.is_in_window = found and not self.has_failed

    def leave(self) -> None:
        """The train moves: the loop must not find it in the window."""
        self.has_failed = self.has_failed or bool(self.stuck)
        self.is_in_window = False

    def _error_m(self, place: int) -> float:
        index = place - self._first
        if not 0 <= index < len(self._errors_m):
            self._first, index = place, 0
            places = np.arange(place, place + _BLOCK, dtype=np.uint64)
            halves = streams.beyond_median(streams.words(np.uint64(self._key), places))
            self._errors_m = (halves * 2 * ERROR_MAX_M).tolist()
        return self._errors_m[index]
