"""MVB frames: check sequence, master word, and their mapping onto CAN frames.

Source: IEC 61375-3-1 as settled in the bench's MVB notes. The check sequence of a 16, 32 or 64 bit block is the
7-bit remainder of G(x) = x^7+x^6+x^5+x^2+1, extended by one even-parity bit over data *and* remainder, all inverted.

Single-frame telegram (F0, F1), one CAN frame of 8 bytes::

      0   1   2   3    4     5    6     7
    +---------------+-----+---------+-------+
    |     data      | CS  | master  | CS of |
    | (F0: 2 bytes) |     |  word   | master|
    +---------------+-----+---------+-------+

Longer telegrams: every 64-bit block as a plain frame on ``address + k``, then the trailer on ``address + 4``::

      0     1     2     3      4         5    6     7
    +-----+-----+-----+-----+--------+---------+-------+
    | CS0 | CS1 | CS2 | CS3 | seq |n | master  | CS of |
    |     (unused = 00)     |  4  |4 |  word   | master|
    +-----------------------+--------+---------+-------+

CAN FD form, on ``address + 5``: the classic payloads one after the other (F4 padded to 48 bytes).
"""

from __future__ import annotations

from bus.frame import FD, Frame
from dbc import Port, wire_contract

#: Generator without its x^7 term.
_POLYNOMIAL = 0x65
F_DEVICE_STATUS = 15


def _remainder_table() -> tuple[int, ...]:
    table = []
    for value in range(256):
        register = value << 7
        for bit in range(14, 6, -1):
            if register >> bit & 1:
                register ^= (0x80 | _POLYNOMIAL) << (bit - 7)
        table.append(register)
    return tuple(table)


_REMAINDER = _remainder_table()
#: Inverted check octet by (remainder, data parity): index = remainder << 1 | parity of the data.
_OCTET = tuple(~(index & 0xFE | ((index & 1) ^ ((index >> 1).bit_count() & 1))) & 0xFF for index in range(256))


def check_sequence(block: bytes) -> int:
    """Check octet of one block of 2, 4 or 8 data bytes (other lengths give the octet of the same rule)."""
    remainder = 0
    for byte in block:
        remainder = _REMAINDER[(remainder << 1) ^ byte]
    return _OCTET[remainder << 1 | int.from_bytes(block).bit_count() & 1]


def master_word(f_code: int, address: int) -> bytes:
    """The 16-bit master word ``F_code << 12 | address``, big-endian."""
    return (f_code << 12 | address).to_bytes(2)


def master_frame(f_code: int, address: int) -> Frame:
    """The master frame with which the bus administrator asks for a telegram (CAN: 3 bytes on the poll id)."""
    word = master_word(f_code, address)
    return Frame(wire_contract().poll_id, word + bytes([check_sequence(word)]))


def parse_master_frame(data: bytes) -> tuple[int, int] | None:
    """``(f_code, address)`` of a master frame, or None when its length or check sequence is wrong."""
    if len(data) != 3 or check_sequence(data[:2]) != data[2]:
        return None
    word = int.from_bytes(data[:2])
    return word >> 12, word & 0xFFF


def master_tail(f_code: int, address: int) -> bytes:
    """Master word and its check sequence, the last three bytes of every telegram on CAN."""
    word = master_word(f_code, address)
    return word + bytes([check_sequence(word)])


def block_length(f_code: int) -> int:
    """Bytes per checked block: 2 for F0, 4 for F1, 8 for longer telegrams."""
    return 2 << f_code if f_code < 2 else 8


def slave_frame(data: bytes) -> bytes:
    """The slave frame as it stands on a real MVB: each block followed by its check octet.

    ``data``: 2, 4, 8, 16 or 32 bytes.
    """
    step = min(len(data), 8)
    blocks = (data[i : i + step] for i in range(0, len(data), step))
    return b"".join(block + bytes([check_sequence(block)]) for block in blocks)


class TelegramSource:
    """Turns the process data of one port into CAN frames; counts the telegrams in the trailer's ``seq``.

    :param fd: send the CAN FD form instead of the classic one.
    """

    __slots__ = ("_blocks", "_fd", "_pad", "_port", "_sequence", "_tail")

    def __init__(self, port: Port, fd: bool = False) -> None:
        self._port = port
        self._fd = fd
        self._tail = master_tail(port.f_code, port.address)
        self._blocks = port.blocks
        self._pad = b"\0" * (4 - port.blocks)
        self._sequence = 0

    def frames(self, data: bytes) -> list[Frame]:
        """CAN frames of one telegram.

        ``data``: exactly ``port.data_bytes`` bytes; ValueError otherwise.
        """
        port = self._port
        if len(data) != port.data_bytes:
            raise ValueError(f"{port.name}: found {len(data)} data bytes, allowed {port.data_bytes}")
        address = port.address
        if port.f_code < 2:
            payload = data.ljust(4, b"\0") + bytes([check_sequence(data)]) + self._tail
            return [Frame(address + 5, payload, FD) if self._fd else Frame(address, payload)]
        sequence = self._sequence
        self._sequence = (sequence + 1) & 0xF
        blocks = [data[i : i + 8] for i in range(0, len(data), 8)]
        trailer = (
            bytes([check_sequence(block) for block in blocks])
            + self._pad
            + bytes([sequence << 4 | self._blocks])
            + self._tail
        )
        if self._fd:
            payload = data + trailer
            return [Frame(address + 5, payload.ljust(48, b"\0") if port.f_code == 4 else payload, FD)]
        frames = [Frame(address + k, block) for k, block in enumerate(blocks)]
        frames.append(Frame(address + 4, trailer))
        return frames


def device_status_frame(device: int, status: int) -> Frame:
    """Answer to a device status poll (F_code 15): a 16-bit telegram in the single-frame layout."""
    data = status.to_bytes(2)
    payload = data + b"\0\0" + bytes([check_sequence(data)]) + master_tail(F_DEVICE_STATUS, device)
    return Frame(wire_contract().device_status_id, payload)


def parse_device_status(data: bytes) -> tuple[int, int] | None:
    """``(device, status)`` of a device status answer, or None when it is not a right one."""
    if len(data) != 8 or check_sequence(data[:2]) != data[4] or check_sequence(data[5:7]) != data[7]:
        return None
    word = int.from_bytes(data[5:7])
    if word >> 12 != F_DEVICE_STATUS:
        return None
    return word & 0xFFF, int.from_bytes(data[:2])
