"""The base of all links: the interface that a node needs, outages, the counters, and the messages about them."""

from __future__ import annotations

import contextlib
import time
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Final, Protocol

from railhil.bus.errors import BusLost
from railhil.bus.frame import Frame
from railhil.bus.sent import SentFrames
from railhil.common.mypyc import mypyc_attr
from railhil.common.patience import Lifelines, WallClock

if TYPE_CHECKING:
    import can

    from railhil.bus.hub.batches import HubClient
    from railhil.bus.hub.disturbances import Disturber


@dataclass(frozen=True, slots=True)
class Timeouts:
    """How long a link waits, in s on the wall clock.

    :ivar give_up_s: for an interface that is down, and in lockstep for a full transmit queue; then the node ends.
    :ivar look_again_s: between two checks whether the interface is back.
    :ivar queue_full_s: in real time for a full transmit queue (ENOBUFS); then the frames are dropped.
    :ivar opening_s: time after opening a serial port in which answers may still belong to the opening commands.
    """

    give_up_s: float = 30.0
    look_again_s: float = 0.1
    queue_full_s: float = 0.02
    opening_s: float = 1.0


#: Default of every link.
TIMEOUTS = Timeouts()


class Outage:
    """One outage.

    :ivar reason: the cause, as one clause.
    :ivar bus_off: the interface is present, but its CAN controller is bus-off.
    """

    def __init__(
        self, reason: str, *, bus_off: bool = False, timeouts: Timeouts = TIMEOUTS, wall: WallClock = time
    ) -> None:
        self.reason = reason
        self.bus_off = bus_off
        self._timeouts = timeouts
        self._wall = wall
        self._since_s = wall.monotonic()
        self._look_s = self._since_s + (0.0 if bus_off else timeouts.look_again_s)

    @property
    def lasted_s(self) -> float:
        """Wall time since it began."""
        return self._wall.monotonic() - self._since_s

    @property
    def hopeless(self) -> bool:
        """True when the node has waited long enough and gives up."""
        return self.lasted_s > self._timeouts.give_up_s

    def until_look_s(self) -> float:
        """Wall time until the interface should be checked again, at least 0."""
        return max(0.0, self._look_s - self._wall.monotonic())

    def looked(self) -> None:
        """Note that it was checked and is not back."""
        self._look_s = self._wall.monotonic() + self._timeouts.look_again_s


_TROUBLE: Final = (
    "outages", "bus_off", "error_frames", "send_dropped", "send_retries", "rx_lost", "garbage", "adapter_stuck",
    "adapter_refused", "error_passive", "switch_overs",
)  # fmt: skip


class Endpoint(Protocol):
    """The interface that a node needs from its connection."""

    #: Lockstep: if the queue is full or the interface down, a frame waits; otherwise it is dropped and counted.
    lossless: bool

    @property
    def is_down(self) -> bool:
        """True while the interface is gone or bus-off."""

    @property
    def is_private(self) -> bool:
        """True when only the nodes of this run can be on the bus, each of them once."""

    def send(self, frames: Sequence[Frame]) -> None:
        """Queue frames in this order.

        :raises BusLost: when the interface is gone for good.
        """

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """Frames in bus order, as many as have arrived; empty after ``timeout_s`` (None waits for ever).

        :raises BusLost: when the interface is gone for good.
        """

    def has_ended(self, node: str) -> bool:
        """True when another node is known to have ended, so that waiting for it is useless."""

    def is_cut_off(self, node: str) -> bool:
        """True when that node cannot answer the last packet, because a fault separates the two nodes."""

    def close(self) -> None:
        """Leave the bus."""


class PackedEnd(Protocol):
    """Interface of a link for packed classic frames (:mod:`railhil.bus.packing`)."""

    def send_packed(self, packet: bytes) -> None:
        """:meth:`Link.send`."""

    def send_early(self, packet: bytes) -> bool:
        """Pass frames to the controller before :meth:`send_packed` would, so that it can work beside this node.

        The recorder gets them with the next packet. Returns False when they have to be sent instead.
        """

    def receive_packed(self, timeout_s: float | None) -> bytes:
        """:meth:`Link.receive`."""


@mypyc_attr(allow_interpreted_subclasses=True)
class Link(ABC):
    """:class:`Endpoint` on a python-can bus, or on the hub.

    ``counters``: ``sent``, ``received``, ``send_retries`` (transmit queue full), ``send_dropped`` (still full after
    the bounded retry, or interface down; newest value wins, nothing stale is sent later), ``rx_lost`` (receive buffer
    overflowed, where the kernel reports it), ``garbage`` (unreadable input of a serial adapter), ``error_frames``,
    ``bus_off``, ``outages``.

    :param say: called with a one-line message when something has happened that the user should know.
    """

    #: Exceptions that the bus raises when the interface fails.
    failures: ClassVar[tuple[type[Exception], ...]]

    def __init__(self, bus: can.BusABC | HubClient, say: Callable[[str], None] | None = None) -> None:
        self.bus: can.BusABC | HubClient = bus
        self.lossless = False
        self.counters: Counter[str] = Counter()
        #: Called while a frame waits for the bus in lockstep; an exception from it ends the wait.
        self.while_waiting: Callable[[], None] = lambda: None
        #: Pipes to the other nodes, if they were started together.
        self.lifelines = Lifelines()
        #: Notes the frames that this node sends, if it is asked to.
        self.sent: SentFrames | None = None
        self._say = say or (lambda line: None)

    @property
    def where(self) -> str:
        """The interface, as named in messages."""
        return str(self.bus.channel_info)

    @property
    def is_down(self) -> bool:
        """See :attr:`Endpoint.is_down`."""
        return False

    @property
    def is_private(self) -> bool:
        """See :attr:`Endpoint.is_private`."""
        return False

    @property
    def disturber(self) -> Disturber | None:
        """Receiver of orders to disturb the bus; None: there is none. Only a hub with ``--faults`` has one."""
        return None

    @property
    def packed(self) -> PackedEnd | None:
        """The same link for packed frames; None: there is no such way."""
        return None

    @abstractmethod
    def send(self, frames: Sequence[Frame]) -> None:
        """See :meth:`Endpoint.send`."""

    @abstractmethod
    def receive(self, timeout_s: float | None) -> list[Frame]:
        """See :meth:`Endpoint.receive`."""

    def close(self) -> None:
        """See :meth:`Endpoint.close`."""
        with contextlib.suppress(*self.failures):
            # A lost adapter cannot be closed properly; the reason has already been reported.
            self.bus.shutdown()

    def has_ended(self, node: str) -> bool:
        """See :meth:`Endpoint.has_ended`."""
        return self.lifelines.has_ended(node)

    def is_cut_off(self, node: str) -> bool:
        """See :meth:`Endpoint.is_cut_off`; only the hub tells."""
        return False

    def may_deliver(self, node: str) -> bool:
        """Whether frames of a node that has ended may still be on their way; False where that cannot be known."""
        return False

    def take_gap_ns(self) -> int:
        """Wall time without frames because of an outage that is now over; 0 when there was none since the last call."""
        return 0

    def tell_trouble(self) -> None:
        """Report losses and failures of this connection, if any; called at the end of a node."""
        found = [f"{key} {self.counters[key]}" for key in _TROUBLE if self.counters[key]]
        if found:
            self._say(f"{self.where}: {', '.join(found)}")

    def _lost(self, reason: str) -> BusLost:
        return BusLost(f"{self.where}: {reason}")


@mypyc_attr(allow_interpreted_subclasses=True)
class GatewayLink(Link):
    """A link that the hub's gateway can use: it accepts frames without blocking."""

    @property
    def has_rest(self) -> bool:
        """True while the interface has accepted only part of a frame; :meth:`offer` and :meth:`receive` pass on the
        rest."""
        return False

    @property
    def has_descriptor(self) -> bool:
        """Whether ``bus.fileno()`` becomes readable when frames have arrived, and :meth:`receive` respects its
        time-out."""
        return True

    @abstractmethod
    def offer(self, frames: Sequence[Frame]) -> int:
        """Pass on as many of the frames, from the first, as the interface accepts without blocking; returns how many.

        Without frames, pass on only the rest of a frame that it has accepted in part.

        :raises BusLost: like :meth:`send`.
        """
