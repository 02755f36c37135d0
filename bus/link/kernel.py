"""The link on kernel SocketCAN: reads and writes frames directly on the raw socket opened by python-can.

python-can's own path costs a :class:`can.Message` per frame, does not report what the kernel has dropped
(``SO_RXQ_OVFL``), and may block in a send. python-can still handles interface, filters and bit timing.
"""

from __future__ import annotations

import fcntl
import select
import socket
import time
from struct import Struct
from typing import Any

from railhil.bus.frame import Frame
from railhil.bus.link.single import SingleLink
from railhil.bus.packing import FD_SIZE, pack_frame, unpack_frames

_SO_RXQ_OVFL = 40
_SO_TIMESTAMPNS = 35
_SIOCGIFFLAGS = 0x8913
_IFF_UP = 1
_IFREQ = Struct("16sH22x")
_TIMEVAL = Struct("ll")
_DROPS = Struct("=I")
_ANCILLARY_BYTES = socket.CMSG_SPACE(_DROPS.size)
#: Requested size; the kernel grants what net.core.rmem_max permits.
_RECEIVE_BUFFER_BYTES = 4 << 20
#: The kernel doubles it and counts some 800 bytes per frame: about 30 frames. With the default of 208 KiB, a bus
#: without a second node would queue 280 frames, half a second of plant traffic, and send them when the node is back.
_SEND_BUFFER_BYTES = 12 << 10
#: Longest wait inside one system call; for shorter waits select is used.
_KERNEL_WAIT_S = 0.02
_BATCH_FRAMES = 64


class KernelLink(SingleLink):
    """:class:`~railhil.bus.link.base.Link` on a ``socketcan`` interface.

    An interface that is taken down and up again keeps its socket and the queue in it; one that is unplugged and plugged
    in again (another interface index) is reopened.
    """

    @property
    def where(self) -> str:
        """See :attr:`Link.where`."""
        return f"socketcan:{self._channel}"

    @property
    def has_descriptor(self) -> bool:
        """See :attr:`GatewayLink.has_descriptor`."""
        return True

    def _use_bus(self) -> None:
        bus: Any = self.bus
        #: Of the sockets before.
        self._lost_before = self.counters["rx_lost"]
        self._failure: OSError | None = None
        sock: socket.socket = bus.socket
        self._socket = sock
        self._channel = str(bus.channel)
        self._index = _index_of(self._channel)
        sock.setblocking(True)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, _TIMEVAL.pack(0, int(_KERNEL_WAIT_S * 1e6)))
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER_BYTES)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER_BYTES)
        sock.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 0)
        sock.setsockopt(socket.SOL_SOCKET, _SO_RXQ_OVFL, 1)

    def _put(self, frame: Frame) -> None:
        self._socket.send(pack_frame(frame), socket.MSG_DONTWAIT)

    def _get(self, timeout_s: float | None) -> list[Frame]:
        if self._failure is not None:
            failure, self._failure = self._failure, None
            raise failure
        packet = self._first(timeout_s)
        frames: list[Frame] = []
        while packet:
            frames += unpack_frames(packet)
            if len(frames) >= _BATCH_FRAMES:
                break
            try:
                packet = self._read(socket.MSG_DONTWAIT)
            except OSError as error:
                # First deliver what was received before the failure.
                self._failure = error
                break
        return frames

    def _first(self, timeout_s: float | None) -> bytes:
        """The next packet; empty at the time-out."""
        if timeout_s is not None and timeout_s <= 0:
            return self._read(socket.MSG_DONTWAIT)
        deadline_s = None if timeout_s is None else time.monotonic() + timeout_s
        while True:
            rest_s = _KERNEL_WAIT_S if deadline_s is None else deadline_s - time.monotonic()
            if rest_s >= _KERNEL_WAIT_S:
                # One system call instead of two: the kernel wakes this read after _KERNEL_WAIT_S at the latest.
                packet = self._read(0)
            elif rest_s > 0 and select.select((self._socket,), (), (), rest_s)[0]:
                packet = self._read(socket.MSG_DONTWAIT)
            else:
                return b""
            if packet:
                return packet

    def _read(self, flags: int) -> bytes:
        """One packet, empty when none is there; notes how many the kernel has dropped on this socket."""
        try:
            packet, ancillary, _, _ = self._socket.recvmsg(FD_SIZE, _ANCILLARY_BYTES, flags)
        except BlockingIOError:
            return b""
        for level, kind, data in ancillary:
            if (level, kind) == (socket.SOL_SOCKET, _SO_RXQ_OVFL):
                self.counters["rx_lost"] = self._lost_before + int(_DROPS.unpack(data)[0])
        return packet

    def _try_again(self) -> bool:
        index = _index_of(self._channel)
        if not index or not is_up(self._channel):
            return False
        if index == self._index:
            return True
        return super()._try_again()


def is_up(channel: str) -> bool:
    """Whether there is a network interface of this name, and it is up."""
    try:
        with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as probe:
            answer = fcntl.ioctl(probe, _SIOCGIFFLAGS, _IFREQ.pack(channel.encode(), 0))
    except OSError:
        # A kernel without CAN, or no interface of this name.
        return False
    return bool(_IFREQ.unpack(answer)[1] & _IFF_UP)


def _index_of(channel: str) -> int:
    """Index of a network interface, 0 when there is none of this name."""
    try:
        return socket.if_nametoindex(channel)
    except OSError:
        # No interface of this name: the only reason for which this call fails.
        return 0
