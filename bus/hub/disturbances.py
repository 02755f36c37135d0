"""Orders that disturb the bus, to a hub with the option ``--faults``, and the notices with which it answers.

An order is a packet like any other and has its place in the total order: it does not touch frames carried before it.
(With a bit rate it does touch frames that still wait for the wire.) ``who`` is the role of a node, or the name with
which a client has said hello; several clients may have it.

=========== =================================================================================================
order       effect on each client ``who``
=========== =================================================================================================
``errors``  errors destroy its next ``count`` attempts to send; every attempt counts (:mod:`..cancontroller`)
``passive`` its CAN controller is error-passive and stays so (``on``), or the traffic decides again
``bus_off`` its CAN controller leaves the bus at once, as after 32 errors in a row
``restart`` its CAN controller returns after 128 times 11 recessive bits; without a bit rate at once
``line``    its ``line`` A or B is ``dead`` or alive again (:mod:`..lines`)
``full``    its transmit queue is full (``on``), or has room again; it does not send meanwhile
=========== =================================================================================================

The wire format is described in :mod:`railhil.bus.packing`.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Protocol

from railhil.bus.hub.cancontroller import BUS_OFF, ERROR_ACTIVE

NAMES = ("A", "B")
#: Frames for which a receiver stays on the line to which it has switched.
GUARD_FRAMES = 16


class Lines:
    """A client's two redundant lines, A and B, as the MVB has them.

    Every frame is sent on both lines at once. A receiver takes it from its trusted line and watches the other one. A
    frame that comes on the other line alone makes the receiver switch over and take it from there. If the last
    switch-over was less than :data:`GUARD_FRAMES` frames ago, the frame is lost instead. A client whose lines are both
    dead is cut off.

    A dead line is a failure of the client's own connection to it: the client then neither sends nor hears there. Not
    modelled: a break in the middle of a line, a frame lost at the switch-over itself, lines that disturb each other,
    the master's order to switch over. The length of the guard is our own choice.

    :ivar dead: names of its dead lines.
    :ivar trusted: the line from which it takes frames.
    :ivar switch_overs: number of changes of that line.
    :ivar guard_frames: frames until it may do so again.
    """

    def __init__(self) -> None:
        self.dead: set[str] = set()
        self.trusted = NAMES[0]
        self.switch_overs = 0
        self.guard_frames = 0

    def shared(self, other: Lines) -> list[str]:
        """Names of the lines that are alive at both clients."""
        return [name for name in NAMES if name not in self.dead and name not in other.dead]

    def hears(self, sender: Lines, frames: int) -> bool:
        """Whether frames of ``sender`` arrive here; may switch over."""
        alive = self.shared(sender)
        if not alive:
            return False
        guarded = self.guard_frames > 0
        self.guard_frames = max(self.guard_frames - frames, 0)
        if self.trusted in alive:
            return True
        if guarded:
            return False
        self.trusted = alive[0]
        self.switch_overs += 1
        self.guard_frames = GUARD_FRAMES
        return True


_ERRORS_MAX = 1_000_000


@dataclass(frozen=True, slots=True)
class Order:
    """One order; the module's table lists ``what``. ``count``: only for ``errors``; ``line``: only for ``line``;
    ``on``: the line is dead, the queue is full, the controller is held error-passive.

    :raises ValueError: one line with key, value found and values allowed.
    """

    what: str
    who: str
    count: int = 1
    line: str = "A"
    on: bool = True

    def __post_init__(self) -> None:
        _demand("what", self.what, self.what in _WORDS, ", ".join(_WORDS))
        _demand("who", self.who, isinstance(self.who, str) and bool(self.who), "a role or the name of a client")
        is_count = isinstance(self.count, int) and not isinstance(self.count, bool)
        _demand("count", self.count, is_count and 1 <= self.count <= _ERRORS_MAX, f"1..{_ERRORS_MAX}")
        _demand("line", self.line, self.line in NAMES, ", ".join(NAMES))
        _demand("on", self.on, isinstance(self.on, bool), "true, false")

    def encoded(self) -> dict[str, Any]:
        """JSON value for :func:`order_of`."""
        return asdict(self)


_WORDS = ("errors", "passive", "bus_off", "restart", "line", "full")


def _demand(key: str, found: object, is_right: bool, allowed: str) -> None:
    if not is_right:
        raise ValueError(f"order: key {key!r}: found {found!r:.60}, allowed: {allowed}")


def order_of(document: object) -> Order:
    """The order in a packet. Raises ValueError with one line."""
    if not isinstance(document, dict) or not {"what", "who"} <= document.keys() <= {*Order.__slots__}:
        raise ValueError(f"order: found {document!r:.60}, allowed: {', '.join(Order.__slots__)}")
    return Order(**document)


@dataclass(frozen=True, slots=True)
class Host:
    """State of a client's CAN controller and its two lines, as reported to their host."""

    state: str = ERROR_ACTIVE
    tec: int = 0
    rec: int = 0
    line: str = NAMES[0]
    switch_overs: int = 0
    full: bool = False

    @property
    def is_off(self) -> bool:
        """Whether the CAN controller is bus-off."""
        return self.state == BUS_OFF


class Disturber(Protocol):
    """Takes orders, and tells the state of the own CAN controller."""

    @property
    def host(self) -> Host:
        """State of the own CAN controller and lines, according to the packets received so far."""

    def is_cut_off(self, node: str) -> bool:
        """Whether that node cannot answer the packet that was sent last."""

    def order(self, order: Order) -> None:
        """Disturb the bus from the next packet on.

        :raises BusLost: the hub is gone.
        """


class Notices:
    """A client's side of the notices.

    :ivar host: state of its own CAN controller and lines, as of the packets read so far.
    :ivar missed: orders of this client that found no client with their ``who``, oldest first.
    """

    def __init__(self) -> None:
        self.host = Host()
        self.missed: list[str] = []
        self._sent = 0
        self._cut_off: set[str] = set()

    def sending(self) -> None:
        """Note that a packet of frames is sent."""
        self._sent += 1
        self._cut_off.clear()

    def take(self, notice: dict[str, Any]) -> None:
        """Take a notice of the hub."""
        if "host" in notice:
            self.host = Host(**notice["host"])
        elif "missed" in notice:
            self.missed.append(notice["missed"])
        elif notice.get("packet", self._sent) == self._sent:
            self._cut_off.update(notice["cut_off"])

    def is_cut_off(self, role: str) -> bool:
        """Whether that node cannot answer the last packet: it did not get the packet, or its answer did not get
        here."""
        return role in self._cut_off
