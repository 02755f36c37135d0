"""The bus as the panel reads it: without waiting, never sending, and opened again when it comes back."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.bus.errors import BusLost, BusUnavailable
from railhil.bus.frame import Frame
from railhil.bus.link import open_link
from railhil.bus.link.passive import be_passive

#: Frames taken at one look; of more than these the oldest are dropped. A real-time run at 1x sends about 60.
LOOK_FRAMES = 8000
#: Wall time between two attempts to open a bus that is not there.
_RETRY_S = 0.5
#: Frames that the hub hands over together.
_BULK_FRAMES = 256
#: Packets read at one look at most, so that a bus faster than this process cannot keep it.
_LOOK_PACKETS = 400


class Source(Protocol):
    """What frames are read from."""

    @property
    def counters(self) -> Mapping[str, int]:
        """Counts of what happened; ``rx_lost``: frames lost."""

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """Frames that have come; raises BusLost."""

    def close(self) -> None:
        """Leave it."""


def open_listening(config: dict[str, Any], name: str) -> Source:
    """A bus that is only listened to.

    :raises BusUnavailable: it cannot be opened.
    """
    link = open_link(config, name)
    be_passive(link)
    return link


class Receiver:
    """Reads a bus by looking at it; ``dropped`` counts frames left out because there were too many.

    :param config: arguments of ``can.Bus``.
    :param waits: what is not read at one look waits for the next one, as in a file.
    """

    def __init__(
        self,
        config: dict[str, Any],
        open_bus: Callable[[dict[str, Any], str], Source] = open_listening,
        waits: bool = False,
    ) -> None:
        self._packets = 1 if waits else _LOOK_PACKETS
        self._frames_max = None if waits else LOOK_FRAMES
        self._config = dict(config)
        # A hub on this machine: its socket's file says when it is there.
        self._path = ""
        if config.get("interface") == HUB_INTERFACE:
            self._path = str(config.get("channel", ""))
            self._config |= {"coalesce_frames": _BULK_FRAMES, "connect_timeout": 0.0}
        self._open_bus = open_bus
        self._link: Source | None = None
        self._was_there = self._was_open = False
        self._retry_s = 0.0
        self._lost_before = 0
        self.dropped = 0
        #: What the last look lacks: frames before its first one, and frames at places that are not known.
        self.lacks_before = self.lacks_within = False
        #: Why there is no bus; empty while there is one.
        self.trouble = "not opened yet"

    @property
    def is_open(self) -> bool:
        """Whether there is a bus."""
        return self._link is not None

    def look(self) -> list[Frame]:
        """Frames that have arrived since the last look, oldest first; see :attr:`lacks_before`,
        :attr:`lacks_within`."""
        self.lacks_before = self.lacks_within = False
        if self._link is None and not self._opened():
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

    def _opened(self) -> bool:
        now_s = time.monotonic()
        is_there = bool(self._path) and os.path.exists(self._path)
        is_new, self._was_there = is_there and not self._was_there, is_there
        if not is_new and now_s < self._retry_s:
            return False
        # The file is there an instant before the hub answers: the next look may be the one that succeeds.
        self._retry_s = now_s if is_new else now_s + _RETRY_S
        try:
            self._link = self._open_bus(self._config, "panel")
        except BusUnavailable as error:
            self.trouble = str(error)
            return False
        self._lost_before = 0
        # Not before the first time.
        self.lacks_before = self._was_open
        self._was_open = True
        self.trouble = ""
        return True
