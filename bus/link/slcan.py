"""The link on a serial adapter (slcan): reads and writes lines directly on the port opened by python-can.

python-can's own path reads the port byte by byte, waits until each frame has left the computer (``tcdrain``, for ever
if the adapter hangs), leaves an unreadable line in its buffer, and ignores the adapter's answers. python-can still
opens the port and sets bit rate and channel.

The answers are used to keep stale frames off the bus: while an answer has been outstanding for longer than
:data:`STALE_NS`, nothing more is written, so that no backlog builds up in the computer.
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
from typing import Any

import can

from railhil.bus.frame import Frame
from railhil.bus.link.single import SingleLink
from railhil.bus.link.slcanline import FRAME_LETTERS, LINE_MAX_BYTES, from_line, to_line
from railhil.bus.transports import Opening

#: In real time no frame is queued behind frames that have waited longer than this: half the age that cuts traction.
STALE_NS = 30_000_000

#: Interval at which an adapter that accepts nothing is probed.
_ASK_AGAIN_NS = 200_000_000
_GOODBYE_S = 0.5
#: A pause of this length is reported.
_SAY_S = 0.2
_CHUNK_BYTES = 4096
_UNANSWERED_MAX = 64
#: Marks a query of the adapter's state among the unanswered frames.
_QUESTION_NS = 0
#: After this time without a byte from the adapter its state is queried.
_SILENCE_S = 0.1
_STATUS = re.compile(rb"F[0-9A-Fa-f]{2}")
#: Status flag of the SJA1000: bus error (Lawicel CAN232, command F).
_BUS_ERROR = 0x80
#: CR ends a line, BELL is an answer; some firmware sends CR LF or LF.
_END = re.compile(rb"\r\n?|\n|\a")
_BELL = 0x07
#: Answers to an accepted frame, from Lawicel adapters with and without automatic forwarding of received frames.
_TAKEN = (b"", b"z", b"Z")


class StuckAdapter(can.CanTimeoutError):
    """The adapter accepts nothing; the link treats this as a full queue."""


class SlcanLink(SingleLink):
    """:class:`~railhil.bus.link.base.Link` on an ``slcan`` interface.

    ``counters`` beyond those of the link: ``adapter_refused`` frames that the adapter answered with BELL (its transmit
    queue is full, or it is off the bus), ``adapter_stuck`` pauses in which it accepted nothing, ``garbage`` lines that
    are not valid slcan. An adapter that does not answer frames (the first CANable's firmware) is known to be stuck only
    when the port accepts no more data.
    """

    @classmethod
    def opened(cls, opening: Opening) -> SingleLink:
        bus = opening.bus()
        port = getattr(getattr(bus, "serialPortOrig", None), "fd", None)
        # Ports behind socket:// and on Windows use python-can's own driver.
        kind = cls if isinstance(port, int) else SingleLink
        return kind(bus, opening.bus, opening.say, timeouts=opening.timeouts)

    @property
    def where(self) -> str:
        """See :attr:`Link.where`."""
        return f"slcan:{self._port}"

    @property
    def has_descriptor(self) -> bool:
        """See :attr:`GatewayLink.has_descriptor`."""
        return True

    @property
    def has_rest(self) -> bool:
        """See :attr:`GatewayLink.has_rest`."""
        return bool(self._rest)

    def _use_bus(self) -> None:
        serial: Any = self.bus
        self._port = str(serial.serialPortOrig.port)
        # When closing, python-can sends a command to the adapter, and would wait for ever if the adapter accepts
        # nothing.
        serial.serialPortOrig.write_timeout = _GOODBYE_S
        self._fd: int = serial.fileno()
        #: Received part of an incomplete line.
        self._partial = b""
        self._ended_by_cr = False
        #: Unsent rest of a line that the port accepted only in part.
        self._rest = b""
        #: Times at which the frames and queries were written that the adapter has not answered yet.
        self._unanswered: deque[int] = deque(maxlen=_UNANSWERED_MAX)
        #: Whether the adapter is one that answers frames.
        self._answers = False
        #: Whether it is stuck and has been probed, and whether this has been reported.
        self._asked = self._has_said = False
        self._asked_ns = 0
        #: When the oldest frame unanswered by a stuck adapter was written.
        self._stuck_since_ns = 0
        #: Whether the previous frame was accepted.
        self._taking = True
        #: When the adapter last sent something or was queried (monotonic).
        self._opened_s = self._quiet_since_s = time.monotonic()

    def _send_one(self, frame: Frame, give_up_s: float) -> None:
        if self._asked and self._outage is None and not self.lossless:
            # Only an answer from the adapter, which arrives by receiving, shows that it continues: waiting here is
            # useless.
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
        """Whether an answer of the adapter has been outstanding for too long."""
        oldest_ns = self._oldest_ns()
        return self._answers and oldest_ns != _QUESTION_NS and now_ns - oldest_ns > STALE_NS

    def _oldest_ns(self) -> int:
        """When the oldest unanswered frame was written."""
        return next((written_ns for written_ns in self._unanswered if written_ns != _QUESTION_NS), _QUESTION_NS)

    def _silent_s(self) -> float:
        """Time for which a stuck adapter has not answered."""
        return (time.monotonic_ns() - self._stuck_since_ns) / 1e9

    def _say_stuck(self) -> None:
        if not self._has_said and self._silent_s() > _SAY_S:
            self._has_said = True
            self._say(f"{self.where} takes no frames for {self._silent_s():.2f} s; they are dropped until it does")

    def _ask_again(self) -> None:
        """Probe again: the probe itself may have been lost."""
        now_ns = time.monotonic_ns()
        if now_ns - self._asked_ns > _ASK_AGAIN_NS:
            self._asked_ns = now_ns
            with contextlib.suppress(BlockingIOError):
                self._write(b"\r")

    def _write(self, line: bytes) -> None:
        """Write a line after the rest of the previous one.

        :raises BlockingIOError: the port accepts nothing of this line now.
        """
        self._put_rest()
        self._rest = line[os.write(self._fd, line) :]

    def _put_rest(self) -> None:
        while self._rest:
            self._rest = self._rest[os.write(self._fd, self._rest) :]

    def _discard(self) -> None:
        """Discard the data in the port's buffer, if its driver can, and terminate a line that was accepted in part.

        The answer to the resulting empty line shows that the adapter is alive.
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
            # Checked during a long wait and over many short ones: bus-off shows only as silence.
            ask_s = max(0.0, self._quiet_since_s + _SILENCE_S - now_s)
            ports = (self._fd,)
            readable, writable, _ = select.select(
                ports, ports if self._rest else (), (), ask_s if rest_s is None else min(rest_s, ask_s)
            )
            if writable:
                with contextlib.suppress(BlockingIOError):
                    # Writable, but not for the whole line.
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
            # Only answers, no frames: keep waiting.
            if frames or rest_s == 0.0:
                return frames

    def _ask_status(self) -> None:
        """Query an adapter that has been silent for too long whether it is on the bus at all."""
        now_s = time.monotonic()
        if now_s - self._quiet_since_s < _SILENCE_S:
            return
        self._quiet_since_s = now_s
        # A full port or a stuck adapter is another problem: no query then.
        if not self._rest and (self.lossless or not self._is_stuck(time.monotonic_ns())):
            with contextlib.suppress(BlockingIOError):
                self._write(b"F\r")
                self._unanswered.append(_QUESTION_NS)

    def _frames(self, data: bytes) -> list[Frame]:
        """Frames of the complete lines in ``data``; the rest after the last one is kept."""
        if self._ended_by_cr:
            # The LF of a line that ended with what was read before.
            data = data.removeprefix(b"\n")
        self._ended_by_cr = data.endswith(b"\r")
        frames: list[Frame] = []
        start = 0
        for end in _END.finditer(data):
            line, start = data[start : end.start()], end.end()
            if line[:1] and line[:1] in FRAME_LETTERS:
                try:
                    frames.append(from_line(line, may_have_stamp=True))
                except ValueError:
                    self._count_garbage()
            elif line in _TAKEN:
                self._answered(refused=data[end.start()] == _BELL)
            elif _STATUS.fullmatch(line):
                self._take_status(int(line[1:], 16))
            else:
                self._count_garbage()
        self._partial = data[start:]
        if len(self._partial) > LINE_MAX_BYTES:
            self._count_garbage()
            self._partial = b""
        return frames

    def _answered(self, *, refused: bool) -> None:
        """The adapter's answer to the oldest frame.

        :raises BusLost: in lockstep, for a refused frame, because later frames may already be on the bus.
        """
        while self._unanswered and self._unanswered[0] == _QUESTION_NS:
            self._unanswered.popleft()
            if refused:
                # It does not know the query.
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
        """A stuck adapter is alive. Its outstanding answers cannot be told apart from those to discarded frames."""
        if self._has_said:
            self._say(f"{self.where} takes frames again after {self._silent_s():.2f} s")
        self._unanswered.clear()
        self._asked = self._has_said = False

    def _take_status(self, flags: int) -> None:
        if self._asked:
            self._goes_on()
        # Everything written before the query has been answered, or its answer was lost.
        while _QUESTION_NS in self._unanswered and self._unanswered.popleft() != _QUESTION_NS:
            pass
        if flags & _BUS_ERROR and self._outage is None:
            self.counters["bus_off"] += 1
            reason = f"the adapter reports bus errors, status {flags:02X}: bus-off, wrong bit rate or no second node"
            self._go_out(reason, bus_off=True)
        elif not flags & _BUS_ERROR and self._outage is not None and self._outage.bus_off:
            self._came_back()
