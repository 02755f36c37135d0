"""Packets for a client that reads in bulk: delivered together, like a network card's interrupt coalescing.

A fast bench spends most of its time on waking a process for every packet. A recorder does not need that: it requests
its packets in bulk, and names the frames for which it must be woken at once (the polls that it answers). Order and
content are unchanged; no packet is held for longer than :data:`HOLD_S` unless the hub is overloaded.
"""

from __future__ import annotations

import time

from railhil.bus.hub.wire import CLASSIC_SIZE, MAX_PACKET_SIZE
from railhil.common.patience import WallClock

#: Longest time that a packet is held back.
HOLD_S = 0.02
_WAKE_LIMIT = 64


class Coalescer:
    """The pending packets of one client.

    :param limit_frames: number of held frames at which they are delivered, 1..256.
    :param wake_on: packed classic frames (16 bytes); a packet that ends with one is delivered at once.
    """

    def __init__(self, limit_frames: int, wake_on: frozenset[bytes], wall: WallClock = time) -> None:
        self._limit_bytes = min(limit_frames * CLASSIC_SIZE, MAX_PACKET_SIZE)
        self._wake_on = wake_on
        self._wall = wall
        self._held = bytearray()
        self._since_s = 0.0

    def take(self, packet: bytes) -> list[bytes]:
        """Packets to deliver now, in order, after ``packet`` has arrived."""
        held = self._held
        if len(packet) % CLASSIC_SIZE:
            # A CAN FD frame or an own packet is delivered separately.
            return [*self.flush(), packet]
        ready: list[bytes] = []
        if len(held) + len(packet) > MAX_PACKET_SIZE:
            ready = self.flush()
        now_s = self._wall.monotonic()
        if not held:
            self._since_s = now_s
        held += packet
        late = now_s - self._since_s > HOLD_S
        if len(held) >= self._limit_bytes or late or packet[-CLASSIC_SIZE:] in self._wake_on:
            ready += self.flush()
        return ready

    @property
    def due_ns(self) -> int | None:
        """Latest time for delivering the held packets (monotonic clock); None when nothing is held."""
        return round((self._since_s + HOLD_S) * 1e9) if self._held else None

    def flush(self) -> list[bytes]:
        """The held frames as one packet, if any."""
        if not self._held:
            return []
        packet = bytes(self._held)
        self._held.clear()
        return [packet]


def coalescer_of(hello: dict[str, object]) -> Coalescer | None:
    """The coalescer requested by a client's hello (``coalesce_frames``, ``wake_on``), or None.

    Raises ValueError with one line for invalid values.
    """
    limit = hello.get("coalesce_frames", 0)
    if not isinstance(limit, int) or not 0 <= limit <= MAX_PACKET_SIZE // CLASSIC_SIZE:
        raise ValueError(
            f"hello: key 'coalesce_frames': found {limit!r}, allowed: 0..{MAX_PACKET_SIZE // CLASSIC_SIZE}"
        )
    names = hello.get("wake_on", [])
    try:
        frames = frozenset(bytes.fromhex(name) for name in names)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        frames = frozenset((b"",))
    if len(frames) > _WAKE_LIMIT or any(len(frame) != CLASSIC_SIZE for frame in frames):
        raise ValueError(
            f"hello: key 'wake_on': found {names!r:.60}, allowed: up to {_WAKE_LIMIT} packed frames in hex"
        )
    return Coalescer(limit, frames) if limit else None
