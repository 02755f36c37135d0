"""The link on a serial adapter (slcan): lines straight to and from the port that python-can has opened.

python-can's own path reads the port byte by byte, waits until each frame has left the computer (``tcdrain``, without
end when the adapter hangs), leaves a line that it cannot read in its buffer, and does not look at what the adapter
answers. Opening the port, bit rate and channel remain python-can's business.

The answers are what keeps old frames off the bus: while the adapter owes the answer to a frame for longer than
:data:`STALE_NS`, nothing more is written, so that no backlog waits for it in the computer.
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
import select
import termios
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import can

from railhil.bus.frame import Frame
from railhil.bus.link.outage import TIMEOUTS, Timeouts
from railhil.bus.link.single import SingleLink
from railhil.bus.link.slcanline import FRAME_LETTERS, LINE_MAX_BYTES, from_line, to_line

#: In realtime nothing is added to frames that have waited longer than this: half of what cuts traction.
STALE_NS = 30_000_000

#: An adapter that takes nothing is asked for a sign of life this often.
_ASK_AGAIN_NS = 200_000_000
_GOODBYE_S = 0.5
#: A pause this long is said.
_SAY_S = 0.2
_CHUNK_BYTES = 4096
_UNANSWERED_MAX = 64
#: Stands among the unanswered frames for a question about the adapter's state.
_QUESTION_NS = 0
#: After this long without a byte from it the adapter is asked for its state.
_SILENCE_S = 0.1
_STATUS = re.compile(rb"F[0-9A-Fa-f]{2}")
#: Status flag of the SJA1000: bus error (Lawicel CAN232, command F).
_BUS_ERROR = 0x80
_END = re.compile(rb"[\r\a]")
_BELL = 0x07
#: Answers to a frame that was taken: of Lawicel adapters with and without automatic sending of what is received.
_TAKEN = (b"", b"z", b"Z")


class StuckAdapter(can.CanTimeoutError):
    """The adapter takes nothing: to the link, a full queue."""


class SlcanLink(SingleLink):
    """:class:`~railhil.bus.link.base.Link` on an ``slcan`` interface.

    ``counters`` beyond those of the link: ``adapter_refused`` frames that the adapter answered with BELL (its transmit
    queue is full, or it is off the bus), ``adapter_stuck`` pauses in which it took nothing, ``garbage`` lines that are
    none of the protocol. An adapter that answers
    nothing to frames (the first CANable's firmware) is known to be stuck only when the port takes no more.
    """

    def __init__(
        self,
        bus: can.BusABC,
        reopen: Callable[[], can.BusABC] | None = None,
        say: Callable[[str], None] | None = None,
        *,
        timeouts: Timeouts = TIMEOUTS,
    ) -> None:
        super().__init__(bus, reopen, say, timeouts=timeouts)
        self._use_port()

    @property
    def where(self) -> str:
        """See :attr:`Link.where`."""
        return f"slcan:{self._port}"

    @property
    def has_descriptor(self) -> bool:
        """See :attr:`Link.has_descriptor`."""
        return True

    @property
    def has_rest(self) -> bool:
        """See :attr:`Link.has_rest`."""
        return bool(self._rest)

    def _use_port(self) -> None:
        serial: Any = self.bus
        self._port = str(serial.serialPortOrig.port)
        # python-can says goodbye to the adapter, and would wait without end for one that takes nothing.
        serial.serialPortOrig.write_timeout = _GOODBYE_S
        self._fd: int = serial.fileno()
        #: Of the line that is just being received.
        self._partial = b""
        #: Of a line that the port took only in part.
        self._rest = b""
        #: When each frame was written that the adapter has not answered yet; questions among them.
        self._unanswered: deque[int] = deque(maxlen=_UNANSWERED_MAX)
        #: The adapter is one that answers frames.
        self._answers = False
        #: It was stuck and has been asked for a sign of life; that has been said.
        self._asked = self._has_said = False
        self._asked_ns = 0
        #: When the oldest frame was written that a stuck adapter has not answered.
        self._stuck_since_ns = 0
        #: The frame before was taken.
        self._taking = True
        #: When the adapter has last said something, or was asked to (monotonic).
        self._opened_s = self._quiet_since_s = time.monotonic()

    def _send_one(self, frame: Frame, give_up_s: float) -> None:
        if self._asked and self._outage is None and not self.lossless:
            # Only the adapter's answer, which is received, tells that it goes on: no use in waiting for it here.
            self.counters["send_dropped"] += 1
            self._say_stuck()
            self._ask_again()
            return
        super()._send_one(frame, give_up_s)

    def _put(self, frame: Frame) -> None:
        line = to_line(frame) + b"\r"
        now_ns = time.monotonic_ns()
        if not self.lossless and self._is_stuck(now_ns):
            if not self._asked:
                self._asked = True
                self._asked_ns = now_ns
                self._stuck_since_ns = self._oldest_ns()
                self._discard()
            self._ask_again()
            raise StuckAdapter("the adapter does not answer")
        try:
            self._write(line)
        except BlockingIOError:
            if self.lossless:
                raise
            self._discard()
            self._write(line)
        self._unanswered.append(now_ns)
        self._taking = True

    def _is_stuck(self, now_ns: int) -> bool:
        """Whether the adapter owes an answer for too long."""
        oldest_ns = self._oldest_ns()
        return self._answers and oldest_ns != _QUESTION_NS and now_ns - oldest_ns > STALE_NS

    def _oldest_ns(self) -> int:
        """When the oldest frame without an answer was written."""
        return next((written_ns for written_ns in self._unanswered if written_ns != _QUESTION_NS), _QUESTION_NS)

    def _silent_s(self) -> float:
        """Time for which an adapter that is stuck has owed an answer."""
        return (time.monotonic_ns() - self._stuck_since_ns) / 1e9

    def _say_stuck(self) -> None:
        if not self._has_said and self._silent_s() > _SAY_S:
            self._has_said = True
            self._say(f"{self.where} takes no frames for {self._silent_s():.2f} s; they are dropped until it does")

    def _ask_again(self) -> None:
        """The sign of life may have been lost itself."""
        now_ns = time.monotonic_ns()
        if now_ns - self._asked_ns > _ASK_AGAIN_NS:
            self._asked_ns = now_ns
            with contextlib.suppress(BlockingIOError):
                self._write(b"\r")

    def _write(self, line: bytes) -> None:
        """Write a line behind the rest of the one before.

        :raises BlockingIOError: the port takes nothing of this line now.
        """
        self._put_rest()
        self._rest = line[os.write(self._fd, line) :]

    def _put_rest(self) -> None:
        while self._rest:
            self._rest = self._rest[os.write(self._fd, self._rest) :]

    def _discard(self) -> None:
        """Throw away what the port still holds, as far as its driver can, and end a line that was taken in part.

        The answer to the empty line is the sign of life.
        """
        self.counters["adapter_stuck"] += self._taking
        self._taking = False
        try:
            termios.tcflush(self._fd, termios.TCOFLUSH)
        except termios.error as error:
            raise OSError(*error.args) from error
        self._rest = b""
        with contextlib.suppress(BlockingIOError):
            self._write(b"\r")

    def _get(self, timeout_s: float | None) -> list[Frame]:
        deadline_s = None if timeout_s is None else time.monotonic() + timeout_s
        while True:
            now_s = time.monotonic()
            rest_s = None if deadline_s is None else max(0.0, deadline_s - now_s)
            # In the middle of a long wait, and over many short ones: bus-off is nothing but silence.
            ask_s = max(0.0, self._quiet_since_s + _SILENCE_S - now_s)
            ports = (self._fd,)
            readable, writable, _ = select.select(
                ports, ports if self._rest else (), (), ask_s if rest_s is None else min(rest_s, ask_s)
            )
            if writable:
                with contextlib.suppress(BlockingIOError):
                    # Writable, but not for all of it.
                    self._put_rest()
            if not readable:
                if not writable:
                    self._ask_status()
                    if rest_s is not None and time.monotonic() >= now_s + rest_s:
                        return []
                continue
            data = os.read(self._fd, _CHUNK_BYTES)
            if not data:
                raise OSError(errno.EIO, "serial port closed, adapter unplugged")
            self._quiet_since_s = time.monotonic()
            frames = self._frames(self._partial + data)
            # Answers alone are nothing to tell of.
            if frames or rest_s == 0.0:
                return frames

    def _ask_status(self) -> None:
        """Ask an adapter that has said nothing for so long whether it is on the bus at all."""
        now_s = time.monotonic()
        if now_s - self._quiet_since_s < _SILENCE_S:
            return
        self._quiet_since_s = now_s
        # One whose port is full, or that is stuck, has other troubles.
        if not self._rest and (self.lossless or not self._is_stuck(time.monotonic_ns())):
            with contextlib.suppress(BlockingIOError):
                self._write(b"F\r")
                self._unanswered.append(_QUESTION_NS)

    def _frames(self, data: bytes) -> list[Frame]:
        """Frames of the whole lines in ``data``; what follows the last of them is kept."""
        frames: list[Frame] = []
        start = 0
        for end in _END.finditer(data):
            line, start = data[start : end.start()], end.end()
            if line[:1] and line[:1] in FRAME_LETTERS:
                try:
                    frames.append(from_line(line, may_have_stamp=True))
                except ValueError:
                    self.counters["garbage"] += 1
            elif line in _TAKEN:
                self._answered(refused=data[end.start()] == _BELL)
            elif _STATUS.fullmatch(line):
                self._take_status(int(line[1:], 16))
            else:
                self.counters["garbage"] += 1
        self._partial = data[start:]
        if len(self._partial) > LINE_MAX_BYTES:
            self.counters["garbage"] += 1
            self._partial = b""
        return frames

    def _answered(self, *, refused: bool) -> None:
        """The adapter's answer to the oldest frame.

        :raises BusLost: in lockstep, for a frame that is refused: those behind it may be on the bus already.
        """
        while self._unanswered and self._unanswered[0] == _QUESTION_NS:
            self._unanswered.popleft()
            if refused:
                # It does not know the question.
                return
        if not self._unanswered and not self._asked:
            return
        self._answers = True
        self.counters["adapter_refused"] += refused
        if refused and self.lossless and time.monotonic() > self._opened_s + self._timeouts.opening_s:
            raise self._lost("the adapter has refused a frame (transmit queue full, or bus-off), lockstep cannot go on")
        if self._asked:
            self._goes_on()
        else:
            self._unanswered.popleft()

    def _goes_on(self) -> None:
        """A stuck adapter is alive. What it still has to answer is not told apart from what was thrown away."""
        if self._has_said:
            self._say(f"{self.where} takes frames again after {self._silent_s():.2f} s")
        self._unanswered.clear()
        self._asked = self._has_said = False

    def _take_status(self, flags: int) -> None:
        if self._asked:
            self._goes_on()
        # What was written before the question has been answered, or the answer was lost on the way.
        while _QUESTION_NS in self._unanswered and self._unanswered.popleft() != _QUESTION_NS:
            pass
        if flags & _BUS_ERROR and self._outage is None:
            self.counters["bus_off"] += 1
            reason = f"the adapter reports bus errors, status {flags:02X}: bus-off, wrong bit rate or no second node"
            self._go_out(reason, bus_off=True)
        elif not flags & _BUS_ERROR and self._outage is not None and self._outage.bus_off:
            self._came_back()

    def _try_again(self) -> bool:
        if not super()._try_again():
            return False
        self._use_port()
        return True
