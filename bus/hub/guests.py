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
    """The clients without a hello, in the order in which they have connected."""

    def __init__(self, wall: WallClock = time) -> None:
        self._wall = wall
        self._due_ns: dict[SwitchPort, int] = {}

    def __bool__(self) -> bool:
        return bool(self._due_ns)

    @property
    def due_ns(self) -> int | None:
        """When the next one must have said hello (monotonic clock); None without guests."""
        return next(iter(self._due_ns.values()), None)

    def add(self, port: SwitchPort) -> SwitchPort | None:
        """Note a new client; returns the one that must make room for it, if any."""
        oldest = next(iter(self._due_ns)) if len(self._due_ns) >= MAX_GUESTS else None
        self._due_ns[port] = self._wall.monotonic_ns() + round(HELLO_S * 1e9)
        return oldest

    def remove(self, port: SwitchPort) -> None:
        """Forget a client: it has said hello, or has left."""
        self._due_ns.pop(port, None)

    def late(self) -> list[SwitchPort]:
        """The clients whose time for a hello is over."""
        now_ns = self._wall.monotonic_ns()
        return [port for port, due_ns in self._due_ns.items() if due_ns <= now_ns]
