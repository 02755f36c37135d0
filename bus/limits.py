"""What each transport does not model, which a user must know before relying on a result."""

from __future__ import annotations

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.bus.hub.modelled import sentence
from railhil.bus.select import PIPES

LIMITS = {
    "local": "no bus at all: one process, no latency, nothing is lost or late, no node dies alone; lockstep only",
    "railhil pipes": "no bus between the processes: no bit rate, no arbitration, no bit errors, no other client; "
    "lockstep only",
    "railhil": sentence(),
    "socketcan vcan": "no bit rate, no arbitration delay, no bit errors, no bus-off; a small buffer can drop frames",
    "socketcan can": "real bus: errors, bus-off and ENOBUFS happen; timing is the adapter's and the kernel's",
    "slcan, serial adapters": "latency of the serial line; the adapter may drop frames without telling",
    "virtual": "one process only",
    "udp_multicast": "neither delivery nor order guaranteed: a run may end as INVALID at any time; never tried here",
}
_OTHER = "an adapter that this bench does not know: timing and losses are the adapter's and its driver's"
_SERIAL = ("slcan", "serial", "robotell")


def limits_of(transport: str) -> str:
    """The sentence for a transport ``interface:channel``."""
    interface, _, channel = transport.partition(":")
    if (interface, channel) == (HUB_INTERFACE, PIPES):
        return LIMITS["railhil pipes"]
    if interface == "socketcan":
        return LIMITS["socketcan vcan" if channel.startswith("vcan") else "socketcan can"]
    return LIMITS["slcan, serial adapters"] if interface in _SERIAL else LIMITS.get(interface, _OTHER)
