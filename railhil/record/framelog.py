"""The frame log: candump text with simulation time and a neutral channel name.

It is the authoritative record of a run: written during the run, hashed, and read back for the score; the BLF is made
from it. A run has the same log, byte for byte, on every transport.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from io import BytesIO
from itertools import pairwise, repeat
from pathlib import Path
from typing import Any, Final, cast

import numpy as np
import numpy.typing as npt

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame, quick_frame
from railhil.bus.hub.columns import PACKED
from railhil.bus.own_frames import OwnFrames
from railhil.bus.packing import SFF_MASK
from railhil.common.errors import InputError, Words
from railhil.dbc import Contract
from railhil.record.log_columns import ClassicColumns, classic_columns, plain_lines
from railhil.record.log_files import is_candump, opened_log

#: Channel name in the log, the same for every transport.
CHANNEL: Final = "mvb0"
#: Name in a run folder.
LOG_NAME: Final = "frames.log"
#: candump's mark of an error frame in the identifier (python-can writes a bus error).
_ERROR_ID: Final = 0x20000080
_NS_PER_US: Final = 1000
_DATA_BYTES: Final = 8
#: Simulation times are 64 bit.
_TIME_MAX_NS: Final = (1 << 63) - 1
#: Longest line: 64 bytes of CAN FD in hexadecimal, with time stamp, channel and identifier.
_LINE_MAX_BYTES: Final = 1024
#: Part of a log that is read at once.
_PART_BYTES: Final = 1 << 20
_ALLOWED: Final = "a candump log with at least one frame"
#: Standard identifiers as formatted in the log.
_STANDARD: Final = tuple(f"{can_id:03X}#" for can_id in range(0x800))


def plain_line(stamp: str, can_id: int, data: bytes) -> str:
    """:func:`log_line` of a classic data frame with a standard identifier."""
    return f"{stamp}{_STANDARD[can_id]}{data.hex().upper()} R\n"


@lru_cache(maxsize=4)
def log_stamp(time_ns: int) -> str:
    """Beginning of a line; shared by all frames of a tick."""
    return f"({time_ns // 1_000_000_000}.{time_ns // _NS_PER_US % 1_000_000:06d}) {CHANNEL} "


def log_line(time_ns: int, frame: Frame) -> str:
    """One candump line with its newline, identical to that of python-can's writer (a test compares the two).

    It is formatted here because every frame passes through, and building a message for the library's writer costs three
    times as much as the line.
    """
    can_id, data, flags = frame
    stamp = log_stamp(time_ns)
    if not flags and can_id < 0x800:
        return plain_line(stamp, can_id, data)
    if flags & ERROR:
        return f"{stamp}{_ERROR_ID:08X}#{data.hex().upper()}\n"
    identifier = f"{can_id:08X}" if flags & EXTENDED else f"{can_id:03X}"
    if flags & REMOTE:
        return f"{stamp}{identifier}#R R\n"
    fd = f"#{1 if flags & BRS else 0:X}" if flags & FD else ""
    return f"{stamp}{identifier}#{fd}{data.hex().upper()} R\n"


class LateLines:
    """Recorded frames that are not written yet, in their order. Many lines are formatted at once, which takes a tenth
    of the time of single lines; ``write`` takes the text of whole lines.
    """

    def __init__(self, write: Callable[[str], object]) -> None:
        self._write = write
        # Lines, or numbers of the frames below; then time, identifier and data of frames taken one by one, in a form
        # that the garbage collector does not visit.
        self._waiting: list[str | int] = []
        self._single: list[int | bytes] = []
        self._frames: list[npt.NDArray[Any]] = []
        self._times_ns: list[int] = []
        self._counts: list[int] = []

    def write(self, text: str) -> None:
        """Take whole lines."""
        self._put_together()
        self._waiting.append(text)

    def frame(self, time_ns: int, frame: Frame) -> None:
        """Take one frame; ``time_ns`` is simulation time."""
        can_id, data, flags = frame
        if flags or can_id > SFF_MASK or len(data) > _DATA_BYTES:
            self.write(log_line(time_ns, frame))
        else:
            self._single += time_ns, can_id, data

    def _put_together(self) -> None:
        """Make an array of the frames taken one by one."""
        if self._single:
            times_ns, ids = np.array(self._single[::3], np.int64), self._single[1::3]
            data = cast("list[bytes]", self._single[2::3])
            self._single = []
            frames = np.empty(len(ids), PACKED)
            frames["can_id"], frames["length"] = ids, list(map(len, data))
            padded = b"".join([block.ljust(_DATA_BYTES, b"\0") for block in data])
            frames["data"] = np.frombuffer(padded, np.uint8).reshape(-1, _DATA_BYTES)
            bounds = [0, *(np.flatnonzero(times_ns[1:] != times_ns[:-1]) + 1).tolist(), len(ids)]
            self._times_ns += times_ns[bounds[:-1]].tolist()
            self._counts += [end - begin for begin, end in pairwise(bounds)]
            self._frames.append(frames)
            self._waiting.append(len(frames))

    def add(self, frames: npt.NDArray[Any], times_ns: Sequence[int], counts: Sequence[int]) -> None:
        """Take classic data frames with standard identifiers: fields ``can_id``, ``length``, ``data`` (8 bytes).

        :param times_ns: simulation times; the first ``counts[0]`` frames have the first one, and so on.
        """
        self._put_together()
        self._frames.append(frames)
        self._times_ns += times_ns
        self._counts += counts
        self._waiting.append(len(frames))

    def settle(self) -> None:
        """Write all of it.

        :raises OSError: as ``write`` does, which has then been given all lines.
        """
        self._put_together()
        waiting, self._waiting = self._waiting, []
        if not waiting:
            return
        lines, row, ends = "", 0, [0]
        if self._frames:
            frames = np.concatenate(self._frames)
            can_ids, lengths, data = frames["can_id"], frames["length"], frames["data"]
            lines, found = plain_lines(self._times_ns, self._counts, can_ids, lengths, data, CHANNEL)
            ends += found.tolist()
            self._frames, self._times_ns, self._counts = [], [], []
        text: list[str] = []
        for item in waiting:
            if isinstance(item, str):
                text.append(item)
            else:
                text.append(lines[ends[row] : ends[row + item]])
                row += item
        self._write("".join(text))


class FrameLog:
    """Writes ``frames.log`` of one run folder during the run.

    A log that could not be written once takes no more lines: later lines would hide the gap.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / LOG_NAME
        self._stream = self.path.open("w", encoding="ascii", newline="\n", buffering=1 << 16)
        self._failure: OSError | None = None
        #: Lines that wait to be written; a recorder that uses it writes all its lines to it.
        self.late = LateLines(self.write)

    def write(self, text: str) -> None:
        """Write whole lines.

        :raises OSError: they cannot be written, or earlier ones could not.
        """
        if self._failure is not None:
            raise self._failure
        try:
            self._stream.write(text)
        except OSError as error:
            self._failure = error
            raise

    def move(self, folder: Path, before: bytes) -> None:
        """Continue in another folder with a file that begins with the lines ``before``; the old file stays as it is.

        :raises OSError: one of the files cannot be written.
        """
        self.flush()
        self._stream.close()
        self.path = folder / LOG_NAME
        self.path.write_bytes(before)
        self._stream = self.path.open("a", encoding="ascii", newline="\n", buffering=1 << 16)

    def flush(self) -> None:
        """Flush the buffer to the kernel: from then on a killed recorder no longer loses it.

        :raises OSError: it cannot be written.
        """
        self.late.settle()
        try:
            self._stream.flush()
        except OSError as error:
            self._failure = error
            raise

    def abandon(self) -> None:
        """Close the file as it is."""
        self._stream.close()

    def close(self) -> str:
        """Finish the file.

        :returns: its SHA-256.
        :raises OSError: a part of it could not be written; the file then ends with its last complete line.
        """
        try:
            try:
                self.late.settle()
            finally:
                self._stream.close()
            if self._failure is not None:
                raise self._failure
        except OSError:
            # A full disk.
            _cut_to_whole_lines(self.path)
            raise
        return sha256_of(self.path)


def _cut_to_whole_lines(path: Path) -> None:
    """Truncate a log that a full disk has cut off, so that it can still be read up to that point."""
    with path.open("r+b") as stream:
        size = stream.seek(0, os.SEEK_END)
        start = stream.seek(max(0, size - _LINE_MAX_BYTES))
        stream.truncate(start + stream.read().rfind(b"\n") + 1)


def sha256_of(path: Path) -> str:
    """SHA-256 of a file, hexadecimal."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def log_sha256(path: Path) -> str:
    """SHA-256 of a record as in its certificate: the hash of the candump log, also for a file made from it."""
    if is_candump(path):
        with opened_log(path, _ALLOWED) as stream:
            # gzip's file has what is needed; its type does not say so.
            return hashlib.file_digest(cast(BytesIO, stream), "sha256").hexdigest()
    digest = hashlib.sha256()
    for time_ns, frame in read_log(path):
        digest.update(log_line(time_ns, frame).encode("ascii"))
    return digest.hexdigest()


def telegrams_sha256(path: Path, contract: Contract) -> str:
    """SHA-256 of the frames of a record that belong to its wire contract: it stays the same on a shared bus."""
    own, digest = OwnFrames(contract), hashlib.sha256()
    for time_ns, frame in read_log(path):
        if frame in own:
            digest.update(log_line(time_ns, frame).encode("ascii"))
    return digest.hexdigest()


def read_log(path: Path) -> Iterator[tuple[int, Frame]]:
    """Frames ``(time_ns, frame)`` of a candump log, or of a BLF or ASC file, in bus order; each may be packed by gzip.

    :raises InputError: unreadable file, a line that is not a candump line, a file that ends inside a line, an invalid
        BLF or ASC.
    """
    if is_candump(path):
        return _read_candump(path)
    # It loads python-can, which the other functions do not need.
    from railhil.record.message_files import read_messages

    return read_messages(path)


def log_parts(path: Path) -> Iterator[ClassicColumns | Iterator[tuple[int, Frame]]]:
    """The frames of a candump log in parts: as columns, or one by one in parts with different kinds of frames.

    :raises InputError: as :func:`read_log`, also while such a part is read.
    """
    with opened_log(path, _ALLOWED) as stream:
        number = 0
        channels = _Channels(path)
        while part := stream.read(_PART_BYTES):
            part += stream.readline()
            columns = classic_columns(part, CHANNEL)
            if columns is None:
                yield _one_by_one(path, part, number, channels)
            else:
                channels.take(CHANNEL, number + 1)
                yield columns
            number += part.count(b"\n")
        if number == 0:
            raise InputError(path, "", Words("is empty"), _ALLOWED)


def _read_candump(path: Path) -> Iterator[tuple[int, Frame]]:
    for part in log_parts(path):
        if not isinstance(part, ClassicColumns):
            yield from part
            continue
        yield from timed_frames(part)


def timed_frames(part: ClassicColumns) -> Iterator[tuple[int, Frame]]:
    """Frames ``(time_ns, frame)`` of columns, one by one."""
    return zip(part.times_ns.tolist(), _classic_frames(part), strict=True)


def _classic_frames(part: ClassicColumns) -> Iterator[Frame]:
    block = part.data.tobytes()
    starts = range(0, len(block), 8)
    data = [block[start : start + size] for start, size in zip(starts, part.lengths.tolist(), strict=True)]
    return map(quick_frame, zip(part.can_ids.tolist(), data, repeat(0)))


def frames_of(text: bytes) -> list[Frame]:
    """Frames of whole lines of a log; raises ValueError or IndexError if one is invalid."""
    columns = classic_columns(text, CHANNEL)
    if columns is not None:
        return list(_classic_frames(columns))
    return [parsed_line(line)[1] for line in text.decode("ascii").splitlines(keepends=True)]


class _Channels:
    """A log belongs to one bus, which its first line names."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._first = ""

    def take(self, channel: str, number: int) -> None:
        """The channel of a line.

        :raises InputError: it is another one.
        """
        self._first = self._first or channel
        if channel != self._first:
            allowed = f"{self._first}, as in the first line: the log of one bus"
            raise InputError(self._path, f"line {number}: channel", channel, allowed)


def _one_by_one(path: Path, part: bytes, before: int, channels: _Channels) -> Iterator[tuple[int, Frame]]:
    """Frames of lines of a log, after ``before`` others."""
    for number, content in enumerate(BytesIO(part), before + 1):
        try:
            line = content.decode("ascii")
        except UnicodeDecodeError as error:
            raise InputError(path, f"after line {number - 1}", content[:16], "a candump log (text)") from error
        if not line.endswith("\n"):
            raise InputError(path, f"line {number}", line, "whole lines (the file is cut off)")
        try:
            found = parsed_line(line)
        except (ValueError, IndexError):
            allowed = "candump lines, (seconds.micros) channel id#data"
            raise InputError(path, f"line {number}", line.rstrip("\n"), allowed) from None
        channels.take(line.split(maxsplit=2)[1], number)
        yield found


@lru_cache(maxsize=4)
def _time_ns(stamp: str) -> int:
    """Time from the beginning of a line, the inverse of :func:`log_stamp`; raises ValueError or IndexError."""
    seconds, micros = stamp.split(".")
    if seconds[0] != "(" or micros[-1] != ")" or len(micros) != 7 or not (seconds[1:] + micros[:-1]).isdigit():
        raise ValueError(stamp)
    time_ns = int(seconds[1:]) * 1_000_000_000 + int(micros[:-1]) * _NS_PER_US
    if time_ns > _TIME_MAX_NS:
        raise ValueError(stamp)
    return time_ns


def parsed_line(line: str) -> tuple[int, Frame]:
    """Time and frame of a line; raises ValueError or IndexError if it is invalid."""
    fields = line.split()
    time_ns = _time_ns(fields[0])
    identifier, mark, payload = fields[2].partition("#")
    if not mark or len(identifier) not in (3, 8):
        raise ValueError(line)
    if len(identifier) == 3 and payload[:1] not in "#R":
        # Fast path for nearly every line of a record.
        return time_ns, quick_frame((int(identifier, 16), bytes.fromhex(payload), 0))
    can_id = int(identifier, 16)
    flags = 0
    if len(identifier) == 8:
        flags = ERROR if can_id & 0x20000000 else EXTENDED
        can_id &= 0x1FFFFFFF
    if payload[:1] == "#":
        flags |= FD | (BRS if int(payload[1], 16) & 1 else 0)
        payload = payload[2:]
    elif payload[:1] == "R":
        return time_ns, Frame(can_id, b"", flags | REMOTE)
    return time_ns, Frame(can_id, bytes.fromhex(payload), flags)
