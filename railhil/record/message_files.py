"""Reads logs in Vector's formats, BLF and ASC, with python-can."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Generator, Iterator
from io import TextIOWrapper
from pathlib import Path
from typing import BinaryIO

from can import Message
from can.io import ASCReader, BLFReader
from can.io.blf import BLFParseError

from railhil.bus.frame import Frame, from_message
from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.user_files import refuse_unreadable
from railhil.record.log_files import BLF_SUFFIX, log_suffix, opened_log

_NS_PER_US = 1000
#: Simulation times are 64 bit.
_TIME_MAX_US = (1 << 63) // _NS_PER_US - 1
#: Exceptions of python-can's readers for data of another format, or that end too early.
_NOT_READ = (BLFParseError, struct.error, zlib.error, ValueError, OverflowError, EOFError)
_CLASSIC_BYTES = 8


def read_messages(path: Path) -> Iterator[tuple[int, Frame]]:
    """Frames ``(time_ns, frame)`` of a BLF or ASC file in bus order.

    Time stamps are whole microseconds, as in the candump log; python-can has floating-point seconds. Those of an ASC
    count from the beginning of its measurement.

    :raises InputError: see :func:`railhil.record.framelog.read_log`.
    """
    is_blf = log_suffix(path) == BLF_SUFFIX
    allowed = f"{'a BLF' if is_blf else 'an ASC'} file with at least one frame"
    count = announced = 0
    first: object = None
    with refuse_unreadable(path, allowed), opened_log(path, allowed) as stream:
        try:
            with BLFReader(stream) if is_blf else _AscReader(stream) as reader:
                for message in reader:
                    count += 1
                    first = message.channel if first is None else first
                    if message.channel != first:
                        one = f"{first}, as in the first frame: the log of one bus"
                        raise InputError(path, f"frame {count}: channel", message.channel, one)
                    time_us = round(message.timestamp * 1e6)
                    if not 0 <= time_us <= _TIME_MAX_US:
                        raise ValueError(f"a time of {message.timestamp} s")
                    yield time_us * _NS_PER_US, from_message(message)
                announced = reader.object_count if isinstance(reader, BLFReader) else 0
        except _NOT_READ as error:
            where = f"after frame {count}" if count else ""
            raise InputError(
                path, where, Words("cannot be read"), allowed, str(error) or type(error).__name__
            ) from error
    if count == 0 or count < announced:
        found = f"{count} of {count_of(announced, 'frame')}" if announced else "no frame"
        raise InputError(path, "", Words(f"has {found}"), f"{allowed}, whole")


class _WholeLines(TextIOWrapper):
    """Text of which the last line ends, too: python-can reads half of a frame without an error."""

    def __next__(self) -> str:  # type: ignore[override]
        line = super().__next__()
        if not line.endswith("\n"):
            raise ValueError("the last line is not whole")
        return line


class _AscReader(ASCReader):
    """python-can's reader for the frames that it takes as they are in the file.

    Lines that it does not know (comments, states of the bus, statistics) are left out.
    """

    def __init__(self, stream: BinaryIO) -> None:
        super().__init__(_WholeLines(stream, encoding="utf-8", errors="replace"))

    def __iter__(self) -> Generator[Message, None, None]:
        for message in super().__iter__():
            if self.timestamps_format == "relative":
                raise ValueError("its times are relative to the line before: save it with absolute ones")
            most = message.dlc if message.is_fd else min(message.dlc, _CLASSIC_BYTES)
            if len(message.data) < most and not (message.is_remote_frame or message.is_error_frame):
                raise ValueError(f"a frame has {len(message.data)} of {count_of(most, 'byte')}")
            yield message
