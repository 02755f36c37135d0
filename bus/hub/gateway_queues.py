"""Queues of the gateway: frames that wait for a bus, and frames from the thread that reads one."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections import deque
from collections.abc import Callable

from railhil.bus.frame import Frame
from railhil.common.patience import WallClock

#: Maximum number of frames waiting for one bus.
LIMIT_FRAMES = 4096
#: Unless the port is lossless, a frame that has waited longer is not sent. The limit is half the age that cuts
#: traction.
STALE_NS = 30_000_000


class Backlog:
    """First in, first out, bounded; the oldest frames are dropped when there are too many.

    :param lossless: frames wait as long as necessary; otherwise a frame older than :data:`STALE_NS` is dropped.
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


class Arrivals:
    """First in, first out, bounded; the oldest frames are dropped when the switch does not read."""

    def __init__(self) -> None:
        self._frames: deque[Frame] = deque(maxlen=LIMIT_FRAMES)
        self._lock = threading.Lock()
        self._wake_fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)

    def fileno(self) -> int:
        """Readable from :meth:`wake` to the next :meth:`take`."""
        return self._wake_fd

    def put(self, frames: list[Frame]) -> int:
        """For the thread: add frames at the end; returns how many old ones were dropped."""
        with self._lock:
            dropped = max(0, len(self._frames) + len(frames) - LIMIT_FRAMES)
            self._frames.extend(frames)
        self.wake()
        return dropped

    def wake(self) -> None:
        """For the thread: wake the switch."""
        os.eventfd_write(self._wake_fd, 1)

    def take(self) -> list[Frame]:
        """For the switch: all frames that have arrived."""
        with contextlib.suppress(BlockingIOError):
            os.eventfd_read(self._wake_fd)
        with self._lock:
            frames = list(self._frames)
            self._frames.clear()
        return frames

    def close(self) -> None:
        """Close the descriptor."""
        os.close(self._wake_fd)
