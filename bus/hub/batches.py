"""A client of the hub that passes whole packets of frames, as railhil's own nodes use it.

It does not import python-can, which takes longer to load than everything else in a node; :mod:`railhil.bus.hub.client`
is the same client as an interface of python-can.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

from railhil.bus import packing
from railhil.bus.frame import EXTENDED, Frame
from railhil.bus.hub.connection import PLAIN, HubConnection, QueueFull, ReadinessFd, SendTimeout
from railhil.bus.hub.disturbances import Notices, Order
from railhil.bus.hub.hello import ClientSettings, join_hub


class HubClient:
    """A client port of the hub.

    Frames are never lost: sending blocks while the hub cannot take more, and a receiver that falls behind
    by more than the hub's limit (64 MiB unless set otherwise) is disconnected with
    :class:`~railhil.bus.hub.connection.HubLost`, after it has read the packets received before. All clients see the
    same total order.

    A client opened without ``fd=True`` receives CAN FD frames but cannot send them.

    :ivar hub_properties: properties reported by the hub: ``bitrate_model``, ``arbitration``, ``bitrate_bps``,
        ``data_bitrate_bps``, ``queue_limit_bytes``, ``faults``, ``restart_ms``.
    :ivar notices: on a hub with ``--faults``, its reports on this client's CAN controller and lines; else None.
    """

    #: The exceptions that this kind of client raises.
    failures = PLAIN
    #: Filters of python-can; frames that pass none of them are left out.
    _filters: Any = None

    def __init__(self, channel: str | None = None, fd: bool = False, **settings: Any) -> None:
        """Join the hub on ``channel``: a socket path or ``tcp://127.0.0.1:PORT``.

        Without ``channel`` it is the user's default path, see :func:`~railhil.bus.hub.address.default_channel`.
        ``settings``: arguments of ``can.Bus``, see :class:`~railhil.bus.hub.hello.ClientSettings`.

        Raises :class:`~railhil.bus.hub.connection.HubUnavailable`.
        """
        self._link: HubConnection | None = None
        self._readiness: ReadinessFd | None = None
        self._fd_enabled = fd
        #: Listen only.
        self._is_passive = False
        self._packet = b""
        self._offset = 0
        self._timestamp_s = 0.0
        self._packet_is_own = False
        #: Nodes of a bench: those that were connected at any time, and those connected now.
        self._seen: frozenset[str] = frozenset()
        self._here: frozenset[str] = frozenset()
        self._link, self.hub_properties = join_hub(channel, ClientSettings.of(settings), self.failures)
        self.notices = Notices() if self.hub_properties.get("faults") else None
        self.channel_info = f"railhil hub at {self._link.peer}"

    def fileno(self) -> int:
        """Descriptor that is readable while :meth:`recv_frames` would not block."""
        link = self._open_link()
        if self._readiness is None:
            self._readiness = ReadinessFd(link.sock)
            self._update_readiness()
        return self._readiness.fileno()

    def shutdown(self) -> None:
        """Leave the hub; everything sent before is delivered. May be called again."""
        if self._readiness is not None:
            self._readiness.close()
            self._readiness = None
        if self._link is not None:
            self._link.close()
            self._link = None

    @property
    def takes_fd(self) -> bool:
        """Whether CAN FD frames can be sent."""
        return self._fd_enabled

    def send_frames(self, frames: Sequence[Frame], timeout_s: float | None = None, *, even_full: bool = False) -> None:
        """Send frames in order, up to 256 classic frames in one packet, each CAN FD frame in its own.

        ``timeout_s``: seconds for the whole list, None waits for ever; 0 tries once. ``even_full``: also give the hub
        frames that a full transmit queue does not take. The hub discards them and notifies the nodes that wait for
        them. Raises :class:`SendTimeout`, :class:`~railhil.bus.hub.connection.HubLost`, and before anything is sent
        ValueError for an impossible frame.
        """
        deadline_s = None if timeout_s is None else time.monotonic() + timeout_s
        for packet in self._packets(frames):
            self._send(packet, deadline_s, even_full)

    def offer_frames(self, frames: Sequence[Frame]) -> int:
        """Send as many of the frames, from the first on, as the hub takes without waiting; returns their number.

        Raises as :meth:`send_frames`, except :class:`SendTimeout`.
        """
        taken = 0
        for packet in self._packets(frames):
            try:
                self._send(packet, 0.0)
            except (SendTimeout, QueueFull):
                break
            taken += 1 if len(packet) == packing.FD_SIZE else len(packet) // packing.CLASSIC_SIZE
        return taken

    def recv_frames(self, timeout_s: float | None) -> list[Frame]:
        """All frames of the next packet that pass the filters; [] after the timeout (None waits for ever), and after a
        notice of a hub with ``--faults``.

        The rest of a packet partly read as messages comes first. Raises :class:`~railhil.bus.hub.connection.HubLost`.
        """
        deadline_s = None if timeout_s is None else time.monotonic() + timeout_s
        while self._packet or self._next_packet(deadline_s):
            frames = packing.unpack_frames(self._packet, self._offset)
            self._packet, self._offset = b"", 0
            if self._readiness is not None:
                self._update_readiness()
            if self._filters is not None:
                frames = [frame for frame in frames if self._frame_passes(frame)]
            if frames:
                return frames
        return []

    def has_left(self, role: str) -> bool:
        """Whether a node of the bench was on the hub and has left; known once all that it sent has been read."""
        return role in self._seen and role not in self._here

    def is_here(self, role: str) -> bool:
        """Whether a node of the bench is on the hub, according to the packets read so far."""
        return role in self._here

    def order(self, order: Order) -> None:
        """Disturb the bus from the next packet on; see :mod:`railhil.bus.hub.disturbances`.

        Raises :class:`~railhil.bus.hub.connection.Refused` if the hub takes no orders, and as :meth:`send_frames`.
        """
        if self.notices is None:
            raise self.failures.refused(f"{self.channel_info}: takes no orders, it must be started with --faults")
        self._open_link().send_packet(packing.encode_notice(order=order.encoded()), None)

    # --- inside -------------------------------------------------------------------------------------------

    def _open_link(self) -> HubConnection:
        if self._link is None:
            raise self.failures.refused("the bus is shut down")
        return self._link

    def _packets(self, frames: Sequence[Frame]) -> list[bytes]:
        packets = packing.pack_frames(frames)
        if not self._fd_enabled and packing.FD_SIZE in map(len, packets):
            raise self.failures.refused("CAN FD frame on a bus opened without fd=True")
        return packets

    def _send(self, packet: bytes, deadline_s: float | None, even_full: bool = False) -> None:
        link = self._open_link()
        if self._is_passive:
            raise self.failures.refused("the bus is in state PASSIVE (listen only)")
        if self.notices is not None:
            if self.notices.host.full and not even_full:
                raise self.failures.full("transmit queue full")
            self.notices.sending()
        link.send_packet(packet, deadline_s)

    def _next_packet(self, deadline_s: float | None) -> bool:
        while True:
            packet = self._open_link().receive_packet(deadline_s)
            if packet is None:
                return False
            if not len(packet) & packing.NOTICE_LENGTH_BIT:
                break
            notice = packing.decode_notice(packet)
            if "roles" in notice:
                self._here = frozenset(notice["roles"])
                self._seen |= self._here
            elif self.notices is not None:
                self.notices.take(notice)
                # On TCP the next packet may be here already, where the socket does not show it.
                self._update_readiness()
                return False
        self._packet_is_own = bool(len(packet) & packing.OWN_LENGTH_BIT)
        self._packet = packet[: -len(packing.OWN_MARK)] if self._packet_is_own else packet
        self._offset = 0
        self._timestamp_s = time.time()
        return True

    def _update_readiness(self) -> None:
        if self._readiness is not None:
            self._readiness.set_buffered(bool(self._packet) or self._open_link().has_buffered())

    def _frame_passes(self, frame: Frame) -> bool:
        extended = bool(frame.flags & EXTENDED)
        for rule in self._filters or ():
            if rule.get("extended", extended) == extended and not (rule["can_id"] ^ frame.can_id) & rule["can_mask"]:
                return True
        return False
