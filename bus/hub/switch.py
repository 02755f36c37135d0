"""The switch: reads packets from its ports and carries each one to all other ports, in one total order.

One thread, one epoll loop. Without a model the work per packet is one read, one check of its lengths and one
write per receiver; frames are not unpacked.
"""

from __future__ import annotations

import os
import select
import signal
import socket
import time
from collections.abc import Callable, Sequence

from railhil.bus.hub.disturbances import order_of
from railhil.bus.hub.disturbed_bus import Disturbance
from railhil.bus.hub.membership import HELLO_S, READ, WRITE, Membership
from railhil.bus.hub.ports import HOLD_S, PortClosed, PortFault, SwitchPort
from railhil.bus.hub.wire_model import WireModel
from railhil.bus.packing import NOTICE_LENGTH_BIT, OWN_MARK, decode_notice, fault_of
from railhil.common.digits import count_of
from railhil.common.exit_codes import ending_signals


class Delivery:
    """Delivers packets to the members of one switch; a member that does not take them is disconnected.

    :param model: pauses the input of a port while it is full.
    :param disturbance: decides which members hear a packet; None: all of them.

    :ivar carry: carries a packet of a port.
    """

    def __init__(self, members: Membership, model: WireModel | None, disturbance: Disturbance | None) -> None:
        self._all = members
        self._model = model
        self._disturbance = disturbance
        # Chosen once, so that an option that is off costs nothing for a packet.
        self.carry: Callable[[SwitchPort, bytes], None] = (
            self._carry_to_all if disturbance is None else self._carry_disturbed
        )

    def _carry_to_all(self, source: SwitchPort, packet: bytes) -> None:
        for port in self._all.members:
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
                self.update(port)
        except PortFault as fault:
            self._all.drop(port, str(fault))

    def tell(self, port: SwitchPort, packet: bytes) -> None:
        """Give a packet to one member, behind all packets that it has not read yet."""
        for ready in (packet,) if port.coalescer is None else port.coalescer.take(packet):
            self._hand_over(port, ready)

    def flush(self, port: SwitchPort) -> None:
        """Give a port the packets that it had no room for, if it is still there."""
        if self._all.is_watched(port):
            port.flush()
            self.update(port)

    def update(self, port: SwitchPort) -> None:
        """Watch the events that the port needs now; nothing is read from it while the model is full."""
        self._all.update(port, self._model is not None and self._model.is_full(port))

    # --- held back for clients that read in bulk ----------------------------------------------------------

    def flush_held(self, until_ns: int | None = None) -> None:
        """Deliver packets that are held: all, or those due by ``until_ns``."""
        for port in self._all.members:
            if port.coalescer is None or port.coalescer.due_ns is None:
                continue
            if until_ns is None or port.coalescer.due_ns <= until_ns:
                for packet in port.coalescer.flush():
                    self._hand_over(port, packet)

    def held_due_ns(self) -> list[int]:
        """When the packets that are held are due."""
        coalescers = [port.coalescer for port in self._all.members if port.coalescer is not None]
        return [one.due_ns for one in coalescers if one.due_ns is not None]

    # --- disturbed traffic --------------------------------------------------------------------------------

    def _carry_disturbed(self, source: SwitchPort, packet: bytes) -> None:
        assert self._disturbance is not None
        for port, told in self._disturbance.carry(source, packet, self._all.members):
            if told is not None:
                self.tell(port, told)
            elif port is source:
                self.tell(port, packet + OWN_MARK)
            else:
                self.tell(port, packet)

    def obey(self, disturbance: Disturbance, source: SwitchPort, packet: bytes) -> str | None:
        """Carry out an order; the fault of the packet if it is none."""
        try:
            deliveries = disturbance.obey(source, order_of(decode_notice(packet).get("order")))
        except ValueError as error:
            return str(error)
        self.tell_all(deliveries)
        return None

    def tell_all(self, deliveries: Sequence[tuple[SwitchPort, bytes | None]]) -> None:
        """Give packets to members."""
        for port, packet in deliveries:
            if packet is not None:
                self.tell(port, packet)


#: How long a stopped hub continues to deliver packets that it has already taken.
DRAIN_TIMEOUT_S = 1.0
_DRAIN_LOOK_S = 0.005
_STOP = b"s"
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
        self._report = report
        self._model = model
        self._disturbance = disturbance
        # Whether something may be due without an event on a descriptor, a silent client excepted.
        self._is_timed = model is not None or disturbance is not None or bool(bus_ports)
        self._once = once
        self._bus_ports = tuple(bus_ports)
        self._stopping = False
        self._epoll = select.epoll()
        self._wake_read, self._wake_write = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
        self._epoll.register(self._wake_read, READ)
        self._all = Membership(
            listener,
            self._epoll,
            queue_limit_bytes=queue_limit_bytes,
            properties=properties,
            report=report,
            tell=lambda port, packet: self._delivery.tell(port, packet),
            disturbance=disturbance,
            bus_ports=bus_ports,
        )
        self._delivery = Delivery(self._all, model, disturbance)
        self._carry = self._delivery.carry

    @property
    def wake_fd(self) -> int:
        """For :func:`signal.set_wakeup_fd`: an ending signal ends the loop, and SIGUSR1 lets it report its counters."""
        return self._wake_write

    def stop(self) -> None:
        """End the loop; may be called from another thread or a signal handler."""
        os.write(self._wake_write, _STOP)

    def report_statistics(self) -> None:
        """One line for each port that has counters."""
        for port in self._all.members:
            line = port.statistics()
            if line:
                self._report(line)

    def run(self) -> None:
        """Serve until :meth:`stop`, or with ``once`` until the last client has left."""
        listener_fd = self._listener.fileno()
        ports, guests = self._all.ports, self._all.guests.waiting
        while not self._stopping and not (self._once and self._all.is_deserted):
            for fd, events in self._wait_until_due() if self._is_timed or guests else self._wait():
                port = ports.get(fd)
                if port is not None:
                    if events & _READ_EVENTS:
                        self._read(port)
                    if events & WRITE:
                        self._delivery.flush(port)
                elif fd == listener_fd:
                    self._all.accept()
                elif fd == self._wake_read:
                    self._wake()
            if self._is_timed or guests:
                self._serve_due()
        self._drain()

    def close(self) -> None:
        """Close the clients' ports and the loop's own descriptors; listening socket and buses remain with their
        owner."""
        self._all.close()
        self._epoll.close()
        os.close(self._wake_read)
        os.close(self._wake_write)

    # --- the hot path -------------------------------------------------------------------------------------

    def _wait(self) -> list[tuple[int, int]]:
        if self._all.bulk_readers:
            ready = self._epoll.poll(HOLD_S)
            if ready:
                return ready
            self._delivery.flush_held()
        return self._epoll.poll()

    def _read(self, port: SwitchPort) -> None:
        try:
            packets = port.receive()
        except PortClosed:
            self._all.leave(port)
            return
        except PortFault as fault:
            self._all.drop(port, str(fault))
            return
        for packet in packets:
            if not port.is_member:
                if not self._all.greet(port, packet):
                    return
                continue
            fault_text = fault_of(packet)
            if fault_text is not None:
                if self._disturbance is not None and len(packet) & NOTICE_LENGTH_BIT:
                    fault_text = self._delivery.obey(self._disturbance, port, packet)
                    if fault_text is None:
                        continue
                self._all.drop(port, f"malformed packet: {fault_text}")
                return
            if self._model is None:
                self._carry(port, packet)
            else:
                self._model.offer(port, packet, time.monotonic_ns())
                self._delivery.update(port)

    # --- what is due without an event ---------------------------------------------------------------------

    def _wait_until_due(self) -> list[tuple[int, int]]:
        due_ns = self._next_due_ns()
        if due_ns is None:
            return self._wait()
        # epoll counts in milliseconds, select on the epoll descriptor in microseconds.
        timeout_s = max(due_ns - time.monotonic_ns(), 0) * 1e-9
        select.select((self._epoll.fileno(),), (), (), timeout_s)
        if self._all.bulk_readers:
            self._delivery.flush_held(time.monotonic_ns())
        return self._epoll.poll(0)

    def _serve_due(self) -> None:
        for port in self._bus_ports:
            if port.due_ns is not None and port.due_ns <= time.monotonic_ns():
                self._delivery.flush(port)
        if self._model is not None:
            self._deliver_due(self._model)
        if self._disturbance is not None:
            self._delivery.tell_all(self._disturbance.due())
        # The guests are checked after the events: a hello that arrived while this process stood still is in time.
        for port in self._all.guests.late():
            self._all.drop(port, f"no hello within {HELLO_S:g} s")

    def _next_due_ns(self) -> int | None:
        """Next time at which the model, a bus or a silent client must be served without an event on a descriptor.

        While packets are held for clients that read in bulk, their due time is included; otherwise the epoll time-out
        is enough for it.
        """
        times_ns = [self._all.guests.due_ns, *(port.due_ns for port in self._bus_ports)]
        if self._model is not None:
            times_ns.append(self._model.next_due_ns())
        if self._disturbance is not None:
            times_ns.append(self._disturbance.due_ns)
        due_ns = min((time_ns for time_ns in times_ns if time_ns is not None), default=None)
        if due_ns is not None and self._all.bulk_readers:
            due_ns = min([due_ns, *self._delivery.held_due_ns()])
        return due_ns

    # --- the rest -----------------------------------------------------------------------------------------

    def _deliver_due(self, model: WireModel) -> None:
        for source, packet in model.due(time.monotonic_ns()):
            self._carry(source, packet)
        for port in self._all.unread():
            self._delivery.update(port)

    def _wake(self) -> None:
        asked = os.read(self._wake_read, 64)
        if signal.SIGUSR1 in asked:
            self.report_statistics()
        self._stopping = self._stopping or _STOP in asked or any(number in asked for number in ending_signals())

    def _drain(self) -> None:
        """Carry packets that clients sent before the stop and deliver backlogs, within :data:`DRAIN_TIMEOUT_S`."""
        self._all.stop_accepting()
        self._epoll.unregister(self._wake_read)
        deadline_s = time.monotonic() + DRAIN_TIMEOUT_S
        while time.monotonic() < deadline_s:
            ready = self._epoll.poll(0)
            if not ready:
                if not any(port.has_backlog for port in self._all.members):
                    break
                # A full bus does not signal when it accepts frames again.
                for bus_port in self._bus_ports:
                    self._delivery.flush(bus_port)
                longest_s = _DRAIN_LOOK_S if self._bus_ports else DRAIN_TIMEOUT_S
                ready = self._epoll.poll(min(max(deadline_s - time.monotonic(), 0.0), longest_s))
            for fd, events in ready:
                port = self._all.ports.get(fd)
                if port is not None and events & _READ_EVENTS:
                    self._read(port)
                if port is not None and events & WRITE:
                    self._delivery.flush(port)
        self._delivery.flush_held()
        for port in self._all.members:
            if port.has_backlog:
                self._report(f"{port.name} has not taken all packets before the stop")
        if self._model is not None and (pending := self._model.pending_frames()):
            waiting = count_of(pending, "frame was", "frames were")
            self._report(f"{waiting} still waiting for the wire at the stop")
