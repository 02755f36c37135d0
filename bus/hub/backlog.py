"""Frames waiting for a bus that does not accept them at once."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from railhil.bus.frame import Frame
from railhil.bus.wallclock import WallClock

#: Maximum number of frames waiting for one bus.
LIMIT_FRAMES = 4096
#: Unless the port is lossless, a frame that has waited longer is no longer sent: half the age that cuts traction.
STALE_NS = 30_000_000


class Backlog:
    """First in, first out, bounded; the oldest frames are dropped when there are too many.

    :param lossless: frames wait as long as necessary; otherwise none older than :data:`STALE_NS` is sent.
    """

    def __init__(self, lossless: bool, wall: WallClock = time) -> None:
        self._lossless = lossless
        self._wall = wall
        self._waiting: deque[tuple[int, list[Frame]]] = deque()
        self.frames = 0

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def add(self, frames: list[Frame]) -> int:
        """Add frames at the end; returns how many old ones were dropped."""
        self._waiting.append((self._wall.monotonic_ns(), frames))
        self.frames += len(frames)
        dropped = 0
        while self.frames > LIMIT_FRAMES:
            dropped += self._drop_first()
        return dropped

    def drop_stale(self) -> int:
        """Drop stale frames; returns how many."""
        oldest_ns = self._wall.monotonic_ns() - STALE_NS
        dropped = 0
        while not self._lossless and self._waiting and self._waiting[0][0] < oldest_ns:
            dropped += self._drop_first()
        return dropped

    def drop_all(self) -> int:
        """Drop all frames; returns how many."""
        dropped, self.frames = self.frames, 0
        self._waiting.clear()
        return dropped

    def give(self, offer: Callable[[list[Frame]], int]) -> None:
        """Pass on frames from the first on, until ``offer``, which returns how many it accepted, does not accept
        all."""
        while self._waiting:
            since_ns, frames = self._waiting[0]
            taken = offer(frames)
            self.frames -= taken
            if taken < len(frames):
                self._waiting[0] = (since_ns, frames[taken:])
                return
            self._waiting.popleft()

    def _drop_first(self) -> int:
        _, frames = self._waiting.popleft()
        self.frames -= len(frames)
        return len(frames)
