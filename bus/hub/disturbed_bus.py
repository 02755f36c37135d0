"""Effect of a hub with the option ``--faults`` on the traffic: orders of clients, and which clients hear a packet.

Nothing here depends on wall time, except a recovery that takes time (:class:`Disturbance`): in lockstep the same orders
between the same packets have the same effect. Other buses at the hub (``--port``) are never disturbed.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict

from railhil.bus.frame import Frame
from railhil.bus.hub.cancontroller import RECOVERY_BITS, CanController
from railhil.bus.hub.disturbances import Host, Lines, Order
from railhil.bus.hub.ports import SwitchPort
from railhil.bus.packing import CLASSIC_SIZE, FD_SIZE, encode_notice, pack_frame
from railhil.common.patience import WallClock

#: A packet for a port; None: the packet that is being carried.
Delivery = tuple[SwitchPort, bytes | None]

_UNHARMED = Lines()


class _Client:
    """The model of one client."""

    def __init__(self, port: SwitchPort) -> None:
        self.port = port
        self.controller = CanController()
        self.lines = Lines()
        self.is_full = False
        #: Number of packets that it has sent. With a bit rate it counts frames and differs from the client's own count,
        #: which is harmless: time then does not wait for answers.
        self.packets = 0
        self.told = Host()
        #: Instant of its return from bus-off (monotonic clock), if that is decided.
        self.back_ns: int | None = None

    def answers_to(self, who: str) -> bool:
        return who in (self.port.role, self.port.client_name)

    def host(self) -> Host:
        controller, lines = self.controller, self.lines
        state = (controller.state, controller.tec, controller.rec)
        return Host(*state, line=lines.trusted, switch_overs=lines.switch_overs, full=self.is_full)


class Disturbance:
    """CAN controllers and lines of all clients.

    :param restart_ms: wall time after which a bus-off controller restarts by itself; 0: only by order.
    :param bit_ns: time of a bit, which gives the duration of the recovery; 0: no bit rate, the recovery takes no time.
    """

    def __init__(self, restart_ms: int = 0, bit_ns: float = 0.0, wall: WallClock = time) -> None:
        self._restart_ns = restart_ms * 1_000_000
        self._recovery_ns = round(RECOVERY_BITS * bit_ns)
        self._wall = wall
        self._clients: dict[SwitchPort, _Client] = {}

    def join(self, port: SwitchPort) -> None:
        """A client has said hello."""
        self._clients[port] = _Client(port)

    def leave(self, port: SwitchPort) -> None:
        """A port is gone."""
        self._clients.pop(port, None)

    # --- orders -------------------------------------------------------------------------------------------

    def obey(self, source: SwitchPort, order: Order) -> list[Delivery]:
        """Carry out an order of ``source``."""
        found = [client for client in self._clients.values() if client.answers_to(order.who)]
        if not found:
            return [(source, encode_notice(missed=f"{order.what} {order.who}"))]
        return [delivery for client in found for delivery in self._do(client, order)]

    def _do(self, client: _Client, order: Order) -> list[Delivery]:
        frames: list[Frame] = []
        if order.what == "errors":
            if not client.controller.is_off:
                client.controller.errors_left += order.count
        elif order.what == "passive":
            frames = client.controller.hold_passive(order.on)
        elif order.what == "bus_off":
            frames = self._went_off(client, client.controller.go_off())
        elif order.what == "line":
            (client.lines.dead.add if order.on else client.lines.dead.discard)(order.line)
        elif order.what == "full":
            client.is_full = order.on
        elif client.controller.is_off:
            if self._recovery_ns:
                client.back_ns = self._wall.monotonic_ns() + self._recovery_ns
            else:
                frames = self._restarted(client)
        return self._tell(client, frames)

    # --- recovery from bus-off ----------------------------------------------------------------------------

    @property
    def due_ns(self) -> int | None:
        """Instant at which the next controller returns by itself (monotonic clock); None: no controller does."""
        times_ns = (client.back_ns for client in self._clients.values())
        return min((time_ns for time_ns in times_ns if time_ns is not None), default=None)

    def due(self) -> list[Delivery]:
        """Return the controllers to the bus whose time has come."""
        now_ns = self._wall.monotonic_ns()
        found: list[Delivery] = []
        for client in self._clients.values():
            if client.back_ns is not None and client.back_ns <= now_ns:
                found += self._tell(client, self._restarted(client))
        return found

    def _went_off(self, client: _Client, frames: list[Frame]) -> list[Frame]:
        if client.controller.is_off and self._restart_ns and client.back_ns is None:
            client.back_ns = self._wall.monotonic_ns() + self._restart_ns + self._recovery_ns
        return frames

    def _restarted(self, client: _Client) -> list[Frame]:
        client.back_ns = None
        return client.controller.restart()

    # --- traffic ------------------------------------------------------------------------------------------

    def carry(self, source: SwitchPort, packet: bytes, members: Sequence[SwitchPort]) -> list[Delivery]:
        """The receivers of a packet and of the notices about it, in this order."""
        frames = 1 if len(packet) == FD_SIZE else len(packet) // CLASSIC_SIZE
        sender = self._clients.get(source)
        found: list[Delivery] = []
        if sender is not None:
            sender.packets += 1
        is_sent = sender is None or (not sender.is_full and not sender.controller.is_off)
        if sender is not None and is_sent and sender.controller.errors_left:
            found += self._fail(sender)
            is_sent = not sender.controller.is_off
        heard = [port for port in members if is_sent and self._hears(port, source, sender, frames)]
        if sender is not None and is_sent:
            found += self._tell(sender, sender.controller.sent(frames))
        for port in heard:
            client = self._clients.get(port)
            if client is not None and client is not sender:
                found += self._tell(client, client.controller.received(frames))
        # Sent behind the packet: the state that a client reports belongs to the packets that it has read.
        found += [(port, None) for port in heard]
        return found + self._cut_off(source, sender, [port for port in members if port not in heard])

    def _hears(self, port: SwitchPort, source: SwitchPort, sender: _Client | None, frames: int) -> bool:
        # Another bus has both lines and is never off.
        sending = _UNHARMED if sender is None else sender.lines
        client = self._clients.get(port)
        if port is source:
            return source.receive_own and bool(sending.shared(sending))
        if client is None:
            return bool(sending.shared(_UNHARMED))
        return not client.controller.is_off and client.lines.hears(sending, frames)

    def _fail(self, sender: _Client) -> list[Delivery]:
        """Errors destroy the sender's attempts, until they are used up or it is bus-off."""
        others = [client for client in self._clients.values() if client is not sender and not client.controller.is_off]
        found: list[Delivery] = []
        while sender.controller.errors_left:
            sender.controller.errors_left -= 1
            found += self._tell(sender, self._went_off(sender, sender.controller.send_failed()))
            for client in others:
                if sender.lines.shared(client.lines):
                    found += self._tell(client, client.controller.receive_failed())
        return found

    def _tell(self, client: _Client, frames: Iterable[Frame]) -> list[Delivery]:
        """Error frames for a client that reads them, after its new state."""
        port, host = client.port, client.host()
        found: list[Delivery] = []
        if host != client.told and port.hears_faults:
            found.append((port, encode_notice(host=asdict(host))))
            client.told = host
        return found + [(port, pack_frame(frame)) for frame in frames if port.hears_faults]

    def _cut_off(self, source: SwitchPort, sender: _Client | None, deaf: Iterable[SwitchPort]) -> list[Delivery]:
        """Tell the nodes of a bench that an answer cannot come."""
        found: list[Delivery] = []
        roles = []
        for port in deaf:
            if port is source or port.role is None:
                continue
            roles.append(port.role)
            if source.role is not None and port.hears_faults:
                found.append((port, encode_notice(cut_off=[source.role])))
        if roles and sender is not None and source.hears_faults:
            found.append((source, encode_notice(cut_off=sorted(roles), packet=sender.packets)))
        return found
