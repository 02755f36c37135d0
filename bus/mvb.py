"""MVB frames: check sequence, master word, and their mapping onto CAN frames.

Source: IEC 61375-3-1. The check sequence of a 16, 32 or 64 bit block is the 7-bit remainder of G(x) =
x^7+x^6+x^5+x^2+1, extended by one even-parity bit over data *and* remainder, all inverted.

Single-frame telegram (F0, F1), one CAN frame of 8 bytes::

      0   1   2   3    4     5    6     7
    +---------------+-----+---------+-------+
    |     data      | CS  | master  | CS of |
    | (F0: 2 bytes) |     |  word   | master|
    +---------------+-----+---------+-------+

Longer telegrams: every 64-bit block as a frame of its own on ``address + k``, then the trailer on ``address + 4``::

      0     1     2     3      4         5    6     7
    +-----+-----+-----+-----+--------+---------+-------+
    | CS0 | CS1 | CS2 | CS3 | seq |n | master  | CS of |
    |     (unused = 00)     |  4  |4 |  word   | master|
    +-----------------------+--------+---------+-------+

CAN FD form, on ``address + 5``: the classic payloads concatenated (F4 padded to 48 bytes).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache
from struct import Struct
from typing import Final

from railhil.bus.frame import FD, Frame, quick_frame
from railhil.bus.packing import pack_frame
from railhil.dbc import Port, house_contract

#: Generator without its x^7 term.
_POLYNOMIAL: Final = 0x65
F_DEVICE_STATUS: Final = 15
#: Payload of a single-frame telegram (data padded, check sequence, tail), and of a trailer (check sequences padded).
_SINGLE: Final[Callable[[bytes, int, bytes], bytes]] = Struct("4sB3s").pack
_SINGLE_PARTS: Final[Callable[[bytes], tuple[int, int, int, bytes]]] = Struct(">2HB3s").unpack
_TRAILER: Final[Callable[[bytes, bytes], bytes]] = Struct("4s4s").pack


def _check_octet(data: int) -> int:
    """Remainder and even parity of a number of data bits, as defined by the standard, before the inversion."""
    remainder = data << 7
    for bit in range(remainder.bit_length() - 1, 6, -1):
        if remainder >> bit & 1:
            remainder ^= (0x80 | _POLYNOMIAL) << (bit - 7)
    return remainder << 1 | (data.bit_count() + remainder.bit_count()) & 1


def _octets_of_bytes(shift: int) -> list[int]:
    """The octet of every byte at a number of bits from the end: the XOR of those of its bits. Only single bits are
    divided, because every process makes the tables at its start."""
    octets = [0]
    for bit in range(8):
        alone = _check_octet(1 << bit + shift)
        octets += [alone ^ octet for octet in octets]
    return octets


def _octets_of_words(place: int) -> bytes:
    """The octet of every 16-bit word at ``place`` words before the last one; inverted for the last."""
    low, high = (_octets_of_bytes(16 * place + shift) for shift in (0, 8))
    inversion = 0 if place else 0xFF
    row, everywhere = int.from_bytes(bytes(low)), int.from_bytes(b"\1" * 256)
    return b"".join((row ^ (octet ^ inversion) * everywhere).to_bytes(256) for octet in high)


#: The octet is linear in the data, so it is the XOR of one table value per 16-bit word, by its place from the end.
_W0: Final = _octets_of_words(0)
_W1: Final = _octets_of_words(1)
_W2: Final = _octets_of_words(2)
_W3: Final = _octets_of_words(3)
#: The four tables for a block of 8 bytes, first word first; one of 4 bytes has the last two, one of 2 bytes the last.
CHECK_TABLES: Final = (_W3, _W2, _W1, _W0)
_FOUR_WORDS: Final[Callable[[bytes], tuple[int, int, int, int]]] = Struct(">4H").unpack
_TWO_WORDS: Final[Callable[[bytes], tuple[int, int]]] = Struct(">2H").unpack


def check_sequence(block: bytes) -> int:
    """Check octet of one block of 2, 4 or 8 data bytes (other lengths up to 8 follow the same rule).

    :raises struct.error: more than 8 bytes.
    """
    size = len(block)
    if size == 8:
        a, b, c, d = _FOUR_WORDS(block)
        return _W3[a] ^ _W2[b] ^ _W1[c] ^ _W0[d]
    if size == 4:
        a, b = _TWO_WORDS(block)
        return _W1[a] ^ _W0[b]
    # Leading zeros change neither remainder nor parity.
    a, b, c, d = _FOUR_WORDS(block.rjust(8, b"\0"))
    return _W3[a] ^ _W2[b] ^ _W1[c] ^ _W0[d]


def single_frame_fault(payload: bytes, data_bytes: int, tail: bytes) -> str:
    """Cause of refusal of the 8 bytes of a single-frame telegram, in the words of the traffic store; empty if accepted.

    :param data_bytes: of its port, 2 or 4.
    :param tail: its :func:`master_tail`.
    """
    # As check_sequence, without taking the frame apart in slices: half of all frames are single ones.
    a, b, octet, found = _SINGLE_PARTS(payload)
    if (_W1[a] ^ _W0[b] if data_bytes == 4 else _W0[a]) != octet:
        return "wrong_check_sequence"
    return "" if found == tail else "wrong_master_word"


def master_word(f_code: int, address: int) -> bytes:
    """The 16-bit master word ``F_code << 12 | address``, big-endian."""
    return (f_code << 12 | address).to_bytes(2)


@cache
def master_frame(f_code: int, address: int) -> Frame:
    """The master frame with which the bus administrator polls a telegram (CAN: 3 bytes on the poll id)."""
    word = master_word(f_code, address)
    return Frame(house_contract().poll_id, word + bytes([check_sequence(word)]))


@lru_cache(maxsize=256)
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


class TelegramSource:
    """Turns the process data of one port into CAN frames; counts the telegrams in the trailer's ``seq``.

    :param fd: send the CAN FD form instead of the classic one.
    """

    __slots__ = ("_address", "_ends", "_fd", "_heads", "_padded_bytes", "_port", "_sequence", "_size", "_split")

    def __init__(self, port: Port, fd: bool = False) -> None:
        self._port = port
        self._fd = fd
        self._size = port.data_bytes
        tail = master_tail(port.f_code, port.address)
        # The tail after the check sequences, for each value of the counter; a single frame has no counter.
        sequences = range(1 if port.single_frame else 16)
        self._ends = [tail if port.single_frame else bytes((seq << 4 | port.blocks,)) + tail for seq in sequences]
        self._split = Struct("8s" * port.blocks).unpack
        #: Identifier of the first block; the trailer has that of a fifth.
        self._address = port.address
        # F4 has 40 bytes, which is not a valid CAN FD length.
        self._padded_bytes = 48 if port.f_code == 4 else port.data_bytes + 8
        self._sequence = 0
        # The bytes before the data of each packed frame.
        self._heads = [pack_frame(Frame(can_id, bytes(8)))[:-8] for can_id in port.can_ids]

    def packed(self, data: bytes) -> bytes:
        """The frames of :meth:`frames`, the classic ones, as they are packed (:mod:`railhil.bus.packing`)."""
        if len(data) != self._size:
            raise ValueError(f"{self._port.name}: found {len(data)} data bytes, allowed {self._size}")
        heads = self._heads
        if self._size <= 4:
            return heads[0] + _SINGLE(data, check_sequence(data), self._ends[0])
        sequence = self._sequence
        self._sequence = (sequence + 1) & 0xF
        parts: list[bytes] = []
        octets = bytearray()
        for head, block in zip(heads[:-1], self._split(data), strict=True):
            parts.append(head)
            parts.append(block)
            octets.append(check_sequence(block))
        parts.append(heads[-1])
        parts.append(_TRAILER(bytes(octets), self._ends[sequence]))
        return b"".join(parts)

    def frames(self, data: bytes) -> list[Frame]:
        """CAN frames of one telegram.

        ``data``: exactly ``port.data_bytes`` bytes; ValueError otherwise.
        """
        if len(data) != self._size:
            raise ValueError(f"{self._port.name}: found {len(data)} data bytes, allowed {self._size}")
        if self._size <= 4:
            if self._size == 4:
                # As check_sequence: half of all frames come from here.
                a, b = _TWO_WORDS(data)
                payload = _SINGLE(data, _W1[a] ^ _W0[b], self._ends[0])
            else:
                payload = _SINGLE(data, check_sequence(data), self._ends[0])
            return [Frame(self._port.fd_id, payload, FD) if self._fd else quick_frame((self._address, payload, 0))]
        sequence = self._sequence
        self._sequence = (sequence + 1) & 0xF
        blocks = self._split(data)
        trailer = _TRAILER(bytes(map(check_sequence, blocks)), self._ends[sequence])
        if self._fd:
            return [Frame(self._port.fd_id, (data + trailer).ljust(self._padded_bytes, b"\0"), FD)]
        can_id = self._address
        frames: list[Frame] = []
        for block in blocks:
            frames.append(quick_frame((can_id, block, 0)))
            can_id += 1
        frames.append(quick_frame((self._address + 4, trailer, 0)))
        return frames


def device_status_frame(device: int, status: int) -> Frame:
    """Answer to a device status poll (F_code 15): a 16-bit telegram in the single-frame layout."""
    data = status.to_bytes(2)
    payload = data + b"\0\0" + bytes([check_sequence(data)]) + master_tail(F_DEVICE_STATUS, device)
    return Frame(house_contract().device_status_id, payload)


def parse_device_status(data: bytes) -> tuple[int, int] | None:
    """``(device, status)`` of a device status answer, or None when it is invalid."""
    return None if device_status_fault(data) else (int.from_bytes(data[5:7]) & 0xFFF, int.from_bytes(data[:2]))


def device_status_fault(data: bytes) -> str:
    """The fault of a device status answer, in words; empty if it is valid."""
    if len(data) != 8:
        return f"wrong length, {len(data)} bytes instead of 8"
    if check_sequence(data[:2]) != data[4] or check_sequence(data[5:7]) != data[7]:
        return "wrong check sequence"
    return "" if data[5] >> 4 == F_DEVICE_STATUS else "wrong master word"
