"""The link on an interface that returns a node's own frames unmarked: python-can's ``udp_multicast``.

python-can does not pass on the sender's address, which would identify them. Own frames are therefore recognised by
content: for each frame sent, one equal received frame is discarded. A surplus frame is from another node, such as a
second bus administrator.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

import can

from railhil.bus.frame import Frame
from railhil.bus.link.outage import TIMEOUTS, Timeouts
from railhil.bus.link.single import SingleLink
from railhil.bus.wallclock import WallClock

#: Maximum number of sent frames whose echo is awaited; beyond it the oldest are assumed lost.
_REMEMBERED_FRAMES = 1024


class EchoLink(SingleLink):
    """:class:`~railhil.bus.link.single.SingleLink` that hides the node's own frames from it."""

    def __init__(
        self,
        bus: can.BusABC,
        reopen: Callable[[], can.BusABC] | None = None,
        say: Callable[[str], None] | None = None,
        *,
        timeouts: Timeouts = TIMEOUTS,
        wall: WallClock = time,
    ) -> None:
        super().__init__(bus, reopen, say, timeouts=timeouts, wall=wall)
        self._own: deque[Frame] = deque(maxlen=_REMEMBERED_FRAMES)

    def _put(self, frame: Frame) -> None:
        super()._put(frame)
        self._own.append(frame)

    def _get(self, timeout_s: float | None) -> list[Frame]:
        deadline_s = None if timeout_s is None else self._wall.monotonic() + timeout_s
        while frames := super()._get(timeout_s):
            if others := [frame for frame in frames if not self._is_own(frame)]:
                return others
            # An own frame is no reason to return early.
            if deadline_s is not None:
                timeout_s = max(0.0, deadline_s - self._wall.monotonic())
        return []

    def _is_own(self, frame: Frame) -> bool:
        try:
            self._own.remove(frame)
        except ValueError:
            return False
        return True
