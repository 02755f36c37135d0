"""A node's connection to the bus: frames out, frames in, over any python-can interface.

The same node code runs on the hub, on SocketCAN and on a serial adapter. Where the interface can move whole batches
(the hub), the link uses that; elsewhere frame by frame.
"""

from __future__ import annotations

import errno
import time
from collections import Counter
from collections.abc import Sequence
from typing import Any, Protocol

import can

from bus.errors import BusLost, BusUnavailable
from bus.frame import Frame, from_message, to_message

#: A full transmit queue (ENOBUFS) is retried this often, this far apart; python-can raises it at once.
_SEND_RETRIES = 40
_SEND_RETRY_S = 0.0005


class Endpoint(Protocol):
    """What a node needs from its connection."""

    def send(self, frames: Sequence[Frame]) -> None:
        """Queue frames in this order.

        :raises BusLost: when the interface is gone.
        """

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """Frames in bus order, as many as have arrived; empty after ``timeout_s`` (None waits for ever).

        :raises BusLost: when the interface is gone.
        """

    def close(self) -> None:
        """Leave the bus."""


class Link:
    """:class:`Endpoint` on a python-can bus.

    ``counters``: ``sent``, ``received``, ``send_retries`` (transmit queue full), ``send_dropped`` (still full after
    the bounded retry; newest value wins, nothing stale is sent later).
    """

    def __init__(self, bus: can.BusABC) -> None:
        self.bus = bus
        self.counters: Counter[str] = Counter()
        self._send_batch: Any = getattr(bus, "send_frames", None)
        self._receive_batch: Any = getattr(bus, "recv_frames", None)

    def send(self, frames: Sequence[Frame]) -> None:
        """See :meth:`Endpoint.send`."""
        try:
            if self._send_batch is not None:
                self._send_batch(frames)
                self.counters["sent"] += len(frames)
                return
            for frame in frames:
                self._send_one(to_message(frame))
        except (can.CanError, OSError) as error:
            raise BusLost(f"{self.bus.channel_info}: cannot send: {error}") from error

    def _send_one(self, message: can.Message) -> None:
        for _ in range(_SEND_RETRIES):
            try:
                self.bus.send(message)
            except can.CanOperationError as error:
                if errno.ENOBUFS not in (error.error_code, getattr(error.__cause__, "errno", None)):
                    raise
                self.counters["send_retries"] += 1
                time.sleep(_SEND_RETRY_S)
            else:
                self.counters["sent"] += 1
                return
        self.counters["send_dropped"] += 1

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """See :meth:`Endpoint.receive`."""
        try:
            if self._receive_batch is not None:
                frames: list[Frame] = self._receive_batch(timeout_s)
            else:
                message = self.bus.recv(timeout_s)
                frames = [] if message is None else [from_message(message)]
        except (can.CanError, OSError) as error:
            raise BusLost(f"{self.bus.channel_info}: cannot receive: {error}") from error
        self.counters["received"] += len(frames)
        return frames

    def close(self) -> None:
        """See :meth:`Endpoint.close`."""
        self.bus.shutdown()


def open_link(config: dict[str, Any]) -> Link:
    """Open a python-can interface from ``can.Bus`` keyword arguments (absent ones come from ``can.rc``, environment).

    :raises BusUnavailable: one line that names interface and channel.
    """
    try:
        return Link(can.Bus(**config))
    except (can.CanError, OSError, ValueError, ImportError, TypeError) as error:
        where = f"{config.get('interface', 'default interface')}:{config.get('channel', 'default channel')}"
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise BusUnavailable(f"bus {where} cannot be opened: {reason}") from error
