"""The switch: reads packets from its ports and carries each one to all other ports, in one total order.

One thread, one epoll loop. Without a model the work per packet is one read, one check of its lengths and one
write per receiver; frames are not unpacked.
"""

from __future__ import annotations

import os
import select
import socket
import time
from collections.abc import Callable, Sequence

from railhil.bus.hub.address import describe
from railhil.bus.hub.coalesce import HOLD_S, coalescer_of
from railhil.bus.hub.disturbance import Disturbance
from railhil.bus.hub.guests import HELLO_S, Guests
from railhil.bus.hub.model import WireModel
from railhil.bus.hub.orders import order_of
from railhil.bus.hub.ports import PortClosed, PortFault, SocketPort, StreamPort, SwitchPort
from railhil.bus.hub.wire import (
    NOTICE_LENGTH_BIT,
    OWN_MARK,
    decode_hello,
    decode_notice,
    encode_hello,
    encode_roles,
    fault_of,
    role_of,
)

MAX_CLIENTS = 256
#: How long a stopped hub continues to deliver packets that it has already taken.
DRAIN_TIMEOUT_S = 1.0
_DRAIN_LOOK_S = 0.005
_STOP, _TELL = b"s", b"t"
_READ = select.EPOLLIN
_WRITE = select.EPOLLOUT
_READ_EVENTS = select.EPOLLIN | select.EPOLLHUP | select.EPOLLERR


class Switch:
    """Ports around a listening socket.

    ``properties`` are part of the hello sent to each client. ``report`` is called with one line for each client
    that is disconnected. ``disturbance`` carries out orders of clients; None: a packet with an order is malformed. With
    ``once`` the loop ends when the last client has left. ``bus_ports`` exist from the beginning to the end.
    """

    def __init__(
        self,
        listener: socket.socket,
        *,
        queue_limit_bytes: int,
        properties: dict[str, object],
        report: Callable[[str], None],
        model: WireModel | None = None,
        disturbance: Disturbance | None = None,
        once: bool = False,
        bus_ports: Sequence[SwitchPort] = (),
    ) -> None:
        self._listener = listener
        self._queue_limit_bytes = queue_limit_bytes
        self._properties = properties
        self._report = report
        self._model = model
        self._disturbance = disturbance
        #: Carries a packet: chosen once, so that an option that is off costs nothing for a packet.
        self._carry: Callable[[SwitchPort, bytes], None] = (
            self._carry_to_all if disturbance is None else self._carry_disturbed
        )
        self._once = once
        self._ports: dict[int, SwitchPort] = {}
        #: Replaced, never changed in place: a port may be dropped while packets are being carried.
        self._members: list[SwitchPort] = list(bus_ports)
        self._bus_ports = tuple(bus_ports)
        self._guests = Guests()
        self._bulk_readers = False
        #: Event mask with which each port is registered; 0 means that it is not registered.
        self._watched: dict[SwitchPort, int] = {}
        self._is_accepting = True
        self._had_member = False
        self._stopping = False
        self._accepted = 0
        self._epoll = select.epoll()
        self._wake_read, self._wake_write = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
        self._epoll.register(self._wake_read, _READ)
        self._epoll.register(listener.fileno(), _READ)
        for port in bus_ports:
            self._watch(port)

    def stop(self) -> None:
        """End the loop; may be called from another thread or a signal handler."""
        os.write(self._wake_write, _STOP)

    def tell(self) -> None:
        """Let the loop report the counters of its ports; may be called as :meth:`stop`."""
        os.write(self._wake_write, _TELL)

    def report_statistics(self) -> None:
        """One line for each port that has counters."""
        for port in self._members:
            line = port.statistics()
            if line:
                self._report(line)

    def run(self) -> None:
        """Serve until :meth:`stop`, or with ``once`` until the last client has left."""
        listener_fd = self._listener.fileno()
        ports = self._ports
        while not self._stopping:
            for fd, events in self._wait():
                port = ports.get(fd)
                if port is not None:
                    if events & _READ_EVENTS:
                        self._read(port)
                    if events & _WRITE:
                        self._flush(port)
                elif fd == listener_fd:
                    self._accept()
                elif fd == self._wake_read:
                    self._wake()
            for port in self._bus_ports:
                if port.due_ns is not None and port.due_ns <= time.monotonic_ns():
                    self._flush(port)
            if self._model is not None:
                self._deliver_due(self._model)
            if self._disturbance is not None:
                self._tell_all(self._disturbance.due())
            if self._guests:
                # After the events: a hello that has arrived while this process stood still is in time.
                for port in self._guests.late():
                    self._drop(port, f"no hello within {HELLO_S:g} s")
        self._drain()

    def close(self) -> None:
        """Close the clients' ports and the loop's own descriptors; listening socket and buses remain with their
        owner."""
        for port in self._ports.values():
            if port.is_client:
                port.close()
        self._ports.clear()
        self._members = []
        self._epoll.close()
        os.close(self._wake_read)
        os.close(self._wake_write)

    # --- the hot path -------------------------------------------------------------------------------------

    def _wait(self) -> list[tuple[int, int]]:
        if self._model is not None or self._bus_ports or self._guests or self._disturbance is not None:
            due_ns = self._next_due_ns()
            if due_ns is not None:
                # epoll counts in milliseconds, select on the epoll descriptor in microseconds.
                timeout_s = max(due_ns - time.monotonic_ns(), 0) * 1e-9
                select.select((self._epoll.fileno(),), (), (), timeout_s)
                if self._bulk_readers:
                    self._flush_held(time.monotonic_ns())
                return self._epoll.poll(0)
        if self._bulk_readers:
            ready = self._epoll.poll(HOLD_S)
            if ready:
                return ready
            self._flush_held()
        return self._epoll.poll()

    def _next_due_ns(self) -> int | None:
        """Next time at which the model, a bus or a silent client must be served without an event on a descriptor.

        While packets are held for clients that read in bulk, their due time is included; otherwise the epoll time-out
        is enough for it.
        """
        times_ns = [self._guests.due_ns, *(port.due_ns for port in self._bus_ports)]
        if self._model is not None:
            times_ns.append(self._model.next_due_ns())
        if self._disturbance is not None:
            times_ns.append(self._disturbance.due_ns)
        due_ns = min((time_ns for time_ns in times_ns if time_ns is not None), default=None)
        if due_ns is not None and self._bulk_readers:
            for port in self._members:
                if port.coalescer is not None and port.coalescer.due_ns is not None:
                    due_ns = min(due_ns, port.coalescer.due_ns)
        return due_ns

    def _flush_held(self, until_ns: int | None = None) -> None:
        """Deliver packets held for the clients that read in bulk: all, or those due by ``until_ns``."""
        for port in self._members:
            if port.coalescer is None or port.coalescer.due_ns is None:
                continue
            if until_ns is None or port.coalescer.due_ns <= until_ns:
                for packet in port.coalescer.flush():
                    self._hand_over(port, packet)

    def _read(self, port: SwitchPort) -> None:
        try:
            packets = port.receive()
        except PortClosed:
            self._leave(port)
            return
        except PortFault as fault:
            self._drop(port, str(fault))
            return
        for packet in packets:
            if not port.is_member:
                if not self._greet(port, packet):
                    return
                continue
            fault_text = fault_of(packet)
            if fault_text is not None:
                if self._disturbance is not None and len(packet) & NOTICE_LENGTH_BIT:
                    fault_text = self._obey(self._disturbance, port, packet)
                    if fault_text is None:
                        continue
                self._drop(port, f"malformed packet: {fault_text}")
                return
            if self._model is None:
                self._carry(port, packet)
            else:
                self._model.offer(port, packet, time.monotonic_ns())
                self._update(port)

    def _carry_to_all(self, source: SwitchPort, packet: bytes) -> None:
        for port in self._members:
            if port is source:
                if not source.receive_own:
                    continue
                packet_for_port = packet + OWN_MARK
            else:
                packet_for_port = packet
            if port.coalescer is not None:
                for ready in port.coalescer.take(packet_for_port):
                    self._hand_over(port, ready)
            else:
                self._hand_over(port, packet_for_port)

    def _hand_over(self, port: SwitchPort, packet: bytes) -> None:
        try:
            if port.send(packet):
                self._update(port)
        except PortFault as fault:
            self._drop(port, str(fault))

    # --- disturbed traffic --------------------------------------------------------------------------------

    def _carry_disturbed(self, source: SwitchPort, packet: bytes) -> None:
        assert self._disturbance is not None
        for port, told in self._disturbance.carry(source, packet, self._members):
            if told is not None:
                self._tell(port, told)
            elif port is source:
                self._tell(port, packet + OWN_MARK)
            else:
                self._tell(port, packet)

    def _obey(self, disturbance: Disturbance, source: SwitchPort, packet: bytes) -> str | None:
        """Carry out an order; the fault of the packet if it is none."""
        try:
            deliveries = disturbance.obey(source, order_of(decode_notice(packet).get("order")))
        except ValueError as error:
            return str(error)
        self._tell_all(deliveries)
        return None

    def _tell_all(self, deliveries: Sequence[tuple[SwitchPort, bytes | None]]) -> None:
        for port, packet in deliveries:
            if packet is not None:
                self._tell(port, packet)

    def _tell(self, port: SwitchPort, packet: bytes) -> None:
        """Give a packet to one member, behind all that it has not read yet."""
        for ready in (packet,) if port.coalescer is None else port.coalescer.take(packet):
            self._hand_over(port, ready)

    # --- the rest -----------------------------------------------------------------------------------------

    def _deliver_due(self, model: WireModel) -> None:
        for source, packet in model.due(time.monotonic_ns()):
            self._carry(source, packet)
        for port in [port for port, events in self._watched.items() if not events & _READ]:
            self._update(port)

    def _flush(self, port: SwitchPort) -> None:
        if port in self._watched:
            port.flush()
            self._update(port)

    def _update(self, port: SwitchPort) -> None:
        """Let epoll watch the port's input unless the model is full, and its output while it has a backlog."""
        before = self._watched.get(port)
        if before is None:
            return
        paused = self._model is not None and self._model.is_full(port)
        events = (0 if paused else _READ) | (_WRITE if port.has_backlog else 0)
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

    def _wake(self) -> None:
        asked = os.read(self._wake_read, 64)
        if _TELL in asked:
            self.report_statistics()
        self._stopping = self._stopping or _STOP in asked

    def _accept(self) -> None:
        try:
            sock, _ = self._listener.accept()
        except BlockingIOError:
            return
        except OSError as error:
            # Probably out of descriptors: stop listening until a client leaves, instead of failing in a busy loop.
            self._report(f"no more clients are accepted until one leaves: {describe(error)}")
            self._epoll.unregister(self._listener.fileno())
            self._is_accepting = False
            return
        self._accepted += 1
        kind = SocketPort if sock.family == socket.AF_UNIX else StreamPort
        port = kind(sock, f"client {self._accepted}", self._queue_limit_bytes)
        self._watch(port)
        oldest = self._guests.add(port)
        if oldest is not None:
            self._drop(oldest, "no hello yet, and others want to connect")

    def _watch(self, port: SwitchPort) -> None:
        self._ports[port.fileno()] = port
        self._watched[port] = _READ
        self._epoll.register(port.fileno(), _READ)

    def _greet(self, port: SwitchPort, packet: bytes) -> bool:
        """Answer the hello and admit the port; False if it is disconnected instead."""
        try:
            hello = decode_hello(packet)
            port.coalescer = coalescer_of(hello)
            role = role_of(hello)
            if sum(member.is_client for member in self._members) >= MAX_CLIENTS:
                raise ValueError(f"{MAX_CLIENTS} clients are connected, no more are allowed")
        except ValueError as error:
            port.send(encode_hello(error=str(error)))
            self._drop(port, str(error))
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
        self._guests.remove(port)
        if self._disturbance is not None:
            self._disturbance.join(port)
        self._had_member = True
        self._members = [*self._members, port]
        self._bulk_readers = any(member.coalescer is not None for member in self._members)
        self._tell_roles()
        return True

    def _tell_roles(self) -> None:
        """Report which nodes of a bench are connected now, after all packets carried so far."""
        for port in self._members:
            if port.hears_roles:
                # Built again for each port: a port that is dropped here is no longer listed.
                here = encode_roles([member.role for member in self._members if member.role is not None])
                self._tell(port, here)

    def _drop(self, port: SwitchPort, reason: str) -> None:
        self._report(f"{port.name} is disconnected: {reason}")
        self._leave(port)

    def _leave(self, port: SwitchPort) -> None:
        fd = port.fileno()
        if self._ports.get(fd) is not port:
            return
        del self._ports[fd]
        if self._watched.pop(port):
            self._epoll.unregister(fd)
        port.close()
        self._guests.remove(port)
        if self._disturbance is not None:
            self._disturbance.leave(port)
        if not self._is_accepting:
            self._epoll.register(self._listener.fileno(), _READ)
            self._is_accepting = True
        self._members = [member for member in self._members if member is not port]
        self._bulk_readers = any(member.coalescer is not None for member in self._members)
        if port.role is not None:
            self._tell_roles()
        if self._once and self._had_member and not any(member.is_client for member in self._members):
            self._stopping = True

    def _drain(self) -> None:
        """Carry packets that clients sent before the stop and deliver backlogs, within :data:`DRAIN_TIMEOUT_S`."""
        if self._is_accepting:
            self._epoll.unregister(self._listener.fileno())
        # So that a client that leaves does not enable the listener again.
        self._is_accepting = True
        self._epoll.unregister(self._wake_read)
        deadline_s = time.monotonic() + DRAIN_TIMEOUT_S
        while time.monotonic() < deadline_s:
            ready = self._epoll.poll(0)
            if not ready:
                if not any(port.has_backlog for port in self._members):
                    break
                # A full bus does not signal when it accepts frames again.
                for bus_port in self._bus_ports:
                    self._flush(bus_port)
                longest_s = _DRAIN_LOOK_S if self._bus_ports else DRAIN_TIMEOUT_S
                ready = self._epoll.poll(min(max(deadline_s - time.monotonic(), 0.0), longest_s))
            for fd, events in ready:
                port = self._ports.get(fd)
                if port is not None and events & _READ_EVENTS:
                    self._read(port)
                if port is not None and events & _WRITE:
                    self._flush(port)
        self._flush_held()
        for port in self._members:
            if port.has_backlog:
                self._report(f"{port.name} has not taken all packets before the stop")
        if self._model is not None and self._model.pending_frames():
            self._report(f"{self._model.pending_frames()} frames were still waiting for the wire at the stop")
