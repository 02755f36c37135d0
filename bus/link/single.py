"""The link on any python-can interface: frame by frame, with handling of outages.

An adapter that fails does not end the node: the link waits for it (:mod:`railhil.bus.link.base`) and reopens it.
"""

from __future__ import annotations

import contextlib
import errno
import struct
import time
from collections import deque
from collections.abc import Callable, Sequence

import can

from railhil.bus.frame import ERROR, Frame, from_message, to_message
from railhil.bus.link.base import TIMEOUTS, GatewayLink, Outage, Timeouts
from railhil.bus.link.errorframe import BUS_OFF, RESTARTED, describe
from railhil.bus.transports import Opening
from railhil.common.mypyc import mypyc_attr
from railhil.common.patience import WallClock

#: Interval between attempts while the transmit queue is full (ENOBUFS), which python-can raises at once.
_SEND_RETRY_S = 0.0005
#: Longest time that an interface may block in one attempt to send.
_SEND_TIMEOUT_S = 0.005
#: More unreadable input than this in a row is not a mere disturbance.
_UNREADABLE_SAID = 20
_NO_FRAME = "another protocol, another serial rate, or a firmware that is not understood"
_FULL = (errno.ENOBUFS, errno.EAGAIN)


@mypyc_attr(allow_interpreted_subclasses=True)
class SingleLink(GatewayLink):
    """:class:`~railhil.bus.link.base.Link` on an interface that sends and receives single frames.

    :param reopen: reopens the interface after a failure; None: a failure is final.
    :param wall: the clock to wait on; links that wait in the kernel use the machine's own.
    """

    failures = (can.CanError, OSError)
    bus: can.BusABC

    @classmethod
    def opened(cls, opening: Opening) -> SingleLink:
        """Open the interface.

        :raises Exception: of python-can, or of the driver.
        """
        return cls(opening.bus(), opening.bus, opening.say, timeouts=opening.timeouts)

    def __init__(
        self,
        bus: can.BusABC,
        reopen: Callable[[], can.BusABC] | None = None,
        say: Callable[[str], None] | None = None,
        *,
        timeouts: Timeouts = TIMEOUTS,
        wall: WallClock = time,
    ) -> None:
        super().__init__(bus, say)
        self._reopen = reopen
        self._timeouts = timeouts
        self._wall = wall
        self._outage: Outage | None = None
        # Frames received while a send waited for the bus.
        self._stash: list[Frame] = []
        self._heard_ns = self._wall.monotonic_ns()
        self._was_out = False
        self._gap_ns = 0
        # Unreadable input since the last frame.
        self._unreadable = 0
        self._use_bus()

    def _use_bus(self) -> None:
        """Take what is needed of the interface, which has been opened or opened again."""

    @property
    def is_down(self) -> bool:
        """True while the interface is gone or its CAN controller is bus-off."""
        return self._outage is not None

    @property
    def has_descriptor(self) -> bool:
        """False: python-can's own drivers may buffer frames where a poll cannot see them, and may wait too long."""
        return False

    def take_gap_ns(self) -> int:
        """See :meth:`Link.take_gap_ns`."""
        gap_ns, self._gap_ns = self._gap_ns, 0
        return gap_ns

    # -- sending --------------------------------------------------------------------------------------------------

    def send(self, frames: Sequence[Frame]) -> None:
        """See :meth:`Link.send`."""
        if self.sent is not None:
            self.sent.note(frames)
        give_up_s = self._wall.monotonic() + (
            self._timeouts.give_up_s if self.lossless else self._timeouts.queue_full_s
        )
        for frame in frames:
            self._send_one(frame, give_up_s)

    def offer(self, frames: Sequence[Frame]) -> int:
        """See :meth:`GatewayLink.offer`."""
        taken = 0
        try:
            if self.has_rest and self._outage is None:
                self._put_rest()
            while taken < len(frames) and self._outage is None:
                self._put(frames[taken])
                taken += 1
        except self.failures as error:
            if _is_full(error):
                self.counters["send_retries"] += 1
            else:
                self._went_down(error, "send")
        self.counters["sent"] += taken
        return taken

    def _send_one(self, frame: Frame, give_up_s: float) -> None:
        """Send one frame; it is dropped when it may not wait, or when ``give_up_s`` (monotonic) is reached."""
        while self._outage is None or self._back_for_sending():
            try:
                self._put(frame)
            except self.failures as error:
                if not _is_full(error):
                    self._went_down(error, "send")
                    continue
                self.counters["send_retries"] += 1
                if self._wall.monotonic() >= give_up_s:
                    if self.lossless:
                        raise self._lost(f"transmit queue full for {self._timeouts.give_up_s:g} s") from error
                    break
                self.while_waiting()
                self._wall.sleep(_SEND_RETRY_S)
            else:
                self.counters["sent"] += 1
                return
        self.counters["send_dropped"] += 1

    def _back_for_sending(self) -> bool:
        """Whether frames can be sent again; in lockstep, wait for that."""
        while self.lossless and self._outage is not None:
            self.while_waiting()
            self._stash += self._look_again(None)
        return self._outage is None

    def _put(self, frame: Frame) -> None:
        """Pass one frame to the interface, without retry."""
        self.bus.send(to_message(frame), timeout=_SEND_TIMEOUT_S)

    def _put_rest(self) -> None:
        """Pass on the rest of a frame, see :attr:`GatewayLink.has_rest`."""

    # -- receiving ------------------------------------------------------------------------------------------------

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """See :meth:`Link.receive`."""
        if self._stash:
            frames, self._stash = self._stash, []
            return frames
        if self._outage is not None and not self._outage.bus_off:
            return self._look_again(timeout_s)
        frames = self._heard(timeout_s)
        if self._outage is not None and self._outage.hopeless:
            raise self._lost(self._outage.reason)
        return frames

    def _heard(self, timeout_s: float | None) -> list[Frame]:
        """Frames of an open interface, counted and checked for information about its state."""
        try:
            frames = self._get(timeout_s)
        except self.failures as error:
            self._went_down(error, "receive")
            return []
        if frames:
            self._unreadable = 0
            self.counters["received"] += len(frames)
            error_frames = [frame for frame in frames if frame.flags & ERROR]
            if error_frames or self._outage is not None:
                self._look_at(frames)
            if len(error_frames) < len(frames):
                self._note_heard()
        return frames

    def _note_heard(self) -> None:
        """Note that frames of other nodes have arrived; the first after an outage determine how long there were
        none."""
        now_ns = self._wall.monotonic_ns()
        if self._was_out:
            self._was_out = False
            self._gap_ns += now_ns - self._heard_ns
        self._heard_ns = now_ns

    def _get(self, timeout_s: float | None) -> list[Frame]:
        """The frames that have arrived, or none at the time-out."""
        try:
            message = self.bus.recv(timeout_s)
        except (ValueError, IndexError, TypeError, struct.error):
            # A serial line can deliver anything, or half a frame; python-can's readers do not expect that, and some
            # keep it in their buffer.
            self._count_garbage()
            if hasattr(self.bus, "flush"):
                self.bus.flush()
            return []
        return [] if message is None else [from_message(message)]

    def _count_garbage(self) -> None:
        """Count unreadable input. If no frame is among it, report it while the node runs: otherwise the node only seems
        to hear nothing."""
        self.counters["garbage"] += 1
        self._unreadable += 1
        if self._unreadable == _UNREADABLE_SAID:
            self._say(f"{self.where}: input {_UNREADABLE_SAID} times, and no frame in it: {_NO_FRAME}")

    def _look_at(self, frames: list[Frame]) -> None:
        """Handle error frames, and notice that the bus works again."""
        for frame in frames:
            if not frame.flags & ERROR:
                if self._outage is not None:
                    self._came_back()
                continue
            self.counters["error_frames"] += 1
            if frame.can_id & BUS_OFF:
                self.counters["bus_off"] += 1
                if self._outage is None:
                    self._go_out("bus-off: too many errors on the wire; waiting for its restart", bus_off=True)
            elif frame.can_id & RESTARTED:
                if self._outage is not None:
                    self._came_back()
            elif self.counters["error_frames"] == 1:
                self._say(f"{self.where}: error frame: {describe(frame)} (said once, all are counted)")

    # -- outages --------------------------------------------------------------------------------------------------

    def _went_down(self, error: BaseException, action: str) -> None:
        """Handle a failure of the interface.

        :raises BusLost: it cannot be opened again.
        """
        text = " ".join(str(error).split()) or type(error).__name__
        if self._reopen is None:
            raise self._lost(f"cannot {action}: {text}") from error
        if self._outage is None:
            self._go_out(text)
        else:
            # It was bus-off, and now the interface itself is gone.
            self._outage.bus_off = False

    def _go_out(self, reason: str, *, bus_off: bool = False) -> None:
        self.counters["outages"] += 1
        self._outage = Outage(reason, bus_off=bus_off, timeouts=self._timeouts, wall=self._wall)
        self._say(f"{self.where} is down ({reason}); nothing is sent, waiting up to {self._timeouts.give_up_s:g} s")

    def _came_back(self) -> None:
        assert self._outage is not None
        self._say(f"{self.where} is back after {self._outage.lasted_s:.2f} s")
        self._outage = None
        self._was_out = True

    def _look_again(self, timeout_s: float | None) -> list[Frame]:
        """Wait for the interface, at most until the next check; returns what a bus-off interface receives meanwhile.

        :raises BusLost: it has been away for too long.
        """
        outage = self._outage
        assert outage is not None
        if outage.hopeless:
            raise self._lost(f"{outage.reason}; not back within {self._timeouts.give_up_s:g} s")
        wait_s = outage.until_look_s()
        if outage.bus_off:
            frames = self._heard(max(wait_s, 0.01))
            outage.looked()
            return frames
        if timeout_s is not None and timeout_s < wait_s:
            self._wall.sleep(timeout_s)
            return []
        self._wall.sleep(wait_s)
        if self._try_again():
            self._came_back()
        else:
            outage.looked()
        return []

    def _try_again(self) -> bool:
        """Reopen the interface; False while it is not available."""
        assert self._reopen is not None
        with contextlib.suppress(Exception):
            # A failing driver may raise anything when it is closed.
            self.bus.shutdown()
        try:
            self.bus = self._reopen()
        except Exception:
            # A driver whose device is just being plugged in may, too; the reason for the outage has already been
            # reported.
            return False
        self._use_bus()
        return True


def _is_full(error: BaseException) -> bool:
    """Whether a failed send means a full transmit queue, on a real adapter or on a serial line that does not drain."""
    codes = {getattr(each, name, None) for each in (error, error.__cause__) for name in ("errno", "error_code")}
    if codes & set(_FULL) or isinstance(error, can.CanTimeoutError):
        return True
    return type(error.__cause__).__name__ == "SerialTimeoutException"


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
            # The node's own frame does not end the wait.
            if deadline_s is not None:
                timeout_s = max(0.0, deadline_s - self._wall.monotonic())
        return []

    def _is_own(self, frame: Frame) -> bool:
        try:
            self._own.remove(frame)
        except ValueError:
            return False
        return True
