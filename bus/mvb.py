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


#: Longest block in bytes.
_BLOCK_BYTES = 8


def _check_octet(data: int) -> int:
    """Remainder and even parity of a number of data bits, as the standard says it, before the inversion."""
    remainder = data << 7
    for bit in range(remainder.bit_length() - 1, 6, -1):
        if remainder >> bit & 1:
            remainder ^= (0x80 | _POLYNOMIAL) << (bit - 7)
    return remainder << 1 | (data.bit_count() + remainder.bit_count()) & 1


#: The octet is linear in the data, so it is the xor of one table value for each byte, by its place from the end.
_BY_PLACE = tuple(tuple(_check_octet(value << 8 * place) for value in range(256)) for place in range(_BLOCK_BYTES))
_P0, _P1, _P2, _P3, _P4, _P5, _P6, _P7 = _BY_PLACE


def check_sequence(block: bytes) -> int:
    """Check octet of one block of 2, 4 or 8 data bytes (other lengths up to 8 give the octet of the same rule).

    :raises IndexError: more than 8 bytes.
    """
    if len(block) == 8:
        a, b, c, d, e, f, g, h = block
        return 0xFF ^ _P7[a] ^ _P6[b] ^ _P5[c] ^ _P4[d] ^ _P3[e] ^ _P2[f] ^ _P1[g] ^ _P0[h]
    if len(block) == 4:
        a, b, c, d = block
        return 0xFF ^ _P3[a] ^ _P2[b] ^ _P1[c] ^ _P0[d]
    octet = 0xFF
    for place, byte in enumerate(reversed(block)):
        octet ^= _BY_PLACE[place][byte]
    return octet


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

    __slots__ = ("_block_ids", "_fd", "_pad", "_padded_bytes", "_port", "_sequence", "_size", "_tail", "_trailer_id")

    def __init__(self, port: Port, fd: bool = False) -> None:
        self._port = port
        self._fd = fd
        self._tail = master_tail(port.f_code, port.address)
        self._size = port.data_bytes
        self._block_ids = range(port.address, port.address + port.blocks)
        self._trailer_id = port.address + 4
        self._pad = b"\0" * (4 - port.blocks)
        # F4 has 40 bytes, a length that CAN FD does not know.
        self._padded_bytes = 48 if port.f_code == 4 else port.data_bytes + 8
        self._sequence = 0

    def frames(self, data: bytes) -> list[Frame]:
        """CAN frames of one telegram.

        ``data``: exactly ``port.data_bytes`` bytes; ValueError otherwise.
        """
        if len(data) != self._size:
            raise ValueError(f"{self._port.name}: found {len(data)} data bytes, allowed {self._size}")
        if self._size <= 4:
            payload = data.ljust(4, b"\0") + bytes((check_sequence(data),)) + self._tail
            return [Frame(self._port.fd_id, payload, FD) if self._fd else Frame(self._block_ids[0], payload)]
        sequence = self._sequence
        self._sequence = (sequence + 1) & 0xF
        frames, sums = [], []
        for index, can_id in enumerate(self._block_ids):
            block = data[8 * index : 8 * index + 8]
            sums.append(check_sequence(block))
            frames.append(Frame(can_id, block))
        trailer = bytes(sums) + self._pad + bytes((sequence << 4 | len(sums),)) + self._tail
        if self._fd:
            return [Frame(self._port.fd_id, (data + trailer).ljust(self._padded_bytes, b"\0"), FD)]
        frames.append(Frame(self._trailer_id, trailer))
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
