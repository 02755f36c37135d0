"""The transports: the link that serves an interface, and the properties that the transport does not model.

A new one is a row here and a link with a class method ``opened``, which takes an :class:`Opening`; everything else
that depends on the transport reads this table.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.bus.select import LOCAL, PIPES

if TYPE_CHECKING:
    import can

    from railhil.bus.link.base import Timeouts

_SINGLE = "railhil.bus.link.single:SingleLink"


def _of_the_hub() -> str:
    # Only tables of transports need it.
    from railhil.bus.hub.model_limits import sentence

    return sentence()


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
    unmodelled: str | Callable[[], str]
    channel: str = ".*"
    link: str = _SINGLE

    @property
    def limit(self) -> str:
        """The properties that it does not model, as a sentence."""
        return self.unmodelled if isinstance(self.unmodelled, str) else self.unmodelled()

    def serves(self, interface: str, channel: str) -> bool:
        """Whether it serves this bus."""
        named = not self.interfaces or interface in self.interfaces
        return named and re.fullmatch(self.channel, channel, re.DOTALL) is not None


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
    Transport("railhil", (HUB_INTERFACE,), _of_the_hub, link="railhil.bus.link.batch:BatchLink"),
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
    return transport_of(interface, channel).limit


def limits() -> dict[str, str]:
    """The listed transports, and the properties that each of them does not model."""
    return {one.name: one.limit for one in TRANSPORTS if one.name}
