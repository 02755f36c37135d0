"""python-can interface ``railhil``: a client of the hub.

``python -m can.viewer -i railhil -c PATH``, ``can.logger`` and ``cantools monitor`` attach with it unchanged. railhil's
own nodes use :class:`~railhil.bus.hub.batches.HubClient` without python-can, which avoids a :class:`can.Message` per
frame.
"""

from __future__ import annotations

import errno
import time
from typing import Any

import can

from railhil.bus import packing
from railhil.bus.hub import connection as plain
from railhil.bus.hub.batches import HubClient
from railhil.bus.hub.cancontroller import ERROR_PASSIVE
from railhil.bus.hub.disturbances import Host

#: Name in ``Message.channel``: neutral, so that a log does not depend on the path of the socket.
CHANNEL_NAME = "railhil"


class HubLost(plain.HubLost, can.CanOperationError):
    """:class:`railhil.bus.hub.connection.HubLost` for python-can."""


class SendTimeout(plain.SendTimeout, can.CanOperationError, can.CanTimeoutError):
    """:class:`railhil.bus.hub.connection.SendTimeout` for python-can."""


class QueueFull(plain.QueueFull, can.CanOperationError):
    """:class:`railhil.bus.hub.connection.QueueFull` for python-can."""

    def __init__(self, message: str) -> None:
        super().__init__(message, error_code=errno.ENOBUFS)


class Refused(plain.Refused, can.CanOperationError):
    """:class:`railhil.bus.hub.connection.Refused` for python-can."""


class HubUnavailable(plain.HubUnavailable, can.CanInitializationError):
    """:class:`railhil.bus.hub.connection.HubUnavailable` for python-can."""


class HubBus(HubClient, can.BusABC):
    """:class:`~railhil.bus.hub.batches.HubClient` as a bus of python-can.

    ``send`` and ``send_frames`` may be mixed, and so may ``recv`` and ``recv_frames``. ``Message.timestamp`` is the
    wall clock at reception by this client.
    """

    failures = plain.Failures(HubLost, SendTimeout, QueueFull, Refused, HubUnavailable)

    def __init__(self, channel: str | None = None, can_filters: Any = None, **settings: Any) -> None:
        """Connect to the hub, with the settings of :class:`~railhil.bus.hub.batches.HubClient`.

        Raises :class:`HubUnavailable`.
        """
        HubClient.__init__(self, channel, **settings)
        self._can_protocol = can.CanProtocol.CAN_FD if self.takes_fd else can.CanProtocol.CAN_20
        can.BusABC.__init__(self, channel=self.channel_info, can_filters=can_filters)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send one message.

        ``timeout``: seconds to wait until the hub takes it, None waits for ever, 0 tries once. Raises
        :class:`SendTimeout` (a ``can.CanOperationError`` and ``can.CanTimeoutError``), :class:`HubLost`,
        ValueError for an impossible frame.
        """
        if msg.is_fd and not self._fd_enabled:
            raise Refused("CAN FD frame on a bus opened without fd=True")
        self._send(packing.pack_message(msg), None if timeout is None else time.monotonic() + timeout)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if not self._packet and not self._next_packet(None if timeout is None else time.monotonic() + timeout):
            return None, False
        packet, offset = self._packet, self._offset
        message = packing.unpack_message(packet, offset, self._timestamp_s, CHANNEL_NAME, self._packet_is_own)
        offset += packing.CLASSIC_SIZE
        if offset >= len(packet) or len(packet) == packing.FD_SIZE:
            self._packet, self._offset = b"", 0
        else:
            self._offset = offset
        self._update_readiness()
        return message, False

    def shutdown(self) -> None:
        """Leave the hub; everything sent before is delivered. May be called again."""
        can.BusABC.shutdown(self)
        HubClient.shutdown(self)

    @property
    def state(self) -> can.BusState:
        """ACTIVE, PASSIVE (listen only, or error-passive), or ERROR once the hub is gone or while bus-off."""
        host = Host() if self.notices is None else self.notices.host
        if self._link is None or self._link.is_lost or host.is_off:
            return can.BusState.ERROR
        is_passive = self._is_passive or host.state == ERROR_PASSIVE
        return can.BusState.PASSIVE if is_passive else can.BusState.ACTIVE

    @state.setter
    def state(self, new_state: can.BusState) -> None:
        if new_state is can.BusState.ERROR:
            raise ValueError("state: found ERROR, allowed: ACTIVE, PASSIVE")
        self._is_passive = new_state is can.BusState.PASSIVE
