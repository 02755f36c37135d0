"""Queue of frames from the thread that reads a bus to the switch."""

from __future__ import annotations

import contextlib
import os
import threading
from collections import deque

from railhil.bus.frame import Frame
from railhil.bus.hub.backlog import LIMIT_FRAMES


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
