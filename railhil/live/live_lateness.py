"""Lateness of a real-time run while it is made, for the panel: from the arrivals of the ticks at the recorder."""

from __future__ import annotations

from array import array
from typing import Any

#: Ticks of which the 99 % are told: those of the last seconds, so that the page shows what is happening now.
RECENT = 1000


class LiveLateness:
    """Lateness of arrivals behind deadlines that are a tick apart, the earliest arrival so far defining zero, as in
    :func:`railhil.judge.jitter.arrivals_of`.

    :param ticks, wall_ns: of the session, which goes on filling them: number and monotonic wall time of each tick.
    """

    def __init__(self, ticks: array[int], wall_ns: array[int]) -> None:
        self._ticks = ticks
        self._wall_ns = wall_ns
        self._seen = 0
        self._tick_ns = 0.0
        # Wall time minus deadline, of the earliest and of the latest arrival.
        self._first_ns = self._last_ns = 0.0

    def report(self, tick_ns: float) -> dict[str, Any] | None:
        """``p99_ms`` of the last :data:`RECENT` ticks, ``worst_ms`` and ``cycles`` of the run; None: no tick yet.

        :param tick_ns: wall time between two ticks.
        """
        count = len(self._ticks)
        if not count:
            return None
        if tick_ns != self._tick_ns:
            # The plant has told another pace: with it all deadlines are others.
            self._tick_ns, self._seen = tick_ns, 0
        fresh = self._offsets(self._seen)
        known = [self._first_ns, self._last_ns] if self._seen else []
        self._first_ns, self._last_ns = min(known + fresh), max(known + fresh)
        self._seen = count
        recent = sorted(self._offsets(max(0, count - RECENT)))
        p99_ns = recent[min(len(recent) - 1, len(recent) * 99 // 100)]
        return {
            "p99_ms": (p99_ns - self._first_ns) / 1e6,
            "worst_ms": (self._last_ns - self._first_ns) / 1e6,
            "cycles": count,
        }

    def _offsets(self, begin: int) -> list[float]:
        ticks, wall_ns = self._ticks[begin:], self._wall_ns[begin:]
        return [wall - tick * self._tick_ns for tick, wall in zip(ticks, wall_ns, strict=False)]
