"""What a client of the hub raises, without python-can; :mod:`railhil.bus.hub.client` has the same as its exceptions."""

from __future__ import annotations

from dataclasses import dataclass

from railhil.bus.errors import BusError, BusLost, BusUnavailable


class HubLost(BusLost):
    """The hub is gone, or has disconnected this client (malformed packet, or too far behind)."""


class SendTimeout(BusError):
    """The hub did not accept the frame within the timeout."""


class QueueFull(BusError):
    """The transmit queue is full (ENOBUFS), by order."""


class Refused(BusError):
    """What this client cannot do as it was opened: closed, listening only, without CAN FD, without orders."""


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
