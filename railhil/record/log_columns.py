"""Parts of a candump log as columns, read and written, which takes less time than its lines one by one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

_DATA_BYTES = 8
#: Digits of the seconds of a time in ns of 64 bit, and of the microseconds behind the point.
_SECONDS_DIGITS, _MICROS_DIGITS = 10, 6
#: Character -> its hexadecimal value, 16: it is none.
_HEX = np.full(256, 16, np.uint8)
_HEX[list(b"0123456789ABCDEF")] = range(16)
#: The characters after the data.
_END = b" R\n"
#: Standard identifier -> its text with the mark behind it; number below 1000 -> three digits.
_STANDARD = np.frombuffer(b"".join(b"%03X#" % can_id for can_id in range(0x800)), "V4")
_THREE = np.frombuffer(b"".join(b"%03d" % number for number in range(1000)), np.uint8).reshape(1000, 3)


class ClassicColumns(NamedTuple):
    """Classic frames with standard identifiers: ``times_ns`` (n,), ``can_ids`` (n,), ``lengths`` (n,) in bytes, and
    ``data`` (n, 8), zero beyond its length."""

    times_ns: npt.NDArray[np.int64]
    can_ids: npt.NDArray[np.int64]
    lengths: npt.NDArray[np.int64]
    data: npt.NDArray[np.uint8]

    def rows(self, first: int, end: int) -> ClassicColumns:
        """The frames from ``first`` to just before ``end``."""
        return ClassicColumns(
            self.times_ns[first:end], self.can_ids[first:end], self.lengths[first:end], self.data[first:end]
        )

    def followed_by(self, other: ClassicColumns) -> ClassicColumns:
        """These frames and the others."""
        return ClassicColumns(
            np.concatenate((self.times_ns, other.times_ns)),
            np.concatenate((self.can_ids, other.can_ids)),
            np.concatenate((self.lengths, other.lengths)),
            np.concatenate((self.data, other.data)),
        )


def classic_columns(text: bytes, channel: str) -> ClassicColumns | None:
    """Columns of lines; None if there are none, or if any line has another form than the log's own.

    :param channel: the one in each line.
    """
    # The characters between the time and the identifier.
    middle = f") {channel} ".encode("ascii")
    # Margin for characters that are read before the first line and behind the last one.
    around = 2 * _DATA_BYTES
    chars = np.frombuffer(bytes(around) + text + bytes(around), np.uint8)
    marks, ends = np.flatnonzero(chars == ord("#")), np.flatnonzero(chars == ord("\n"))
    if len(marks) != len(ends) or not len(ends) or not text.endswith(b"\n"):
        return None
    starts = np.concatenate(([around], ends[:-1] + 1))
    digits = ends - marks - len(_END)
    micros = marks - 3 - len(middle) - _MICROS_DIGITS
    seconds_digits = micros - 2 - starts
    if digits.min() < 0 or digits.max() > 2 * _DATA_BYTES or (digits & 1).any():
        return None
    if seconds_digits.min() < 1 or seconds_digits.max() >= _SECONDS_DIGITS:
        return None
    written = [(starts, b"("), (micros - 1, b"."), (marks - 3 - len(middle), middle), (ends - len(_END) + 1, _END)]
    if not all((chars[at + k] == char).all() for at, word in written for k, char in enumerate(word)):
        return None
    values = _HEX[chars]
    seconds, good = _number(values, micros - 1 - _SECONDS_DIGITS, _SECONDS_DIGITS, 10, seconds_digits)
    fraction, good_fraction = _number(values, micros, _MICROS_DIGITS, 10)
    can_ids, good_ids = _number(values, marks - 3, 3, 16)
    places = np.arange(2 * _DATA_BYTES)
    nibbles = values[marks[:, None] + 1 + places]
    nibbles[places >= digits[:, None]] = 0
    if not (good and good_fraction and good_ids and (nibbles < 16).all() and (can_ids < 0x800).all()):
        return None
    data = (nibbles[:, ::2] << 4) | nibbles[:, 1::2]
    return ClassicColumns((seconds * 1_000_000 + fraction) * 1000, can_ids, digits // 2, data)


def _number(
    values: npt.NDArray[np.uint8],
    first: npt.NDArray[np.int64],
    count: int,
    base: int,
    used: npt.NDArray[np.int64] | None = None,
) -> tuple[npt.NDArray[np.int64], bool]:
    """Numbers of ``count`` digits that begin at ``first``, of which only the last ``used`` digits count, and whether
    all are digits."""
    number, good = np.zeros(len(first), np.int64), True
    for k in range(count):
        digit = values[first + k].astype(np.int64)
        if used is not None:
            digit[k < count - used] = 0
        good = good and bool((digit < base).all())
        number = number * base + digit
    return number, good


def plain_lines(
    times_ns: Sequence[int],
    counts: Sequence[int],
    can_ids: npt.NDArray[np.integer],
    lengths: npt.NDArray[np.integer],
    data: npt.NDArray[np.uint8],
    channel: str,
) -> tuple[str, npt.NDArray[np.int64]]:
    """Lines of classic data frames with standard identifiers, and the end of each of the n lines in the text.

    :param times_ns: below 10^18; the first ``counts[0]`` lines have the first one, and so on.
    :param can_ids: (n,); ``lengths``: (n,) in bytes; ``data``: (n, 8), not used beyond its length.
    """
    # Unused characters are zero and are removed from the text.
    stamps = _stamps(np.array(times_ns, np.int64), channel)
    count, width = len(can_ids), stamps.shape[1]
    digits = np.frombuffer(data.tobytes().hex().upper().encode("ascii"), np.uint8).reshape(count, 2 * _DATA_BYTES)
    short = np.flatnonzero(lengths < _DATA_BYTES)
    if short.size:
        digits = digits.copy()
        digits[short] *= np.arange(2 * _DATA_BYTES) < 2 * lengths[short, None]
    lines = np.empty(count, [("stamp", f"V{width}"), ("can_id", "V4"), ("data", f"V{2 * _DATA_BYTES}"), ("end", "V3")])
    lines["stamp"] = np.repeat(stamps.view(f"V{width}")[:, 0], counts)
    lines["can_id"] = _STANDARD[can_ids]
    lines["data"] = digits.view(f"V{2 * _DATA_BYTES}")[:, 0]
    lines["end"] = np.void(_END)
    sizes = np.repeat(np.count_nonzero(stamps, axis=1), counts) + 4 + 2 * lengths.astype(np.int64) + len(_END)
    return lines.tobytes().translate(None, b"\0").decode("ascii"), np.cumsum(sizes)


def _stamps(times_ns: npt.NDArray[np.int64], channel: str) -> npt.NDArray[np.uint8]:
    """Beginnings of lines; shape (n,) -> (n, characters), with zeros that are not part of them."""
    seconds, micros = np.divmod(times_ns // 1000, 10**_MICROS_DIGITS)
    groups = -(-len(str(seconds.max())) // 3)
    middle = f") {channel} ".encode("ascii")
    point = 1 + 3 * groups
    chars = np.empty((len(times_ns), point + 1 + _MICROS_DIGITS + len(middle)), np.uint8)
    chars[:, 0], chars[:, point] = ord("("), ord(".")
    chars[:, point + 1 + _MICROS_DIGITS :] = list(middle)
    chars[:, point + 1 : point + 4], chars[:, point + 4 : point + 7] = _THREE[micros // 1000], _THREE[micros % 1000]
    for group in range(groups):
        last = point - 3 * group
        chars[:, last - 3 : last] = _THREE[seconds // 1000**group % 1000]
    for place in range(1, 3 * groups):
        chars[seconds < 10**place, point - 1 - place] = 0
    return chars
