"""Other buses as ports of the hub: as the command line names them, ``INTERFACE:CHANNEL[,key=value...]``, and opened."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import can
from can.util import cast_from_string

from bus.errors import BusUnavailable
from bus.hub.address import parse_channel
from bus.link import Link, open_link

#: How the hub begins its lines.
PROGRAM = "railhil hub"
_HUB_INTERFACE = "railhil"
_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
_SHAPE = "INTERFACE:CHANNEL[,key=value...], e.g. socketcan:can0 or slcan:/dev/ttyACM0,bitrate=500000"
#: Both would let a port hear its own frames, or are said before the comma.
_REFUSED_KEYS = frozenset(("interface", "channel", "receive_own_messages"))


@dataclass(frozen=True, slots=True)
class PortSpec:
    """``config``: keyword arguments of ``can.Bus``; ``bus``: what two names of the same bus have in common."""

    config: dict[str, Any]
    bus: str

    @property
    def transport(self) -> str:
        """``interface:channel`` as given."""
        return f"{self.config['interface']}:{self.config['channel']}"


def parse_port(text: str) -> PortSpec:
    """One ``--port``. Values are typed as python-can's ``--bus-kwargs`` are.

    Raises :class:`BusUnavailable` with one line.
    """
    bus, *settings = text.split(",")
    interface, _, channel = bus.partition(":")
    if not interface or not channel:
        raise BusUnavailable(f"option --port: found {text!r}, allowed: {_SHAPE}")
    if interface not in can.VALID_INTERFACES:
        allowed = ", ".join(sorted(can.VALID_INTERFACES))
        raise BusUnavailable(f"option --port {text}: found interface {interface!r}, allowed: {allowed}")
    config: dict[str, Any] = {"interface": interface, "channel": channel}
    for setting in settings:
        name, equals, value = setting.partition("=")
        if not equals or not value or not _KEY.fullmatch(name):
            raise BusUnavailable(f"option --port {text}: found {setting!r}, allowed: key=value")
        key = name.replace("-", "_")
        if key in _REFUSED_KEYS or key in config:
            raise BusUnavailable(f"option --port {text}: key {name!r}: found twice or not for a port of the hub")
        config[key] = cast_from_string(value)
    return PortSpec(config, _identity(interface, channel))


def parse_ports(texts: Sequence[str], own_channel: str) -> list[PortSpec]:
    """All ports of a hub that listens on ``own_channel``.

    Raises :class:`BusUnavailable` with one line, also for a bus that is named twice and for the hub itself: frames
    would go round for ever.
    """
    specs: list[PortSpec] = []
    for text in texts:
        spec = parse_port(text)
        if spec.bus == _identity(_HUB_INTERFACE, own_channel):
            raise BusUnavailable(f"option --port {text}: found this hub itself, allowed: another bus")
        if any(spec.bus == other.bus for other in specs):
            raise BusUnavailable(f"option --port {text}: found the same bus twice, allowed: each bus once")
        specs.append(spec)
    return specs


def _identity(interface: str, channel: str) -> str:
    """The bus behind a channel name: links followed, ``device@baudrate`` of serial adapters without the rate."""
    if interface == _HUB_INTERFACE:
        address = parse_channel(channel)
        return f"{interface}:{address if address.path is None else os.path.realpath(address.path)}"
    device = channel.partition("@")[0]
    return f"{interface}:{os.path.realpath(device) if '/' in device or os.path.lexists(device) else channel}"


def open_port(spec: PortSpec, lossless: bool) -> Link:
    """Open the bus behind a port. Raises :class:`BusUnavailable` with one line."""
    try:
        link = open_link(spec.config, PROGRAM)
    except BusUnavailable:
        raise
    except Exception as error:
        # A driver without its library raises anything.
        raise BusUnavailable(f"bus {spec.transport} cannot be opened: {error}") from error
    link.lossless = lossless
    return link


def descriptor_of(link: Link) -> int | None:
    """The descriptor that becomes readable when frames have come, where the interface has one."""
    try:
        descriptor = link.bus.fileno()
    except (NotImplementedError, can.CanError, OSError):
        return None
    return descriptor if descriptor >= 0 else None
