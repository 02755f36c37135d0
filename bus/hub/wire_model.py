"""Effects of a wire that the plain hub does not have: frames take time, and arbitrate by identifier.

Both are off by default. Each client is a CAN controller with one first-in-first-out transmit queue.

*Bit rate*: one frame at a time is on the wire, for its exact length (:func:`frame_bits`), and is
delivered at its end. Time is the monotonic clock of the hub process; a hub that is woken late catches up,
so rounding does not accumulate.

*Arbitration*: when the wire becomes idle, the frame with the lowest arbitration key among those at the heads of the
queues is sent first. Without a bit rate the wire is always idle; then the frames found waiting in one pass of
the hub's loop arbitrate. In a tie (the same identifier from two clients, an error on a real bus) the earlier arrival
wins.

Not modelled: acknowledgement, propagation delay; errors do not lengthen a frame (:mod:`railhil.bus.hub.disturbances`).

Bit times of a frame count its stuff bits exactly.

Classic frames (Bosch CAN 2.0; ISO 11898-1): the field from start of frame to the end of the CRC is stuffed
(after five equal bits one opposite bit, which counts for the next five), then come CRC delimiter,
acknowledge slot and delimiter, 7 bits end of frame and 3 bits interframe space::

    SOF 1 | id 11 | RTR IDE r0 | DLC 4 | data 8n | CRC 15 || 1 | 2 | 7 | 3         standard
    SOF 1 | id 11 | SRR IDE | id 18 | RTR r1 r0 | DLC 4 | data 8n | CRC 15 || ...  extended

CAN FD frames: stuffed up to the end of the data; then stuff count (4 bits) and CRC (17 bits up to 16 data
bytes, else 21) with a fixed stuff bit before the first and after every fourth bit, so their number does not depend on
values. With bit rate switch, ESI to CRC delimiter count at the data bit rate.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.hub.ports import SwitchPort
from railhil.bus.packing import CLASSIC_SIZE, FD_SIZE, unpack_frames

#: CRC delimiter, acknowledge slot, acknowledge delimiter, end of frame, interframe space.
_TAIL_BITS = 1 + 1 + 1 + 7 + 3
_FD_DLC = {**{n: n for n in range(9)}, 12: 9, 16: 10, 20: 11, 24: 12, 32: 13, 48: 14, 64: 15}


def crc15(bits: str) -> int:
    """CRC-15/CAN (polynomial 0x4599, start 0) over a string of '0' and '1'."""
    register = 0
    for bit in bits:
        feedback = (register >> 14 & 1) ^ (bit == "1")
        register = register << 1 & 0x7FFF
        if feedback:
            register ^= 0x4599
    return register


def stuff_bit_positions(bits: str, at_end: bool) -> list[int]:
    """Indices in ``bits`` after which a stuff bit is inserted; ``at_end``: one may follow the last bit."""
    positions: list[int] = []
    run, last = 0, ""
    for index, bit in enumerate(bits):
        run = run + 1 if bit == last else 1
        last = bit
        if run == 5:
            positions.append(index)
            # The stuff bit has the opposite value and is the first bit of the next run.
            last = "1" if bit == "0" else "0"
            run = 1
    if positions and not at_end and positions[-1] == len(bits) - 1:
        positions.pop()
    return positions


def _identifier_bits(frame: Frame, remote: str) -> str:
    """Start of frame to identifier, with RTR (CAN FD: RRS) and IDE."""
    if frame.flags & EXTENDED:
        return f"0{frame.can_id >> 18:011b}11{frame.can_id & 0x3FFFF:018b}{remote}"
    return f"0{frame.can_id:011b}{remote}0"


def _data_bits(data: bytes) -> str:
    return "".join(f"{octet:08b}" for octet in data)


def _classic_bits(frame: Frame) -> int:
    remote = bool(frame.flags & REMOTE)
    reserved = "00" if frame.flags & EXTENDED else "0"
    content = _identifier_bits(frame, "1" if remote else "0") + reserved + f"{len(frame.data):04b}"
    if not remote:
        content += _data_bits(frame.data)
    content += f"{crc15(content):015b}"
    return len(content) + len(stuff_bit_positions(content, at_end=True)) + _TAIL_BITS


def _fd_bits(frame: Frame) -> tuple[int, int]:
    switched = bool(frame.flags & BRS)
    # Identifier, FDF 1, res 0, BRS | ESI 0 (error active), DLC, data.
    nominal = _identifier_bits(frame, "0") + "10" + ("1" if switched else "0")
    content = nominal + "0" + f"{_FD_DLC[len(frame.data)]:04b}" + _data_bits(frame.data)
    check_bits = 4 + (17 if len(frame.data) <= 16 else 21)
    fixed_stuff_bits = 1 + check_bits // 4
    # No dynamic stuff bit at the end of the data: the first fixed stuff bit is there.
    positions = stuff_bit_positions(content, at_end=False)
    early_stuff_bits = sum(index < len(nominal) - 1 for index in positions)
    total = len(content) + len(positions) + fixed_stuff_bits + check_bits + _TAIL_BITS
    if not switched:
        return total, 0
    nominal_total = len(nominal) + early_stuff_bits + _TAIL_BITS - 1
    return nominal_total, total - nominal_total


def frame_bits(frame: Frame) -> tuple[int, int]:
    """Bit times of a frame: (at the nominal bit rate, at the data bit rate), interframe space included.

    An error frame takes none: SocketCAN's error frames are reports of a controller, not frames on the wire.
    """
    if frame.flags & ERROR:
        return 0, 0
    if frame.flags & FD:
        return _fd_bits(frame)
    return _classic_bits(frame), 0


def arbitration_key(frame: Frame) -> int:
    """Rank in arbitration: the lowest wins, as the first dominant bit does on the wire.

    Order of the bits: base identifier, RTR or SRR, IDE, identifier extension, RTR of the extended frame. A standard
    frame therefore wins against an extended one with the same base identifier, and a data frame against the remote
    frame. Error frames come first (they are not bus traffic, see :func:`frame_bits`).
    """
    can_id, _, flags = frame
    if flags & ERROR:
        return -1
    remote = 1 if flags & REMOTE else 0
    if flags & EXTENDED:
        return (can_id >> 18) << 21 | 0b11 << 19 | (can_id & 0x3FFFF) << 1 | remote
    return can_id << 21 | remote << 20


#: A client with this many waiting frames is not read until some have been sent: its ``send`` then blocks, as with the
#: transmit queue of a real interface. (One more packet may be queued.)
PENDING_LIMIT_FRAMES = 512


class _Pending(NamedTuple):
    arbitration_key: int
    sequence: int
    arrival_ns: int
    duration_ns: int
    source: SwitchPort
    packet: bytes


class WireModel:
    """The wire between the ports; ``bitrate_bps`` None means that frames take no time.

    ``data_bitrate_bps`` applies to CAN FD frames with bit rate switch.
    """

    def __init__(self, bitrate_bps: int | None, data_bitrate_bps: int | None, arbitration: bool) -> None:
        self._nominal_bit_ns = 0.0 if bitrate_bps is None else 1e9 / bitrate_bps
        self._data_bit_ns = 0.0 if data_bitrate_bps is None else 1e9 / data_bitrate_bps
        self._arbitration = arbitration
        self._queues: dict[SwitchPort, deque[_Pending]] = {}
        self._sequence = 0
        self._on_wire: _Pending | None = None
        self._wire_free_ns = 0

    def offer(self, source: SwitchPort, packet: bytes, arrival_ns: int) -> None:
        """Append the frames of a valid packet to the source's queue."""
        queue = self._queues.setdefault(source, deque())
        step = len(packet) if len(packet) == FD_SIZE else CLASSIC_SIZE
        for index, frame in enumerate(unpack_frames(packet)):
            nominal_bits, data_bits = frame_bits(frame)
            duration_ns = round(nominal_bits * self._nominal_bit_ns + data_bits * self._data_bit_ns)
            key = arbitration_key(frame) if self._arbitration else 0
            piece = packet[index * step : (index + 1) * step]
            queue.append(_Pending(key, self._sequence, arrival_ns, duration_ns, source, piece))
            self._sequence += 1

    def is_full(self, source: SwitchPort) -> bool:
        """True if the source must wait before it offers more."""
        return len(self._queues.get(source, ())) >= PENDING_LIMIT_FRAMES

    def due(self, now_ns: int) -> list[tuple[SwitchPort, bytes]]:
        """Frames whose transmission has ended by ``now_ns``: (source, packet) in the order of the wire."""
        delivered: list[tuple[SwitchPort, bytes]] = []
        while True:
            if self._on_wire is None:
                self._on_wire = self._next_on_wire()
            if self._on_wire is None or self._wire_free_ns > now_ns:
                return delivered
            delivered.append((self._on_wire.source, self._on_wire.packet))
            self._on_wire = None

    def next_due_ns(self) -> int | None:
        """Instant at which the next frame will end, None when the wire is idle. Call it after :meth:`due`."""
        return None if self._on_wire is None else self._wire_free_ns

    def pending_frames(self) -> int:
        """Frames offered and not yet delivered."""
        return sum(map(len, self._queues.values())) + (self._on_wire is not None)

    def _next_on_wire(self) -> _Pending | None:
        heads = [queue[0] for queue in self._queues.values()]
        if not heads:
            return None
        start_ns = max(self._wire_free_ns, min(head.arrival_ns for head in heads))
        winner = min(head for head in heads if head.arrival_ns <= start_ns)
        queue = self._queues[winner.source]
        queue.popleft()
        if not queue:
            del self._queues[winner.source]
        self._wire_free_ns = start_ns + winner.duration_ns
        return winner
