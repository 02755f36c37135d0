"""How a client joins the hub: connects, says hello, reads the answer."""

from __future__ import annotations

import errno
import time
from collections.abc import Callable
from typing import Any

from railhil.bus.hub import wire
from railhil.bus.hub.address import Address, connect, describe, new_socket
from railhil.bus.hub.connection import HubConnection, PacketConnection, StreamConnection
from railhil.bus.hub.failures import PLAIN, Failures, HubLost

ANSWER_TIMEOUT_S = 5.0
_RETRY_PERIOD_S = 0.01
#: Errors on connecting that may also mean that the hub is still starting.
_RETRY_ERRNOS = frozenset((errno.ECONNREFUSED, errno.ENOENT, errno.EAGAIN))


def connected(
    address: Address, deadline_s: float, while_connecting: Callable[[], object], failures: Failures = PLAIN
) -> HubConnection:
    """Connect to a hub that may still be starting, until ``deadline_s`` (monotonic clock).

    ``while_connecting`` is called between two attempts; ``failures``: what this and the connection raise. Raises
    :class:`~railhil.bus.hub.failures.HubUnavailable`.
    """
    while True:
        sock = new_socket(address)
        try:
            # Limited even if the hub is suspended and its backlog is full.
            sock.settimeout(ANSWER_TIMEOUT_S)
            connect(sock, address)
        except OSError as error:
            sock.close()
            remaining_s = deadline_s - time.monotonic()
            if error.errno in _RETRY_ERRNOS and remaining_s > 0:
                while_connecting()
                time.sleep(min(_RETRY_PERIOD_S, remaining_s))
                continue
            raise failures.unavailable(f"no hub at {address}: {describe(error)}") from None
        sock.settimeout(None)
        kind = PacketConnection if address.path is not None else StreamConnection
        return kind(sock, str(address), failures)


def exchange_hello(
    link: HubConnection, hello: dict[str, object], deadline_s: float, failures: Failures = PLAIN
) -> dict[str, Any]:
    """Say hello; returns the properties of the hub. Raises :class:`~railhil.bus.hub.failures.HubUnavailable`."""
    started_s = time.monotonic()
    try:
        link.send_packet(wire.encode_hello(**hello), deadline_s)
        packet = link.receive_packet(deadline_s)
        if packet is None:
            raise failures.unavailable(f"hub at {link.peer}: no answer within {deadline_s - started_s:.0f} s")
        properties = wire.decode_hello(packet)
    except HubLost as error:
        raise failures.unavailable(str(error)) from None
    except ValueError as error:
        raise failures.unavailable(f"hub at {link.peer}: {error}") from None
    if "error" in properties:
        raise failures.unavailable(f"hub at {link.peer}: {properties['error']}")
    return properties
