"""The client's end of a connection to the hub: whole packets in and out, exceptions.

:mod:`railhil.bus.hub.client` has the same exceptions as those of python-can. Deadlines are on the monotonic clock. The
sockets stay in blocking mode, and every call that must not block uses ``MSG_DONTWAIT``, so one thread may wait for
packets while another sends (python-can's periodic tasks do that).
"""

from __future__ import annotations

import contextlib
import os
import select
import socket
import threading
import time
from abc import ABC, abstractmethod
from dataclasses import dataclass
from struct import Struct

from railhil.bus.errors import BusError, BusLost, BusUnavailable
from railhil.bus.packing import MAX_PACKET_SIZE, OWN_MARK


class HubLost(BusLost):
    """The hub is gone, or has disconnected this client (malformed packet, or too far behind)."""


class SendTimeout(BusError):
    """The hub did not accept the frame within the timeout."""


class QueueFull(BusError):
    """The transmit queue is full (ENOBUFS), by order."""


class Refused(BusError):
    """The call is not possible on this client: it is closed, listens only, or was opened without CAN FD or orders."""


class HubUnavailable(BusUnavailable):
    """No hub answers on the channel, or it refuses this client."""


@dataclass(frozen=True, slots=True)
class Failures:
    """The exceptions of one kind of client."""

    lost: type[HubLost] = HubLost
    timeout: type[SendTimeout] = SendTimeout
    full: type[QueueFull] = QueueFull
    refused: type[Refused] = Refused
    unavailable: type[HubUnavailable] = HubUnavailable


PLAIN = Failures()


_RECEIVE_SIZE = MAX_PACKET_SIZE + len(OWN_MARK)
_STREAM_CHUNK_SIZE = 65536
#: ``select`` waits in microseconds but accepts only low descriptors; ``poll`` rounds up to whole milliseconds.
_SELECT_FD_LIMIT = 1024
_GOODBYE_TIMEOUT_S = 1.0
#: Longest wait inside one ``recv`` (SO_RCVTIMEO); reads with an earlier deadline use select first.
_KERNEL_WAIT_S = 0.02
_TIMEVAL = Struct("ll")


def _wait(sock: socket.socket, writable: bool, deadline_s: float | None) -> bool:
    """Wait until the socket is ready; False if the deadline came first. Errors and EOF count as ready."""
    descriptor = sock.fileno()
    timeout_s = None if deadline_s is None else max(deadline_s - time.monotonic(), 0.0)
    if descriptor < _SELECT_FD_LIMIT:
        wanted: tuple[int, ...] = (descriptor,)
        readable_fds, writable_fds, _ = select.select(
            () if writable else wanted, wanted if writable else (), (), timeout_s
        )
        return bool(readable_fds or writable_fds)
    poller = select.poll()
    poller.register(descriptor, select.POLLOUT if writable else select.POLLIN)
    return bool(poller.poll(None if timeout_s is None else timeout_s * 1000))


class HubConnection(ABC):
    """One connection. ``peer`` is the channel name, used in messages; ``failures`` are the exceptions that it
    raises."""

    def __init__(self, sock: socket.socket, peer: str, failures: Failures = PLAIN) -> None:
        self.sock = sock
        self._failures = failures
        self.sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, _TIMEVAL.pack(0, int(_KERNEL_WAIT_S * 1e6)))
        self.peer = peer
        self.is_lost = False

    @abstractmethod
    def send_packet(self, packet: bytes, deadline_s: float | None) -> None:
        """Send one complete packet. Raises :class:`HubLost`, :class:`SendTimeout`."""

    @abstractmethod
    def receive_packet(self, deadline_s: float | None) -> bytes | None:
        """Next packet, or None at the deadline. Raises :class:`HubLost`."""

    def has_buffered(self) -> bool:
        """True if a packet waits in this process, where a poll of the socket does not show it."""
        return False

    def close(self) -> None:
        """Close after everything sent has been delivered to the hub."""
        self.sock.close()

    def _lost(self, why: str) -> HubLost:
        self.is_lost = True
        return self._failures.lost(f"hub at {self.peer}: {why}")

    def _receive(self, size: int, deadline_s: float | None) -> bytes | None:
        """Bytes of one socket read, or None at the deadline."""
        resets = 0
        while resets < 2:
            try:
                if deadline_s is None or deadline_s - time.monotonic() > _KERNEL_WAIT_S:
                    # One system call instead of two: the kernel wakes this read after _KERNEL_WAIT_S at the latest.
                    chunk = self.sock.recv(size)
                elif _wait(self.sock, False, deadline_s):
                    chunk = self.sock.recv(size, socket.MSG_DONTWAIT)
                else:
                    return None
            except BlockingIOError:
                if deadline_s is None or time.monotonic() < deadline_s:
                    continue
                return None
            except ConnectionResetError:
                # The hub closed while packets from this client were unread. The packets that it sent before are still
                # in the receive queue: the next reads get them, then the end of file.
                resets += 1
                continue
            except OSError as error:
                raise self._lost(f"connection lost ({error.strerror})") from None
            if not chunk:
                break
            return chunk
        raise self._lost("connection closed by the hub")

    def _send(self, chunk: bytes, deadline_s: float | None) -> int:
        """Number of bytes accepted by the socket, 0 at the deadline."""
        while True:
            try:
                return self.sock.send(chunk, socket.MSG_DONTWAIT)
            except BlockingIOError:
                if not _wait(self.sock, True, deadline_s):
                    return 0
            except OSError as error:
                raise self._lost(f"connection lost ({error.strerror})") from None

    def _send_timeout(self) -> SendTimeout:
        return self._failures.timeout(f"hub at {self.peer}: transmit buffer full, the frame was not taken in time")


class PacketConnection(HubConnection):
    """AF_UNIX SEQPACKET: one record is one packet."""

    def send_packet(self, packet: bytes, deadline_s: float | None) -> None:
        """See :meth:`HubConnection.send_packet`."""
        if not self._send(packet, deadline_s):
            raise self._send_timeout()

    def receive_packet(self, deadline_s: float | None) -> bytes | None:
        """See :meth:`HubConnection.receive_packet`."""
        return self._receive(_RECEIVE_SIZE, deadline_s)


class StreamConnection(HubConnection):
    """TCP: a big-endian u16 length before each packet."""

    def __init__(self, sock: socket.socket, peer: str, failures: Failures = PLAIN) -> None:
        super().__init__(sock, peer, failures)
        self._incoming = bytearray()
        #: Rest of a packet whose first bytes the socket had already taken at a deadline.
        self._unsent = b""
        self._send_lock = threading.Lock()

    def send_packet(self, packet: bytes, deadline_s: float | None) -> None:
        """See :meth:`HubConnection.send_packet`. A packet partly sent at the deadline counts as sent."""
        with self._send_lock:
            if not self._flush_unsent(deadline_s):
                raise self._send_timeout()
            chunk = len(packet).to_bytes(2, "big") + packet
            taken = self._send(chunk, deadline_s)
            if not taken:
                raise self._send_timeout()
            self._unsent = chunk[taken:]
            self._flush_unsent(deadline_s)

    def _flush_unsent(self, deadline_s: float | None) -> bool:
        while self._unsent:
            taken = self._send(self._unsent, deadline_s)
            if not taken:
                return False
            self._unsent = self._unsent[taken:]
        return True

    def receive_packet(self, deadline_s: float | None) -> bytes | None:
        """See :meth:`HubConnection.receive_packet`."""
        incoming = self._incoming
        while not self.has_buffered():
            chunk = self._receive(_STREAM_CHUNK_SIZE, deadline_s)
            if chunk is None:
                return None
            incoming += chunk
        end = 2 + int.from_bytes(incoming[:2], "big")
        packet = bytes(incoming[2:end])
        del incoming[:end]
        return packet

    def has_buffered(self) -> bool:
        """See :meth:`HubConnection.has_buffered`."""
        incoming = self._incoming
        return len(incoming) >= 2 and len(incoming) >= 2 + int.from_bytes(incoming[:2], "big")

    def close(self) -> None:
        """Half-close, and let the hub read to the end: closing with unread input would discard the output."""
        deadline_s = time.monotonic() + _GOODBYE_TIMEOUT_S
        with contextlib.suppress(OSError, HubLost):
            # The hub may be gone already.
            self._flush_unsent(deadline_s)
            self.sock.shutdown(socket.SHUT_WR)
            while self._receive(_STREAM_CHUNK_SIZE, deadline_s) is not None:
                pass
        self.sock.close()


class ReadinessFd:
    """A descriptor that is readable while the socket has packets, or this process has unread frames of one.

    Selectors and asyncio need it: a packet may hold many frames, and ``recv`` returns one at a time.
    """

    def __init__(self, sock: socket.socket) -> None:
        self._event_fd = os.eventfd(0, os.EFD_NONBLOCK)
        self._epoll = select.epoll()
        self._epoll.register(sock.fileno(), select.EPOLLIN)
        self._epoll.register(self._event_fd, select.EPOLLIN)
        self._is_set = False

    def fileno(self) -> int:
        """The descriptor to wait on."""
        return self._epoll.fileno()

    def set_buffered(self, buffered: bool) -> None:
        """Set whether frames wait in this process."""
        if buffered != self._is_set:
            if buffered:
                os.eventfd_write(self._event_fd, 1)
            else:
                os.eventfd_read(self._event_fd)
            self._is_set = buffered

    def close(self) -> None:
        """Close both descriptors."""
        self._epoll.close()
        os.close(self._event_fd)
