"""Clients that have connected and not said hello yet: few, and not for long, so that they keep nobody out."""

from __future__ import annotations

import time

from railhil.bus.hub.ports import SwitchPort
from railhil.bus.wallclock import WallClock

#: Wall time for the hello of a client.
HELLO_S = 5.0
#: When one more connects, the one that has been silent for longest is disconnected.
MAX_GUESTS = 64


class Guests:
    """The clients without a hello, in the order in which they have connected.

    :ivar waiting: by client, when it must have said hello (monotonic clock); the loop of the hub asks each time whether
        there is one.
    """

    def __init__(self, wall: WallClock = time) -> None:
        self._wall = wall
        self.waiting: dict[SwitchPort, int] = {}

    @property
    def due_ns(self) -> int | None:
        """When the next one must have said hello (monotonic clock); None without guests."""
        return next(iter(self.waiting.values()), None)

    def add(self, port: SwitchPort) -> SwitchPort | None:
        """Note a new client; returns the one that must make room for it, if any."""
        oldest = next(iter(self.waiting)) if len(self.waiting) >= MAX_GUESTS else None
        self.waiting[port] = self._wall.monotonic_ns() + round(HELLO_S * 1e9)
        return oldest

    def remove(self, port: SwitchPort) -> None:
        """Forget a client: it has said hello, or has left."""
        self.waiting.pop(port, None)

    def late(self) -> list[SwitchPort]:
        """The clients whose time for a hello is over."""
        now_ns = self._wall.monotonic_ns()
        return [port for port, due_ns in self.waiting.items() if due_ns <= now_ns]
