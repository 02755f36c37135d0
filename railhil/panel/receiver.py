"""The frames that the panel reads: from a bus, without waiting and sending, opened again when it comes back; or from
the log of a run in progress that has no bus to join."""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Protocol

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.bus.errors import BusLost, BusUnavailable
from railhil.bus.frame import Frame
from railhil.bus.link import open_link
from railhil.bus.link.opening import listen_only
from railhil.common.errors import describe_os_error
from railhil.record.framelog import LOG_NAME, frames_of

#: Largest number of frames taken at one reading; of more frames the oldest are dropped. A real-time run at 1x sends
#: about 60.
LOOK_FRAMES = 8000
#: Wall time between two attempts to open a bus that is not there.
_RETRY_S = 0.5
#: Frames that the hub hands over together.
_BULK_FRAMES = 256
#: Largest number of packets taken at one reading, so that a bus faster than this process cannot block it.
_LOOK_PACKETS = 400


class FrameSource(Protocol):
    """A source of frames."""

    @property
    def counters(self) -> Mapping[str, int]:
        """Counters; ``rx_lost``: frames lost."""

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """Frames that have arrived; raises BusLost."""

    def close(self) -> None:
        """Leave it."""


def open_passive_bus(config: dict[str, Any], name: str) -> FrameSource:
    """A bus that is only listened to.

    :raises BusUnavailable: it cannot be opened.
    """
    link = open_link(config, name)
    listen_only(link)
    return link


class Receiver:
    """Polls a bus; ``dropped`` counts frames left out because there were too many.

    :param config: arguments of ``can.Bus``.
    :param waits: frames not taken at one reading wait for the next one, as in a file.
    """

    def __init__(
        self,
        config: dict[str, Any],
        open_bus: Callable[[dict[str, Any], str], FrameSource] = open_passive_bus,
        waits: bool = False,
    ) -> None:
        self._packets = 1 if waits else _LOOK_PACKETS
        self._frames_max = None if waits else LOOK_FRAMES
        self._config = dict(config)
        # A hub on this machine is there when its socket's file exists.
        self._path = ""
        if config.get("interface") == HUB_INTERFACE:
            self._path = str(config.get("channel", ""))
            self._config |= {"coalesce_frames": _BULK_FRAMES, "connect_timeout": 0.0}
        self._open_bus = open_bus
        self._link: FrameSource | None = None
        self._was_there = self._was_open = False
        self._retry_s = 0.0
        self._lost_before = 0
        self.dropped = 0
        #: Losses of the last reading: frames before its first one, and frames at unknown places.
        self.lacks_before = self.lacks_within = False
        #: Reason for which there is no bus; empty while there is one.
        self.trouble = "not opened yet"

    @property
    def is_open(self) -> bool:
        """Whether there is a bus."""
        return self._link is not None

    def look(self) -> list[Frame]:
        """Frames that have arrived since the last reading, oldest first; see :attr:`lacks_before`,
        :attr:`lacks_within`."""
        self.lacks_before = self.lacks_within = False
        if self._link is None and not self._open():
            return []
        assert self._link is not None
        frames: list[Frame] = []
        try:
            for _ in range(self._packets):
                arrived = self._link.receive(0.0)
                if not arrived:
                    break
                frames += arrived
        except BusLost as error:
            self.close()
            self.trouble = str(error)
        if self._frames_max is not None and len(frames) > self._frames_max:
            self.dropped += len(frames) - self._frames_max
            frames = frames[-self._frames_max :]
            self.lacks_before = True
        if self._link is not None:
            lost = self._link.counters["rx_lost"]
            self.dropped += lost - self._lost_before
            self.lacks_within = lost != self._lost_before
            self._lost_before = lost
        return frames

    def close(self) -> None:
        """Leave the bus."""
        if self._link is not None:
            self._link.close()
            self._link = None

    def _open(self) -> bool:
        now_s = time.monotonic()
        is_there = bool(self._path) and os.path.exists(self._path)
        is_new, self._was_there = is_there and not self._was_there, is_there
        if not is_new and now_s < self._retry_s:
            return False
        # The file appears an instant before the hub answers: the next attempt may succeed.
        self._retry_s = now_s if is_new else now_s + _RETRY_S
        try:
            self._link = self._open_bus(self._config, "panel")
        except BusUnavailable as error:
            self.trouble = str(error)
            return False
        self._lost_before = 0
        # Nothing was lost before the first opening.
        self.lacks_before = self._was_open
        self._was_open = True
        self.trouble = ""
        return True


#: Bytes taken at one reading: about 8000 classic frames.
LOOK_BYTES = 360_000
#: Bytes that may wait to be read, about 350 000 frames; of more the oldest lines are left out.
BACKLOG_BYTES = 16 << 20
_SKIP_BYTES = 1 << 20


class LogFollower:
    """The frames of ``frames.log`` in a run folder, in the order of the bus.

    ``counters["rx_lost"]``: lines left out because there were too many.

    :raises BusUnavailable: the run has not begun, or its log cannot be read.
    """

    def __init__(self, folder: Path) -> None:
        self._path = path = folder / LOG_NAME
        try:
            self._stream = path.open("rb", buffering=0)
        except FileNotFoundError:
            raise BusUnavailable(f"run {folder} has not begun") from None
        except OSError as error:
            raise BusUnavailable(f"{path}: {describe_os_error(error)}") from None
        self.counters: Counter[str] = Counter()
        #: Beginning of a line whose end is not written yet.
        self._begun = b""

    def receive(self, timeout_s: float | None = 0.0) -> list[Frame]:
        """The next frames, oldest first, at most :data:`LOOK_BYTES` of lines; never waits.

        :raises BusLost: it is no log of a run.
        """
        self._skip()
        text = self._begun + self._stream.read(LOOK_BYTES)
        whole = text.rfind(b"\n") + 1
        self._begun = text[whole:]
        try:
            return frames_of(text[:whole])
        except (ValueError, IndexError):
            raise BusLost(f"{self._path}: found lines that are no frames, allowed: the log of a run") from None

    def _skip(self) -> None:
        """Count the excess lines without parsing them."""
        unread = os.fstat(self._stream.fileno()).st_size - self._stream.tell() - BACKLOG_BYTES
        if unread <= 0:
            return
        while unread > 0 and (part := self._stream.read(min(unread, _SKIP_BYTES))):
            unread -= len(part)
            self.counters["rx_lost"] += part.count(b"\n")
        # The end of the skipped part usually lies inside a line.
        rest = self._stream.read(LOOK_BYTES)
        self.counters["rx_lost"] += 1
        self._begun = b""
        self._stream.seek(rest.find(b"\n") + 1 - len(rest), os.SEEK_CUR)

    def close(self) -> None:
        """Close the file."""
        self._stream.close()
