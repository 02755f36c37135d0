"""The hub's end of a connection. A port never blocks: packets that its peer cannot take yet wait in a bounded queue.

The switch uses nothing but :class:`SwitchPort`, so that another python-can bus can be a port too
(:mod:`railhil.bus.hub.gateway`).

A client that reads in bulk gets its packets together, like a network card's interrupt coalescing: a fast bench spends
most of its time on waking a process for every packet. A recorder requests its packets in bulk, and names the frames for
which it must be woken at once (the polls that it answers). Order and content are unchanged; no packet is held for
longer than :data:`HOLD_S` unless the hub is overloaded.
"""

from __future__ import annotations

import socket
import time
from abc import ABC, abstractmethod
from collections import deque

from railhil.bus.packing import CLASSIC_SIZE, MAX_PACKET_SIZE
from railhil.common.mypyc import mypyc_attr
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


#: Overhead of a queued packet in addition to its bytes: the bytes object and its place in the queue.
QUEUED_PACKET_OVERHEAD_BYTES = 48
#: Requested kernel buffer (silently limited by the kernel), so that a short pause of a reader needs no queue.
_KERNEL_BUFFER_BYTES = 4 << 20
_STREAM_CHUNK_SIZE = 65536


class PortClosed(Exception):
    """The peer has left, and everything it sent has been read."""


class PortFault(Exception):
    """The peer must be disconnected; the text says why, in one line."""


@mypyc_attr(allow_interpreted_subclasses=True)
class SwitchPort(ABC):
    """One port of the switch.

    ``name`` is shown in messages. ``is_member`` is true once the hello has been answered and packets flow.
    ``receive_own`` requests a copy of the port's own packets. ``due_ns`` is the time at which the switch must call
    :meth:`flush` even if the port is not reported writable (monotonic clock); None: not at all.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        #: A client comes and goes by itself; a bus given on the command line does not.
        self.is_client = True
        self.is_member = False
        self.receive_own = False
        #: The client's role in a bench, and whether it is informed about the other nodes.
        self.role: str | None = None
        self.hears_roles = False
        #: The name in its hello, and whether it is told the state of its CAN controller (``--faults``).
        self.client_name = ""
        self.hears_faults = False
        #: Set for a client that reads in bulk.
        self.coalescer: Coalescer | None = None
        #: Packets wait in the queue; the switch calls :meth:`flush` when the port becomes writable.
        self.has_backlog = False
        self.due_ns: int | None = None

    @abstractmethod
    def fileno(self) -> int:
        """Descriptor that becomes readable when :meth:`receive` has packets."""

    @abstractmethod
    def receive(self) -> list[bytes]:
        """Packets that have arrived, oldest first; may be empty.

        Raises :class:`PortClosed`, :class:`PortFault`.
        """

    @abstractmethod
    def send(self, packet: bytes) -> bool:
        """Deliver or queue one packet; True if ``has_backlog`` has become true.

        Raises :class:`PortFault` if the queue exceeds its limit.
        """

    @abstractmethod
    def flush(self) -> None:
        """Deliver queued packets until the peer takes no more; clears ``has_backlog`` after the last."""

    @abstractmethod
    def close(self) -> None:
        """Close the descriptor; queued packets are lost."""

    def statistics(self) -> str:
        """Frames carried and lost by the port, in one line; empty if it does not count them."""
        return ""


class SocketPort(SwitchPort):
    """A client on a SEQPACKET socket: one record is one packet."""

    def __init__(self, sock: socket.socket, name: str, queue_limit_bytes: int) -> None:
        super().__init__(name)
        sock.setblocking(False)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _KERNEL_BUFFER_BYTES)
        self._sock = sock
        self._recv = sock.recv
        self._send = sock.send
        self._queue: deque[bytes] = deque()
        self._queued_bytes = 0
        self._queue_limit_bytes = queue_limit_bytes
        #: The peer takes nothing any more, but packets that it sent before it left are still to be read.
        self._is_deaf = False

    def fileno(self) -> int:
        """See :meth:`SwitchPort.fileno`."""
        return self._sock.fileno()

    def receive(self) -> list[bytes]:
        """See :meth:`SwitchPort.receive`."""
        packet = self._receive_bytes(MAX_PACKET_SIZE + 1)
        return [] if packet is None else [packet]

    def send(self, packet: bytes) -> bool:
        """See :meth:`SwitchPort.send`."""
        if self._is_deaf:
            return False
        if not self.has_backlog:
            try:
                self._send(packet)
                return False
            except BlockingIOError:
                return self._enqueue(packet)
            except OSError:
                # Not yet a reason to drop the port: frames that the peer sent before it closed must still be carried.
                self._is_deaf = True
                return False
        return self._enqueue(packet)

    def flush(self) -> None:
        """See :meth:`SwitchPort.flush`."""
        queue = self._queue
        try:
            while queue:
                self._flush_one(queue)
        except BlockingIOError:
            return
        except OSError:
            # As in send, packets that the peer sent before it left are still to be read.
            self._is_deaf = True
            queue.clear()
            self._queued_bytes = 0
        self.has_backlog = False

    def close(self) -> None:
        """See :meth:`SwitchPort.close`."""
        self._sock.close()

    def _flush_one(self, queue: deque[bytes]) -> None:
        self._send(queue[0])
        self._queued_bytes -= len(queue.popleft()) + QUEUED_PACKET_OVERHEAD_BYTES

    def _enqueue(self, packet: bytes) -> bool:
        self._queued_bytes += len(packet) + QUEUED_PACKET_OVERHEAD_BYTES
        if self._queued_bytes > self._queue_limit_bytes:
            raise PortFault(f"it has fallen behind by more than {self._queue_limit_bytes} bytes of unread packets")
        self._queue.append(packet)
        is_new = not self.has_backlog
        self.has_backlog = True
        return is_new

    def _receive_bytes(self, size: int) -> bytes | None:
        """Bytes of one read, None if there are none now."""
        for _ in range(2):
            try:
                chunk = self._recv(size)
            except BlockingIOError:
                return None
            except ConnectionResetError:
                # The peer closed with packets unread. The packets that it sent are still in the receive queue: read on
                # to the end of file.
                continue
            except OSError as error:
                raise PortFault(f"connection failed ({error.strerror})") from None
            if chunk:
                return chunk
            break
        raise PortClosed


class StreamPort(SocketPort):
    """A client on a TCP socket: a big-endian u16 length before each packet."""

    def __init__(self, sock: socket.socket, name: str, queue_limit_bytes: int) -> None:
        super().__init__(sock, name, queue_limit_bytes)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._incoming = bytearray()

    def receive(self) -> list[bytes]:
        """See :meth:`SwitchPort.receive`."""
        chunk = self._receive_bytes(_STREAM_CHUNK_SIZE)
        if chunk is None:
            return []
        incoming = self._incoming
        incoming += chunk
        packets: list[bytes] = []
        start = 0
        while len(incoming) - start >= 2:
            end = start + 2 + int.from_bytes(incoming[start : start + 2], "big")
            if end - start - 2 > MAX_PACKET_SIZE:
                # Never wait for the rest of a foreign protocol: return it over-long, so that the switch refuses it, and
                # with its first bytes, so that the switch can show them.
                packets.append(bytes(incoming[start : start + 64]).ljust(MAX_PACKET_SIZE + 1, b"\0"))
                break
            if end > len(incoming):
                break
            packets.append(bytes(incoming[start + 2 : end]))
            start = end
        del incoming[:start]
        return packets

    def send(self, packet: bytes) -> bool:
        """See :meth:`SwitchPort.send`."""
        if self._is_deaf:
            return False
        chunk = len(packet).to_bytes(2, "big") + packet
        if not self.has_backlog:
            try:
                taken = self._send(chunk)
            except BlockingIOError:
                taken = 0
            except OSError:
                self._is_deaf = True
                return False
            if taken == len(chunk):
                return False
            chunk = chunk[taken:]
        return self._enqueue(chunk)

    def _flush_one(self, queue: deque[bytes]) -> None:
        chunk = queue[0]
        taken = self._send(chunk)
        if taken < len(chunk):
            queue[0] = chunk[taken:]
            self._queued_bytes -= taken
            raise BlockingIOError
        self._queued_bytes -= len(queue.popleft()) + QUEUED_PACKET_OVERHEAD_BYTES
