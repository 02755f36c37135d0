"""The transports: the link that serves an interface, and the properties that the transport does not model.

A new one is a row here and a link with a class method ``opened``, which takes an :class:`Opening`; everything else
that depends on the transport reads this table.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from railhil.bus.can_settings import HUB_INTERFACE, LOCAL, PIPES

if TYPE_CHECKING:
    import can

    from railhil.bus.link.base import Timeouts

_SINGLE = "railhil.bus.link.single:SingleLink"


@dataclass(frozen=True, slots=True)
class Opening:
    """The parameters of opening a link.

    :param config: arguments of ``can.Bus``.
    :param name: the node's name.
    :param say: called with each line that the user should know.
    :param timeouts: how long to wait for an interface that is down.
    """

    config: Mapping[str, Any]
    name: str
    say: Callable[[str], None]
    timeouts: Timeouts

    def bus(self) -> can.BusABC:
        """Open the interface, or open it again.

        :raises Exception: of python-can, or of the driver.
        """
        import can

        return can.Bus(**self.config)


@dataclass(frozen=True, slots=True)
class Transport:
    """One way for the frames of a run.

    :param name: in tables; empty: not listed.
    :param interfaces: of python-can that it serves; none: all others.
    :param unmodelled: properties that it does not model, which a user must know before relying on a result.
    :param channel: regular expression of the channels that it serves.
    :param link: ``module:class`` of its link.
    """

    name: str
    interfaces: tuple[str, ...]
    unmodelled: str
    channel: str = ".*"
    link: str = _SINGLE

    def serves(self, interface: str, channel: str) -> bool:
        """Whether it serves this bus."""
        named = not self.interfaces or interface in self.interfaces
        return named and re.fullmatch(self.channel, channel, re.DOTALL) is not None


class Modelled(NamedTuple):
    """One property of a CAN bus, and what the hub does with it.

    ``option``: of ``railhil bus hub``; empty: always. ``by``: the hub's behaviour, empty: not modelled at all.
    ``without``: the part that is missing even then.
    """

    subject: str
    option: str
    by: str
    without: str


HUB_MODEL = (
    Modelled(
        "order",
        "",
        "every frame reaches every client, in one order for all",
        "sampling, propagation delay, receive overflow (a client 64 MiB behind, `--queue-limit`, is disconnected)",
    ),
    Modelled("acknowledgement", "", "", "a frame counts as sent when nobody hears it"),
    Modelled(
        "bit rate",
        "--bitrate-model",
        "a frame takes its exact length, stuff bits counted",
        "time of error frames and of repeated frames",
    ),
    Modelled(
        "arbitration",
        "--arbitration",
        "frames that wait at the same time leave by identifier",
        "the error of two senders of one identifier",
    ),
    Modelled(
        "bit errors",
        "--faults",
        "by order: TEC and REC of ISO 11898-1, error-passive, repetition, SocketCAN error frames",
        "their cause (bit, stuff, form, CRC), errors at one receiver only, the REC + 8 after an error flag",
    ),
    Modelled(
        "bus-off",
        "--faults",
        "TEC above 255 or by order; restart by order or --restart-ms, after 128 x 11 bits of the bit rate",
        "recovery delayed by traffic; without a bit rate it takes no time",
    ),
    Modelled(
        "two lines",
        "--faults",
        "by order dead at a client; switch-over at once and counted, guard of 16 frames",
        "a break in the middle, a frame lost at the switch-over, the master's order to switch",
    ),
    Modelled(
        "transmit queue",
        "--faults",
        "full by order: ENOBUFS; in real time retried for 20 ms, then dropped, in lockstep dropped at once",
        "its length: frames waiting in it are never sent later",
    ),
)


def hub_limit() -> str:
    """The limits of a hub without options, for a table of transports."""
    never = [row.subject for row in HUB_MODEL if not row.by]
    options: dict[str, list[str]] = {}
    for row in HUB_MODEL:
        if row.option:
            options.setdefault(row.option, []).append(row.subject)
    asked = "; ".join(f"{', '.join(subjects)} only with {option}" for option, subjects in options.items())
    return f"no {' and no '.join(never)}; {asked} (docs/howto/hub.md)"


#: The first entry that serves a bus is its transport.
TRANSPORTS = (
    Transport(
        "local",
        (LOCAL,),
        "no bus at all: one process, no latency, nothing is lost or late, no node dies alone; lockstep only",
    ),
    Transport(
        "railhil pipes",
        (HUB_INTERFACE,),
        "no bus between the processes: no bit rate, no arbitration, no bit errors, no other client; lockstep only",
        channel=f"{PIPES}(:.*)?",
        link="railhil.bus.link.pipes:PipeLink",
    ),
    Transport("railhil", (HUB_INTERFACE,), hub_limit(), link="railhil.bus.hub.link:BatchLink"),
    Transport(
        "socketcan vcan",
        ("socketcan",),
        "no bit rate, no arbitration delay, no bit errors, no bus-off; a small buffer can drop frames",
        channel="vcan.*",
        link="railhil.bus.link.kernel:KernelLink",
    ),
    Transport(
        "socketcan can",
        ("socketcan",),
        "real bus: errors, bus-off and ENOBUFS happen; timing is the adapter's and the kernel's",
        link="railhil.bus.link.kernel:KernelLink",
    ),
    Transport(
        "slcan, serial adapters",
        ("slcan",),
        "latency of the serial line; the adapter may drop frames without telling",
        link="railhil.bus.link.slcan:SlcanLink",
    ),
    Transport(
        "",
        ("serial", "robotell"),
        "latency of the serial line; the adapter may drop frames without telling",
    ),
    Transport("virtual", ("virtual",), "one process only"),
    Transport(
        "udp_multicast",
        ("udp_multicast",),
        "neither delivery nor order guaranteed: a run may end as INVALID at any time; never tried here",
        link="railhil.bus.link.single:EchoLink",
    ),
    Transport("", (), "an adapter that this bench does not know: timing and losses are the adapter's and its driver's"),
)


def transport_of(interface: str, channel: str) -> Transport:
    """The transport of a bus."""
    return next(one for one in TRANSPORTS if one.serves(interface, channel))


def limits_of(transport: str) -> str:
    """The properties that the transport ``interface:channel`` does not model."""
    interface, _, channel = transport.partition(":")
    return transport_of(interface, channel).unmodelled


def limits() -> dict[str, str]:
    """The listed transports, and the properties that each of them does not model."""
    return {one.name: one.unmodelled for one in TRANSPORTS if one.name}
