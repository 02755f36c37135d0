"""Effects of a wire that the plain hub does not have: frames take time, and arbitrate by identifier.

Both are off by default. Each client is a CAN controller with one first-in-first-out transmit queue.

*Bit rate*: one frame at a time is on the wire, for its exact length (:mod:`railhil.bus.hub.bitlength`), and is
delivered at its end. Time is the monotonic clock of the hub process; a hub that is woken late catches up,
so rounding does not accumulate.

*Arbitration*: when the wire becomes idle, the frame with the lowest arbitration key among those at the heads of the
queues is sent first. Without a bit rate the wire is always idle; then the frames found waiting in one pass of
the hub's loop arbitrate. In a tie (the same identifier from two clients, an error on a real bus) the earlier arrival
wins.

Not modelled: acknowledgement, propagation delay; errors do not lengthen a frame (:mod:`railhil.bus.hub.orders`).
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from railhil.bus.hub.bitlength import arbitration_key, frame_bits
from railhil.bus.hub.ports import SwitchPort
from railhil.bus.hub.wire import CLASSIC_SIZE, FD_SIZE, unpack_frames

#: A client with this many waiting frames is not read until some have been sent: its ``send`` then blocks, as with the
#: transmit queue of a real interface. (One more packet may be queued.)
PENDING_LIMIT_FRAMES = 512


class _Pending(NamedTuple):
    arbitration_key: int
    sequence: int
    arrival_ns: int
    duration_ns: int
    source: SwitchPort
    packet: bytes


class WireModel:
    """The wire between the ports; ``bitrate_bps`` None means that frames take no time.

    ``data_bitrate_bps`` applies to CAN FD frames with bit rate switch.
    """

    def __init__(self, bitrate_bps: int | None, data_bitrate_bps: int | None, arbitration: bool) -> None:
        self._nominal_bit_ns = 0.0 if bitrate_bps is None else 1e9 / bitrate_bps
        self._data_bit_ns = 0.0 if data_bitrate_bps is None else 1e9 / data_bitrate_bps
        self._arbitration = arbitration
        self._queues: dict[SwitchPort, deque[_Pending]] = {}
        self._sequence = 0
        self._on_wire: _Pending | None = None
        self._wire_free_ns = 0

    def offer(self, source: SwitchPort, packet: bytes, arrival_ns: int) -> None:
        """Append the frames of a valid packet to the source's queue."""
        queue = self._queues.setdefault(source, deque())
        step = len(packet) if len(packet) == FD_SIZE else CLASSIC_SIZE
        for index, frame in enumerate(unpack_frames(packet)):
            nominal_bits, data_bits = frame_bits(frame)
            duration_ns = round(nominal_bits * self._nominal_bit_ns + data_bits * self._data_bit_ns)
            key = arbitration_key(frame) if self._arbitration else 0
            piece = packet[index * step : (index + 1) * step]
            queue.append(_Pending(key, self._sequence, arrival_ns, duration_ns, source, piece))
            self._sequence += 1

    def is_full(self, source: SwitchPort) -> bool:
        """True if the source must wait before it offers more."""
        return len(self._queues.get(source, ())) >= PENDING_LIMIT_FRAMES

    def due(self, now_ns: int) -> list[tuple[SwitchPort, bytes]]:
        """Frames whose transmission has ended by ``now_ns``: (source, packet) in the order of the wire."""
        delivered: list[tuple[SwitchPort, bytes]] = []
        while True:
            if self._on_wire is None:
                self._on_wire = self._next_on_wire()
            if self._on_wire is None or self._wire_free_ns > now_ns:
                return delivered
            delivered.append((self._on_wire.source, self._on_wire.packet))
            self._on_wire = None

    def next_due_ns(self) -> int | None:
        """After :meth:`due`: when the next frame will end, None when the wire is idle."""
        return None if self._on_wire is None else self._wire_free_ns

    def pending_frames(self) -> int:
        """Frames offered and not yet delivered."""
        return sum(map(len, self._queues.values())) + (self._on_wire is not None)

    def _next_on_wire(self) -> _Pending | None:
        heads = [queue[0] for queue in self._queues.values()]
        if not heads:
            return None
        start_ns = max(self._wire_free_ns, min(head.arrival_ns for head in heads))
        winner = min(head for head in heads if head.arrival_ns <= start_ns)
        queue = self._queues[winner.source]
        queue.popleft()
        if not queue:
            del self._queues[winner.source]
        self._wire_free_ns = start_ns + winner.duration_ns
        return winner
