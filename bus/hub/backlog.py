"""Frames that wait for a bus which does not take them at once."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from railhil.bus.frame import Frame
from railhil.bus.wallclock import WallClock

#: Most frames that wait for one bus.
LIMIT_FRAMES = 4096
#: Unless nothing may be lost, a frame that has waited longer is not sent any more: half of what cuts traction.
STALE_NS = 30_000_000


class Backlog:
    """First in, first out, bounded; the oldest frames go first when there are too many.

    :param lossless: frames wait as long as it takes; else none older than :data:`STALE_NS` is given out.
    """

    def __init__(self, lossless: bool, wall: WallClock = time) -> None:
        self._lossless = lossless
        self._wall = wall
        self._waiting: deque[tuple[int, list[Frame]]] = deque()
        self.frames = 0

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def add(self, frames: list[Frame]) -> int:
        """Put frames at the end; returns how many had to make room for them."""
        self._waiting.append((self._wall.monotonic_ns(), frames))
        self.frames += len(frames)
        dropped = 0
        while self.frames > LIMIT_FRAMES:
            dropped += self._drop_first()
        return dropped

    def drop_stale(self) -> int:
        """Forget what is too old; returns how many frames."""
        oldest_ns = self._wall.monotonic_ns() - STALE_NS
        dropped = 0
        while not self._lossless and self._waiting and self._waiting[0][0] < oldest_ns:
            dropped += self._drop_first()
        return dropped

    def drop_all(self) -> int:
        """Forget everything; returns how many frames."""
        dropped, self.frames = self.frames, 0
        self._waiting.clear()
        return dropped

    def give(self, offer: Callable[[list[Frame]], int]) -> None:
        """Hand over from the first on, until ``offer``, which returns how many it took, does not take all."""
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
