"""The link on the hub: batches of frames, over an interface that loses frames only by order."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import cast

from railhil.bus.can_settings import has_settings
from railhil.bus.errors import BusError
from railhil.bus.frame import ERROR, Frame
from railhil.bus.hub.batches import HubClient
from railhil.bus.hub.cancontroller import ERROR_PASSIVE
from railhil.bus.hub.disturbances import Disturber, Host, Notices, Order
from railhil.bus.link.base import TIMEOUTS, GatewayLink, Timeouts
from railhil.bus.link.errorframe import BUS_OFF, describe
from railhil.bus.transports import Opening
from railhil.common.mypyc import mypyc_attr
from railhil.common.patience import WallClock

#: Interval between two looks whether a full transmit queue has room again.
_LOOK_S = 0.0005


@mypyc_attr(allow_interpreted_subclasses=True)
class BatchLink(GatewayLink):
    """:class:`~railhil.bus.link.base.Link` on an interface with ``send_frames``, ``offer_frames``, ``recv_frames`` and
    ``notices``.

    A failure is final: without the hub the run has ended. On a hub that takes orders (``--faults``) the client can be
    bus-off, or its transmit queue full; in lockstep simulated time would wait too, so nothing is waited for then, and
    the hub tells the nodes that wait for an answer.

    :param timeouts: how long a full transmit queue and the return from bus-off are waited for in real time.
    """

    failures = (BusError, OSError)

    @classmethod
    def opened(cls, opening: Opening) -> BatchLink:
        """Join the hub.

        :raises Exception: of the hub, or of python-can.
        """
        # python-can's configuration is added to the given settings, for the hub too.
        if has_settings():
            return cls(cast(HubClient, opening.bus()), opening.say)
        settings = {key: value for key, value in opening.config.items() if key != "interface"}
        return cls(HubClient(**settings), opening.say)

    def __init__(
        self,
        bus: HubClient,
        say: Callable[[str], None] | None = None,
        *,
        timeouts: Timeouts = TIMEOUTS,
        wall: WallClock = time,
    ) -> None:
        super().__init__(bus, say)
        self._send_batch: Callable[..., None] = bus.send_frames
        self._offer_batch: Callable[[Sequence[Frame]], int] = bus.offer_frames
        self._receive_batch: Callable[[float | None], list[Frame]] = bus.recv_frames
        self._has_left: Callable[[str], bool] = bus.has_left
        self._is_here: Callable[[str], bool] = bus.is_here
        self._order: Callable[[Order], None] = bus.order
        self._notices: Notices | None = bus.notices
        self._timeouts = timeouts
        self._wall = wall
        # Frames received while a send waited for room.
        self._stash: list[Frame] = []
        self._heard_ns = wall.monotonic_ns()
        self._was_off = False
        self._was_passive = False
        self._off_ns = 0
        self._gap_ns = 0

    @property
    def is_down(self) -> bool:
        """True while the CAN controller is bus-off."""
        return self._notices is not None and self._notices.host.is_off

    @property
    def disturber(self) -> Disturber | None:
        """See :attr:`Link.disturber`."""
        return None if self._notices is None else self

    @property
    def host(self) -> Host:
        """See :class:`~railhil.bus.hub.disturbances.Disturber`."""
        return Host() if self._notices is None else self._notices.host

    def order(self, order: Order) -> None:
        """See :class:`~railhil.bus.hub.disturbances.Disturber`."""
        try:
            self._order(order)
        except self.failures as error:
            raise self._lost(f"cannot order: {error}") from error

    def has_ended(self, node: str) -> bool:
        """See :meth:`Link.has_ended`; a node that has left the hub has ended."""
        return super().has_ended(node) or self._has_left(node)

    def may_deliver(self, node: str) -> bool:
        """See :meth:`Link.may_deliver`; the hub tells that a node has left after all its frames."""
        return self._is_here(node)

    def is_cut_off(self, node: str) -> bool:
        """See :meth:`Link.is_cut_off`."""
        return self._notices is not None and self._notices.is_cut_off(node)

    def take_gap_ns(self) -> int:
        """See :meth:`Link.take_gap_ns`."""
        gap_ns, self._gap_ns = self._gap_ns, 0
        return gap_ns

    def send(self, frames: Sequence[Frame]) -> None:
        """See :meth:`Link.send`."""
        if self._notices is not None:
            self._send_disturbed(self._notices, frames)
            return
        if self.sent is not None:
            self.sent.note(frames)
        try:
            self._send_batch(frames)
        except self.failures as error:
            raise self._lost(f"cannot send: {error}") from error
        self.counters["sent"] += len(frames)

    def offer(self, frames: Sequence[Frame]) -> int:
        """See :meth:`GatewayLink.offer`."""
        try:
            taken = self._offer_batch(frames)
        except self.failures as error:
            raise self._lost(f"cannot send: {error}") from error
        self.counters["send_retries"] += taken < len(frames)
        self.counters["sent"] += taken
        return taken

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """See :meth:`Link.receive`; one packet of the hub at a time. Empty also after a notice of the hub."""
        if self._stash:
            batch, self._stash = self._stash, []
            return batch
        try:
            batch = self._receive_batch(timeout_s)
        except self.failures as error:
            raise self._lost(f"cannot receive: {error}") from error
        self.counters["received"] += len(batch)
        if self._notices is not None:
            self._look_at(batch)
        return batch

    # -- on a hub that takes orders -------------------------------------------------------------------------------

    def _send_disturbed(self, notices: Notices, frames: Sequence[Frame]) -> None:
        host, give_up_s = notices.host, self._wall.monotonic() + self._timeouts.queue_full_s
        while host.full and not host.is_off and not self.lossless and self._wall.monotonic() < give_up_s:
            self.counters["send_retries"] += 1
            self.while_waiting()
            begun_s = self._wall.monotonic()
            stash, self._stash = self._stash, []
            self._stash = stash + self.receive(_LOOK_S)
            self._wall.sleep(max(0.0, begun_s + _LOOK_S - self._wall.monotonic()))
            host = notices.host
        is_dropped = host.full or host.is_off
        self.counters["send_dropped" if is_dropped else "sent"] += len(frames)
        if is_dropped and not self.lossless:
            return
        if self.sent is not None and not host.is_off:
            # The hub carries nothing of a client that is bus-off.
            self.sent.note(frames)
        try:
            self._send_batch(frames, even_full=True)
        except self.failures as error:
            raise self._lost(f"cannot send: {error}") from error

    def _look_at(self, batch: list[Frame]) -> None:
        """Count error frames, and the time without the bus."""
        error_frames = [frame for frame in batch if frame.flags & ERROR]
        self.counters["error_frames"] += len(error_frames)
        self.counters["bus_off"] += sum(bool(frame.can_id & BUS_OFF) for frame in error_frames)
        if error_frames and self.counters["error_frames"] == len(error_frames):
            self._say(f"{self.where}: error frame: {describe(error_frames[0])} (said once, all are counted)")
        host = self.host
        if host.switch_overs > self.counters["switch_overs"]:
            self.counters["switch_overs"] = host.switch_overs
            self._say(f"{self.where}: takes frames from line {host.line} now")
        is_passive = host.state == ERROR_PASSIVE
        if is_passive and not self._was_passive:
            self.counters["error_passive"] += 1
            self._say(f"{self.where}: warning: error-passive (TEC {host.tec}, REC {host.rec})")
        self._was_passive = is_passive
        now_ns = self._wall.monotonic_ns()
        if self.is_down:
            if not self._was_off:
                self._was_off, self._off_ns = True, now_ns
                self.counters["outages"] += 1
                self._say(f"{self.where} is down (bus-off by order); nothing is sent")
            elif not self.lossless and now_ns - self._off_ns > self._timeouts.give_up_s * 1e9:
                raise self._lost(f"bus-off by order; not back within {self._timeouts.give_up_s:g} s")
        elif len(batch) > len(error_frames):
            if self._was_off:
                self._was_off = False
                self._gap_ns += now_ns - self._heard_ns
                self._say(f"{self.where} is back after {(now_ns - self._heard_ns) / 1e9:.2f} s")
            self._heard_ns = now_ns
