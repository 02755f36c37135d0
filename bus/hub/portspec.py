"""Other buses as ports of the hub, named ``INTERFACE:CHANNEL[,key=value...]`` on the command line, and opening them."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from railhil.bus.errors import BusUnavailable
from railhil.bus.hub.address import parse_channel
from railhil.bus.hub.batches import HubClient
from railhil.bus.link import open_link
from railhil.bus.link.base import GatewayLink

#: Beginning of the hub's messages.
PROGRAM = "railhil hub"
_HUB_INTERFACE = "railhil"
_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
_SHAPE = "INTERFACE:CHANNEL[,key=value...], e.g. socketcan:can0 or slcan:/dev/ttyACM0,bitrate=500000"
#: Keys that are given before the comma, would let a port receive its own frames, or do not fit one word.
_REFUSED_KEYS = frozenset(("interface", "channel", "receive_own_messages", "can_filters"))
#: The interface to a hub uses these keys only.
_HUB_KEYS = ("fd", "name", "connect_timeout", "bitrate")
#: At its start a gateway waits this long for a hub that may still be starting too.
_HUB_START_S = 10.0
#: Unless the port is lossless, the kernel buffers no more than this for a hub that does not read (some 20 small
#: packets), so that waiting frames do not become old. Twice a full packet.
_HUB_SEND_BUFFER_BYTES = 8192


@dataclass(frozen=True, slots=True)
class PortSpec:
    """``config``: keyword arguments of ``can.Bus``; ``bus``: identity of the bus, the same for two names of one bus."""

    config: dict[str, Any]
    bus: str

    @property
    def transport(self) -> str:
        """``interface:channel`` as given."""
        return f"{self.config['interface']}:{self.config['channel']}"


def parse_port(text: str) -> PortSpec:
    """One ``--port``. Values are typed like those of python-can's ``--bus-kwargs``.

    Raises :class:`BusUnavailable` with one line.
    """
    # A hub without other buses does not load python-can.
    import can
    from can.util import cast_from_string

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
        if interface == _HUB_INTERFACE and key not in _HUB_KEYS:
            allowed = ", ".join(_HUB_KEYS)
            raise BusUnavailable(f"option --port {text}: found key {name!r}, allowed for a hub: {allowed}")
        try:
            config[key] = cast_from_string(value)
        except ValueError:
            # Whole numbers of thousands of digits.
            raise BusUnavailable(f"option --port: key {name!r}: found {value[:20]}..., allowed: a value") from None
        allowed = _allowed(key, config[key])
        if allowed:
            raise BusUnavailable(f"option --port {text}: key {name!r}: found {value!r}, allowed: {allowed}")
    return PortSpec(config, _identity(interface, channel))


def _allowed(key: str, value: str | int | float | bool) -> str:
    """Allowed values of a key that every interface has; empty if the value is one of them."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if key == "fd" and not isinstance(value, bool):
        return "true, false"
    if key == "bitrate" and not (isinstance(value, int) and is_number and value > 0):
        return "bit/s, a whole number above 0"
    if key == "connect_timeout" and not (is_number and 0 <= float(value) < 1e6):
        return "seconds, 0 or more"
    return ""


def parse_ports(texts: Sequence[str], own_channel: str) -> list[PortSpec]:
    """All ports of a hub that listens on ``own_channel``.

    Raises :class:`BusUnavailable` with one line, also if a bus is named twice or the hub itself is named: frames
    would circulate for ever.
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
    """Identity of the bus of a channel name: links resolved, ``device@baudrate`` of serial adapters without the
    rate."""
    if interface == _HUB_INTERFACE:
        address = parse_channel(channel)
        return f"{interface}:{address if address.path is None else os.path.realpath(address.path)}"
    device = channel.partition("@")[0]
    return f"{interface}:{os.path.realpath(device) if '/' in device or os.path.lexists(device) else channel}"


def open_port(spec: PortSpec, lossless: bool) -> GatewayLink:
    """Open the bus of a port at the start; waits for a hub.

    Raises :class:`BusUnavailable` with one line.
    """
    return _opened(spec, lossless, {"connect_timeout": _HUB_START_S} | spec.config)


def open_port_again(spec: PortSpec, lossless: bool) -> GatewayLink | None:
    """Open the bus of a port after an outage, without waiting; None if it is not available."""
    # A SocketCAN interface that is not up can be opened, and would report this only at the first read.
    if spec.config["interface"] == "socketcan":
        from railhil.bus.link.kernel import is_up

        if not is_up(spec.config["channel"]):
            return None
    try:
        return _opened(spec, lossless, spec.config | {"connect_timeout": 0.0})
    except BusUnavailable:
        return None


def _opened(spec: PortSpec, lossless: bool, config: dict[str, Any]) -> GatewayLink:
    if spec.config["interface"] != _HUB_INTERFACE:
        config = spec.config
    elif not lossless:
        config["send_buffer_bytes"] = _HUB_SEND_BUFFER_BYTES
    link = open_link(config, PROGRAM)
    if not isinstance(link, GatewayLink):
        raise BusUnavailable(f"port {link.where}: found a bus of one run, allowed one that a gateway can share")
    link.lossless = lossless
    return link


def takes_fd(link: GatewayLink) -> bool:
    """Whether CAN FD frames can be sent there."""
    if isinstance(link.bus, HubClient):
        return link.bus.takes_fd
    import can

    return link.bus.protocol is not can.CanProtocol.CAN_20


def descriptor_of(link: GatewayLink) -> int | None:
    """The descriptor that becomes readable when frames arrive, if the interface has a reliable one."""
    if not link.has_descriptor:
        return None
    # Interfaces without a descriptor report this in different ways, and one that is closing has none any more.
    with contextlib.suppress(NotImplementedError, *link.failures):
        descriptor = link.bus.fileno()
        return descriptor if descriptor >= 0 else None
    return None
