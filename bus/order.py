"""Restores the bus order for a recorder on a kernel bus: an answer follows directly after its poll.

A real bus has one order for all listeners. ``vcan`` has an order only per sending processor: each sender's frames are
delivered to the listeners on the processor it runs on, so a third node may see the controller's answer before the
administrator's poll, or after the administrator's next frames (measured: 6 to 11 of 9600 frames on two processors). The
administrator waits for each answer in lockstep, so the order on the wire is known and is restored here. If an answer
never comes, the bus falls silent, because the recorder does not answer a poll that it holds back.
:meth:`BusOrder.flush` then stops waiting for the answer.
"""

from __future__ import annotations

import time

from railhil.bus.frame import Frame
from railhil.bus.mvb import F_DEVICE_STATUS
from railhil.bus.own_frames import OwnFrames
from railhil.dbc import Contract

#: Silence after which held frames are released. A slow controller, or a short outage of the bus, must not change the
#: recorded order; while nothing is held, the administrator gets its answers.
PATIENCE_S = 0.5


class BusOrder:
    """Returns frames in the order of the wire; holds some of them briefly.

    :param contract: of the run's system.
    :param source: the node whose answers may arrive out of order (not the recorder itself).
    :param fd: the bus carries the CAN FD form.
    :param patience_s: wall time of silence after which held frames are released.
    """

    def __init__(
        self,
        contract: Contract,
        source: str = "controller",
        fd: bool = False,
        patience_s: float = PATIENCE_S,
    ) -> None:
        self._poll_id = contract.poll_id
        self._own = OwnFrames(contract)
        self._answers = {
            port.address: (port.fd_id,) if fd else port.can_ids for port in contract.ports if port.source == source
        }
        self._answer_ids = {can_id for ids in self._answers.values() for can_id in ids}
        self._awaited: list[int] = []
        self._early: list[Frame] = []
        self._held: list[Frame] = []
        #: Frames that had to be moved.
        self.moved = 0
        self._patience_s = patience_s
        self._silent_since_s: float | None = None

    def feed(self, frame: Frame) -> list[Frame]:
        """Take the next frame as it arrived; returns what can be recorded now."""
        self._silent_since_s = None
        is_own = frame in self._own
        if self._awaited:
            if is_own and frame.can_id == self._awaited[-1] and not frame.data:
                # The source has sent "no answer".
                self._awaited = [frame.can_id]
            if not is_own or frame.can_id != self._awaited[0]:
                self._held.append(frame)
                self.moved += 1
                return []
            self._awaited.pop(0)
            if self._awaited:
                return [frame]
            held, self._held = self._held, []
            return [frame, *(item for later in held for item in self.feed(later))]
        if not is_own:
            return [frame]
        if frame.can_id in self._answer_ids:
            self._early.append(frame)
            self.moved += 1
            return []
        if frame.can_id == self._poll_id and len(frame.data) == 3 and frame.data[0] >> 4 != F_DEVICE_STATUS:
            self._awaited = list(self._answers.get((frame.data[0] & 0xF) << 8 | frame.data[1], ()))
            if self._awaited:
                early, self._early = self._early, []
                return [frame, *(item for first in early for item in self.feed(first))]
        return [frame]

    def flush(self) -> list[Frame]:
        """Call when nothing has arrived; after ``patience_s`` without frames it returns all held frames in order of
        arrival."""
        if not self._early and not self._held:
            return []
        now_s = time.monotonic()
        if self._silent_since_s is None:
            self._silent_since_s = now_s
        if now_s - self._silent_since_s < self._patience_s:
            return []
        frames = [*self._early, *self._held]
        self._awaited, self._early, self._held = [], [], []
        return frames
