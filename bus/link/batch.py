"""The link on the hub: batches of frames, over an interface that does not lose any."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import can

from railhil.bus.frame import Frame
from railhil.bus.link.base import FAILURES, Link


class BatchLink(Link):
    """:class:`~railhil.bus.link.base.Link` on an interface with ``send_frames``, ``offer_frames`` and ``recv_frames``.

    A failure is final: without the hub the run has ended.
    """

    def __init__(self, bus: can.BusABC, say: Callable[[str], None] | None = None) -> None:
        super().__init__(bus, say)
        hub: Any = bus
        self._send_batch: Callable[[Sequence[Frame]], None] = hub.send_frames
        self._offer_batch: Callable[[Sequence[Frame]], int] = hub.offer_frames
        self._has_left: Callable[[str], bool] = hub.has_left
        self._is_here: Callable[[str], bool] = hub.is_here
        self._receive_batch: Callable[[float | None], list[Frame]] = hub.recv_frames

    def has_ended(self, node: str) -> bool:
        """See :meth:`Link.has_ended`; who has left the hub has ended."""
        return super().has_ended(node) or self._has_left(node)

    def may_deliver(self, node: str) -> bool:
        """See :meth:`Link.may_deliver`; the hub tells that a node has left after all its frames."""
        return self._is_here(node)

    def send(self, frames: Sequence[Frame]) -> None:
        """See :meth:`Link.send`."""
        if self.sent is not None:
            self.sent.note(frames)
        try:
            self._send_batch(frames)
        except FAILURES as error:
            raise self._lost(f"cannot send: {error}") from error
        self.counters["sent"] += len(frames)

    def offer(self, frames: Sequence[Frame]) -> int:
        """See :meth:`Link.offer`."""
        try:
            taken = self._offer_batch(frames)
        except FAILURES as error:
            raise self._lost(f"cannot send: {error}") from error
        self.counters["send_retries"] += taken < len(frames)
        self.counters["sent"] += taken
        return taken

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """See :meth:`Link.receive`; one packet of the hub at a time."""
        try:
            batch = self._receive_batch(timeout_s)
        except FAILURES as error:
            raise self._lost(f"cannot receive: {error}") from error
        self.counters["received"] += len(batch)
        return batch
