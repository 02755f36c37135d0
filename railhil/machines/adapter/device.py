"""The adapter's firmware: commands from the host in, answers and frames out. It performs no input or output itself."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from railhil.bus.frame import ERROR, Frame
from railhil.bus.link.slcanline import FRAME_LETTERS, LINE_MAX_BYTES, from_line, to_line

OK = b"\r"
BELL = b"\a"

#: Bit rates of the commands S0..S8, bit/s.
BIT_RATES = (10_000, 20_000, 50_000, 100_000, 125_000, 250_000, 500_000, 800_000, 1_000_000)
_DATA_BIT_RATES = b"25"

#: Status flags that ``F`` answers (Lawicel CAN232, bits of the SJA1000).
RX_QUEUE_FULL = 0x01
TX_QUEUE_FULL = 0x02
ERROR_WARNING = 0x04
DATA_OVERRUN = 0x08
ERROR_PASSIVE = 0x20
BUS_ERROR = 0x80


@dataclass(frozen=True, slots=True)
class Build:
    """The adapter's hardware: queue sizes in frames and bytes, and the bit rate of the connected bus (bit/s).

    ``bus_bit_rate`` None: every bit rate set by the host is correct. ``answers`` False: it sends only its version and
    received frames, like the firmware of the first CANable.
    """

    transmit_queue_frames: int = 16
    receive_queue_bytes: int = 65536
    bus_bit_rate: int | None = None
    answers: bool = True


class Device:
    """One powered adapter.

    :param build: sizes.
    :ivar to_host: bytes waiting for the host.
    :ivar counters: ``transmitted`` and ``received`` frames; ``refused_lines`` answered with BELL, of these
        ``refused_frames`` (closed channel, listen only) and ``transmit_queue_full``; ``receive_overrun`` (the host did
        not read), ``not_on_bus`` (frames on the bus while the channel was closed, bus-off or at the wrong bit rate),
        ``closed`` channels.
    """

    def __init__(self, build: Build) -> None:
        self.build = build
        self.to_host = bytearray()
        self.counters: Counter[str] = Counter()
        #: Bit rate set by the host, None before ``S`` or ``s``.
        self.bit_rate: int | None = None
        self.is_open = False
        self.is_listening_only = False
        self.is_bus_off = False
        self._has_timestamps = False
        self._line = bytearray()
        self._is_line_too_long = False
        self._queue: deque[Frame] = deque()
        self._flags = 0

    # -- the host's side ------------------------------------------------------------------------------------------

    def host_wrote(self, data: bytes) -> bool:
        """Take bytes from the host; answers are appended to ``to_host``.

        :returns: True if they closed the channel.
        """
        closings = self.counters["closed"]
        for octet in data:
            if octet != OK[0]:
                self._is_line_too_long = len(self._line) >= LINE_MAX_BYTES
                if not self._is_line_too_long:
                    self._line.append(octet)
                continue
            line, self._line = bytes(self._line), bytearray()
            answer = BELL if self._is_line_too_long else self._command(line)
            self._is_line_too_long = False
            if answer == BELL:
                self.counters["refused_lines"] += 1
            if self.build.answers or line[:1] == b"V":
                self.to_host += answer
        return self.counters["closed"] > closings

    def _command(self, line: bytes) -> bytes:
        letter = line[:1]
        if letter and letter in FRAME_LETTERS:
            return self._transmit(letter, line)
        action = _COMMANDS.get(letter)
        return BELL if action is None else action(self, line[1:])

    def _transmit(self, letter: bytes, line: bytes) -> bytes:
        try:
            frame = from_line(line)
        except ValueError:
            return BELL
        if not self.is_open or self.is_listening_only:
            self.counters["refused_frames"] += 1
            return BELL
        if len(self._queue) >= self.build.transmit_queue_frames:
            self._flags |= TX_QUEUE_FULL
            self.counters["transmit_queue_full"] += 1
            return BELL
        self._queue.append(frame)
        return (b"Z" if letter.isupper() else b"z") + OK

    def _set_bit_rate(self, digits: bytes) -> bytes:
        if self.is_open or len(digits) != 1 or not b"0" <= digits <= b"8":
            return BELL
        self.bit_rate = BIT_RATES[int(digits)]
        return OK

    def _set_timing_registers(self, digits: bytes) -> bytes:
        """``sxxyy``: BTR0 and BTR1 of an SJA1000 at 8 MHz."""
        try:
            btr0, btr1 = bytes.fromhex(digits.decode("ascii"))
        except ValueError:
            return BELL
        if self.is_open:
            return BELL
        time_quanta = 1 + (btr1 & 0xF) + 1 + (btr1 >> 4 & 0x7) + 1
        self.bit_rate = 8_000_000 // ((btr0 & 0x3F) + 1) // time_quanta
        return OK

    def _set_data_bit_rate(self, digits: bytes) -> bytes:
        return OK if not self.is_open and len(digits) == 1 and digits in _DATA_BIT_RATES else BELL

    def _set_timestamps(self, digits: bytes) -> bytes:
        if self.is_open or digits not in (b"0", b"1"):
            return BELL
        self._has_timestamps = digits == b"1"
        return OK

    def _open(self, digits: bytes, listen_only: bool) -> bytes:
        if digits or self.is_open or self.bit_rate is None:
            return BELL
        self.is_open, self.is_listening_only = True, listen_only
        return OK

    def _close(self, digits: bytes) -> bytes:
        if digits or not self.is_open:
            return BELL
        self.is_open = False
        self.counters["closed"] += 1
        self._queue.clear()
        self._flags = 0
        self.is_bus_off = False
        # Unread data of the closed channel are discarded.
        self.to_host.clear()
        return OK

    def _status(self, digits: bytes) -> bytes:
        if digits or not self.is_open:
            return BELL
        flags, self._flags = self._flags, 0
        if self.is_bus_off or not self._is_bit_rate_right():
            flags |= ERROR_WARNING | ERROR_PASSIVE | BUS_ERROR
        return b"F%02X" % flags + OK

    # -- the bus's side -------------------------------------------------------------------------------------------

    def _is_bit_rate_right(self) -> bool:
        return self.build.bus_bit_rate in (None, self.bit_rate)

    def _is_on_bus(self) -> bool:
        return self.is_open and not self.is_bus_off and self._is_bit_rate_right()

    def bus_sent(self, frames: Iterable[Frame], time_ms: int) -> None:
        """Take frames from the bus at ``time_ms`` of the adapter's clock; error frames have no slcan line."""
        for frame in frames:
            if not self._is_on_bus():
                self.counters["not_on_bus"] += 1
            elif len(self.to_host) >= self.build.receive_queue_bytes:
                self._flags |= RX_QUEUE_FULL | DATA_OVERRUN
                self.counters["receive_overrun"] += 1
            elif not frame.flags & ERROR:
                self.counters["received"] += 1
                stamp = b"%04X" % (time_ms % 60_000) if self._has_timestamps else b""
                self.to_host += to_line(frame) + stamp + OK

    def transmit(self) -> list[Frame]:
        """Frames that leave the transmit queue for the bus now, oldest first; transmission takes no time."""
        if not self._is_on_bus():
            return []
        frames = list(self._queue)
        self._queue.clear()
        self.counters["transmitted"] += len(frames)
        return frames

    @property
    def waiting_frames(self) -> int:
        """Frames in the transmit queue."""
        return len(self._queue)

    def go_bus_off(self) -> None:
        """The CAN controller goes bus-off. Frames waiting for transmission stay queued: the firmware does not touch
        them."""
        self.is_bus_off = True

    def restart(self) -> None:
        """The firmware restarts a CAN controller that was bus-off; the waiting frames go out."""
        self.is_bus_off = False


_COMMANDS: dict[bytes, Callable[[Device, bytes], bytes]] = {
    # python-can writes an empty line if there is no data bit rate, and users write one to clear the line.
    b"": lambda device, digits: OK,
    b"S": Device._set_bit_rate,
    b"s": Device._set_timing_registers,
    b"Y": Device._set_data_bit_rate,
    b"Z": Device._set_timestamps,
    b"O": lambda device, digits: device._open(digits, listen_only=False),
    b"L": lambda device, digits: device._open(digits, listen_only=True),
    b"C": Device._close,
    b"F": Device._status,
    b"V": lambda device, digits: BELL if digits else b"V1013" + OK,
    b"N": lambda device, digits: BELL if digits else b"NRH01" + OK,
}
