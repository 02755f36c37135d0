"""Delivery of packets from the switch to its ports: to all others, or as a disturbed bus carries them; at once, or held
back for clients that read in bulk."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from railhil.bus.hub.disturbances import order_of
from railhil.bus.hub.disturbed_bus import Disturbance
from railhil.bus.hub.membership import Membership
from railhil.bus.hub.ports import PortFault, SwitchPort
from railhil.bus.hub.wire import OWN_MARK, decode_notice
from railhil.bus.hub.wire_model import WireModel


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
