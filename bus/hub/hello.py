"""A client joins the hub: its settings, the connection to a hub that may still be starting, and the hello."""

from __future__ import annotations

import errno
import os
import socket
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from railhil.bus import packing
from railhil.bus.errors import BusUnavailable
from railhil.bus.frame import Frame
from railhil.bus.hub.address import (
    HUB_START_S,
    Address,
    connect,
    default_channel,
    new_socket,
    parse_channel,
)
from railhil.bus.hub.connection import (
    Failures,
    HubConnection,
    HubLost,
    PacketConnection,
    StreamConnection,
)
from railhil.common.errors import describe_os_error

_ANSWER_TIMEOUT_S = 5.0
_RETRY_PERIOD_S = 0.01
#: Errors on connecting that may also mean that the hub is still starting.
_RETRY_ERRNOS = frozenset((errno.ECONNREFUSED, errno.ENOENT, errno.EAGAIN))


@dataclass(frozen=True, slots=True)
class ClientSettings:
    """How a client joins the hub, besides its channel.

    :param connect_timeout: seconds to wait for a hub that is still starting.
    :param while_connecting: called between two attempts; an exception from it ends the wait.
    :param name: shown in the hub's messages; None: the number of the process.
    :param role: which node of a bench this client is (one of :data:`~railhil.bus.packing.ROLES`); the hub then reports
        which others are connected.
    :param coalesce_frames: receive frames in bulk, at most this many together, and at once when one of the classic
        frames ``wake_on`` arrives (see :mod:`railhil.bus.hub.ports`). 0: each packet as it comes.
    :param send_buffer_bytes: how much the kernel may buffer for a hub that does not read (SO_SNDBUF; a full packet
        needs 4096); None: its own choice.
    :param bitrate: checked against the hub's bit rate model, ignored if it has none.
    """

    receive_own_messages: bool = False
    connect_timeout: float = HUB_START_S
    while_connecting: Callable[[], object] | None = None
    name: str | None = None
    role: str | None = None
    coalesce_frames: int = 0
    wake_on: Sequence[Frame] = ()
    send_buffer_bytes: int | None = None
    bitrate: int | None = None

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> ClientSettings:
        """The settings among the arguments of ``can.Bus``; other settings of real interfaces (such as sample points)
        have no meaning here and are ignored."""
        own = {field.name for field in fields(cls)}
        return cls(**{name: value for name, value in given.items() if name in own})

    def hello(self) -> dict[str, object]:
        """The fields of the client's hello."""
        hello: dict[str, object] = {
            "name": self.name or f"pid {os.getpid()}",
            "receive_own": bool(self.receive_own_messages),
            "hears_faults": True,
        }
        if self.role is not None:
            hello |= {"role": self.role, "hears_roles": True}
        if self.coalesce_frames:
            hello["coalesce_frames"] = int(self.coalesce_frames)
            hello["wake_on"] = [packing.pack_frame(frame).hex() for frame in self.wake_on]
        return hello


def join_hub(channel: str | None, settings: ClientSettings, failures: Failures) -> tuple[HubConnection, dict[str, Any]]:
    """Connect to the hub and say hello; returns the connection and the properties of the hub.

    :param channel: as for :class:`~railhil.bus.hub.batches.HubClient`.
    :param failures: the exceptions that this function and the connection raise.
    :raises HubUnavailable: no hub answers there, or it refuses this client.
    """
    try:
        address = parse_channel(default_channel() if channel is None else str(channel))
    except BusUnavailable as error:
        raise failures.unavailable(str(error)) from None
    deadline_s = time.monotonic() + float(settings.connect_timeout)
    link = connect_to_hub(address, deadline_s, settings.while_connecting, failures)
    try:
        if settings.send_buffer_bytes is not None:
            link.sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, settings.send_buffer_bytes)
        # A hub that starts slowly also answers slowly.
        answer_s = max(deadline_s, time.monotonic() + _ANSWER_TIMEOUT_S)
        properties = _exchange_hello(link, settings.hello(), answer_s, failures)
        bitrate, hub_bitrate = settings.bitrate, properties.get("bitrate_bps")
        if bitrate is not None and hub_bitrate is not None and int(bitrate) != hub_bitrate:
            found = f"bitrate: found {bitrate}, the hub models {hub_bitrate}"
            raise failures.unavailable(f"hub at {address}: {found}")
    except BaseException:
        # The connection must be closed on Ctrl-C, too.
        link.close()
        raise
    return link, properties


def connect_to_hub(
    address: Address, deadline_s: float, while_connecting: Callable[[], object] | None, failures: Failures
) -> HubConnection:
    """Connect to a hub that may still be starting, until ``deadline_s`` (monotonic clock).

    ``while_connecting`` is called between two attempts; ``failures``: the exceptions that this function and the
    connection raise. Raises :class:`~railhil.bus.hub.connection.HubUnavailable`.
    """
    while True:
        sock = new_socket(address)
        try:
            # Limited even if the hub is suspended and its backlog is full.
            sock.settimeout(_ANSWER_TIMEOUT_S)
            connect(sock, address)
        except OSError as error:
            sock.close()
            remaining_s = deadline_s - time.monotonic()
            if error.errno in _RETRY_ERRNOS and remaining_s > 0:
                if while_connecting is not None:
                    while_connecting()
                time.sleep(min(_RETRY_PERIOD_S, remaining_s))
                continue
            raise failures.unavailable(f"no hub at {address}: {describe_os_error(error)}") from None
        sock.settimeout(None)
        kind = PacketConnection if address.path is not None else StreamConnection
        return kind(sock, str(address), failures)


def _exchange_hello(
    link: HubConnection, hello: dict[str, object], deadline_s: float, failures: Failures
) -> dict[str, Any]:
    """Say hello; returns the properties of the hub. Raises :class:`~railhil.bus.hub.connection.HubUnavailable`."""
    started_s = time.monotonic()
    try:
        link.send_packet(packing.encode_hello(**hello), deadline_s)
        packet = link.receive_packet(deadline_s)
        if packet is None:
            raise failures.unavailable(f"hub at {link.peer}: no answer within {deadline_s - started_s:.0f} s")
        properties = packing.decode_hello(packet)
    except HubLost as error:
        raise failures.unavailable(str(error)) from None
    except ValueError as error:
        raise failures.unavailable(f"hub at {link.peer}: {error}") from None
    if "error" in properties:
        raise failures.unavailable(f"hub at {link.peer}: {properties['error']}")
    return properties
