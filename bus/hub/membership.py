"""Clients of the switch: accepting, hello, roles, leaving, and the descriptors that its loop watches."""

from __future__ import annotations

import select
import socket
import time
from collections.abc import Callable, Sequence

from railhil.bus.hub.disturbed_bus import Disturbance
from railhil.bus.hub.ports import SocketPort, StreamPort, SwitchPort, coalescer_of
from railhil.bus.packing import decode_hello, encode_hello, encode_roles, role_of
from railhil.common.errors import describe_os_error
from railhil.common.patience import WallClock

MAX_CLIENTS = 256
READ = select.EPOLLIN
WRITE = select.EPOLLOUT


class Membership:
    """Ports of one switch.

    :param tell: gives a packet to one member.
    :param report: called with one line for each client that is disconnected.
    :param bus_ports: exist from the beginning to the end.

    The other parameters are those of :class:`~railhil.bus.hub.switch.Switch`.

    :ivar ports: all ports by descriptor, also those that have not said hello.
    :ivar members: ports between which packets are carried; replaced, never changed in place: a port may be dropped
        while packets are being carried.
    :ivar guests: clients that have not said hello yet.
    :ivar bulk_readers: whether a member reads in bulk.
    :ivar is_deserted: the last client has left, once at least.
    """

    def __init__(
        self,
        listener: socket.socket,
        epoll: select.epoll,
        *,
        queue_limit_bytes: int,
        properties: dict[str, object],
        report: Callable[[str], None],
        tell: Callable[[SwitchPort, bytes], None],
        disturbance: Disturbance | None,
        bus_ports: Sequence[SwitchPort],
    ) -> None:
        self.ports: dict[int, SwitchPort] = {}
        self.members: list[SwitchPort] = list(bus_ports)
        self.guests = Guests()
        self.bulk_readers = False
        self.is_deserted = False
        self._listener = listener
        self._epoll = epoll
        self._queue_limit_bytes = queue_limit_bytes
        self._properties = properties
        self._report = report
        self._tell = tell
        self._disturbance = disturbance
        # Event mask with which each port is registered; 0 means that it is not registered.
        self._watched: dict[SwitchPort, int] = {}
        self._is_accepting = True
        self._accepted = 0
        epoll.register(listener.fileno(), READ)
        for port in bus_ports:
            self._watch(port)

    # --- descriptors --------------------------------------------------------------------------------------

    def is_watched(self, port: SwitchPort) -> bool:
        """Whether a port is still there."""
        return port in self._watched

    def unread(self) -> list[SwitchPort]:
        """Ports whose input is not watched."""
        return [port for port, events in self._watched.items() if not events & READ]

    def update(self, port: SwitchPort, is_paused: bool) -> None:
        """Let epoll watch the port's input unless it is paused, and its output while it has a backlog."""
        before = self._watched.get(port)
        if before is None:
            return
        events = (0 if is_paused else READ) | (WRITE if port.has_backlog else 0)
        if events == before:
            return
        self._watched[port] = events
        fd = port.fileno()
        if not events:
            # An empty mask is not enough: epoll would report a hang-up again and again.
            self._epoll.unregister(fd)
        elif not before:
            self._epoll.register(fd, events)
        else:
            self._epoll.modify(fd, events)

    def _watch(self, port: SwitchPort) -> None:
        self.ports[port.fileno()] = port
        self._watched[port] = READ
        self._epoll.register(port.fileno(), READ)

    # --- coming -------------------------------------------------------------------------------------------

    def accept(self) -> None:
        """Take a client that wants to connect; it must say hello next."""
        try:
            sock, _ = self._listener.accept()
        except BlockingIOError:
            return
        except OSError as error:
            # Probably out of descriptors: stop listening until a client leaves, instead of failing in a busy loop.
            self._report(f"no more clients are accepted until one leaves: {describe_os_error(error)}")
            self._epoll.unregister(self._listener.fileno())
            self._is_accepting = False
            return
        self._accepted += 1
        kind = SocketPort if sock.family == socket.AF_UNIX else StreamPort
        port = kind(sock, f"client {self._accepted}", self._queue_limit_bytes)
        self._watch(port)
        oldest = self.guests.add(port)
        if oldest is not None:
            self.drop(oldest, "no hello yet, and others want to connect")

    def stop_accepting(self) -> None:
        """Accept no more clients."""
        if self._is_accepting:
            self._epoll.unregister(self._listener.fileno())
        # Prevents a client that leaves from enabling the listener again.
        self._is_accepting = True

    def greet(self, port: SwitchPort, packet: bytes) -> bool:
        """Answer the hello and admit the port; False if it is disconnected instead."""
        try:
            hello = decode_hello(packet)
            port.coalescer = coalescer_of(hello)
            role = role_of(hello)
            if sum(member.is_client for member in self.members) >= MAX_CLIENTS:
                raise ValueError(f"{MAX_CLIENTS} clients are connected, no more are allowed")
        except ValueError as error:
            port.send(encode_hello(error=str(error)))
            self.drop(port, str(error))
            return False
        name = hello.get("name")
        if isinstance(name, str) and name:
            port.name += f" {name[:80]!r}"
            port.client_name = name[:80]
        port.role = role
        port.receive_own = hello.get("receive_own") is True
        port.hears_roles = hello.get("hears_roles") is True
        port.hears_faults = self._disturbance is not None and hello.get("hears_faults") is True
        port.send(encode_hello(**self._properties))
        port.is_member = True
        self.guests.remove(port)
        if self._disturbance is not None:
            self._disturbance.join(port)
        self._set_members([*self.members, port])
        self._tell_roles()
        return True

    # --- going --------------------------------------------------------------------------------------------

    def drop(self, port: SwitchPort, reason: str) -> None:
        """Disconnect a port and say why."""
        self._report(f"{port.name} is disconnected: {reason}")
        self.leave(port)

    def leave(self, port: SwitchPort) -> None:
        """A port is gone."""
        fd = port.fileno()
        if self.ports.get(fd) is not port:
            return
        del self.ports[fd]
        if self._watched.pop(port):
            self._epoll.unregister(fd)
        port.close()
        self.guests.remove(port)
        if self._disturbance is not None:
            self._disturbance.leave(port)
        if not self._is_accepting:
            self._epoll.register(self._listener.fileno(), READ)
            self._is_accepting = True
        self._set_members([member for member in self.members if member is not port])
        if port.role is not None:
            self._tell_roles()
        if port.is_member and not any(member.is_client for member in self.members):
            self.is_deserted = True

    def close(self) -> None:
        """Close the clients' ports; listening socket and buses remain with their owner."""
        for port in self.ports.values():
            if port.is_client:
                port.close()
        self.ports.clear()
        self.members = []

    def _set_members(self, members: list[SwitchPort]) -> None:
        self.members = members
        self.bulk_readers = any(member.coalescer is not None for member in members)

    def _tell_roles(self) -> None:
        """Report which nodes of a bench are connected now, after all packets carried so far."""
        for port in self.members:
            if port.hears_roles:
                # Built again for each port: a port that is dropped here is no longer listed.
                here = encode_roles([member.role for member in self.members if member.role is not None])
                self._tell(port, here)


#: Wall time for the hello of a client.
HELLO_S = 5.0
#: When one more connects, the one that has been silent for longest is disconnected.
MAX_GUESTS = 64


class Guests:
    """The clients that have not said hello yet, in the order in which they have connected.

    Their number and their time are limited, so that they keep no other client out.

    :ivar waiting: deadline of each client's hello (monotonic clock); the loop of the hub looks at it in every pass.
    """

    def __init__(self, wall: WallClock = time) -> None:
        self._wall = wall
        self.waiting: dict[SwitchPort, int] = {}

    @property
    def due_ns(self) -> int | None:
        """Earliest deadline for a hello (monotonic clock); None without guests."""
        return next(iter(self.waiting.values()), None)

    def add(self, port: SwitchPort) -> SwitchPort | None:
        """Note a new client; returns the one that must make room for it, if any."""
        oldest = next(iter(self.waiting)) if len(self.waiting) >= MAX_GUESTS else None
        self.waiting[port] = self._wall.monotonic_ns() + round(HELLO_S * 1e9)
        return oldest

    def remove(self, port: SwitchPort) -> None:
        """Forget a client: it has said hello, or has left."""
        self.waiting.pop(port, None)

    def late(self) -> list[SwitchPort]:
        """The clients whose time for a hello is over."""
        now_ns = self._wall.monotonic_ns()
        return [port for port, due_ns in self.waiting.items() if due_ns <= now_ns]
