"""One CAN frame as a line of the slcan protocol, without its carriage return::

    tiiiLdd...          standard data frame: identifier 3 digits, length 1, data        r: remote
    TiiiiiiiiLdd...     extended data frame: identifier 8 digits                        R: remote
    d D                 CAN FD without bit rate switch, length is the 4-bit code        b B: with

Source: Lawicel CAN232 manual, version 3 (t T r R); CANable 2.0 slcan firmware (d D b B).
"""

from __future__ import annotations

from railhil.bus.frame import BRS, EXTENDED, FD, REMOTE, Frame

#: The longest line: an extended FD frame of 64 bytes with a time stamp.
LINE_MAX_BYTES = 1 + 8 + 1 + 128 + 4
#: First letters of lines that carry a frame.
FRAME_LETTERS = b"tTrRdDbB"

_KINDS = {b"t": 0, b"r": REMOTE, b"d": FD, b"b": FD | BRS}
_LETTERS = {flags: letter for letter, flags in _KINDS.items()}
_FD_BYTES = (*range(9), 12, 16, 20, 24, 32, 48, 64)
_ID_MAX, _EXTENDED_ID_MAX = 0x7FF, 0x1FFF_FFFF
_HEX = frozenset(b"0123456789ABCDEFabcdef")
_STAMP_DIGITS = 4


def to_line(frame: Frame) -> bytes:
    """The line of a frame.

    :raises ValueError: an error frame, for which the protocol has no line.
    """
    letter = _LETTERS.get(frame.flags & ~EXTENDED)
    if letter is None:
        raise ValueError("an error frame has no slcan line")
    length = _FD_BYTES.index(len(frame.data))
    data = b"" if frame.flags & REMOTE else frame.data.hex().upper().encode()
    if frame.flags & EXTENDED:
        return b"%s%08X%X%s" % (letter.upper(), frame.can_id, length, data)
    return b"%s%03X%X%s" % (letter, frame.can_id, length, data)


def from_line(line: bytes, *, may_have_stamp: bool = False) -> Frame:
    """The frame of a line that begins with one of :data:`FRAME_LETTERS`.

    :param may_have_stamp: four more digits, the adapter's time in ms (command ``Z1``), are allowed and discarded.
    :raises ValueError: anything that is not exactly one frame.
    """
    letter, digits = line[:1], line[1:]
    flags = _KINDS[letter.lower()] | (EXTENDED if letter.isupper() else 0)
    width = 8 if flags & EXTENDED else 3
    if len(digits) <= width or not _HEX.issuperset(digits):
        raise ValueError("no identifier and length in hexadecimal digits")
    can_id, code = int(digits[:width], 16), int(digits[width : width + 1], 16)
    if can_id > (_EXTENDED_ID_MAX if flags & EXTENDED else _ID_MAX) or (code > 8 and not flags & FD):
        raise ValueError("identifier or length out of range")
    length, data = _FD_BYTES[code], digits[width + 1 :]
    data_digits = 0 if flags & REMOTE else 2 * length
    if len(data) != data_digits and not (may_have_stamp and len(data) == data_digits + _STAMP_DIGITS):
        raise ValueError("not as much data as the length says")
    return Frame(can_id, bytes(length) if flags & REMOTE else bytes.fromhex(data[:data_digits].decode()), flags)
