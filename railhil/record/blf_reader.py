"""Reads a BLF made of a candump log, with python-can."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

from can.io import BLFReader
from can.io.blf import BLFParseError

from railhil.bus.frame import Frame, from_message
from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.user_files import refuse_unreadable

_NS_PER_US = 1000
#: Exceptions of python-can's reader for data that are not BLF, or end too early.
_NO_BLF = (BLFParseError, struct.error, zlib.error, ValueError, OverflowError, EOFError)


def read_blf(path: Path) -> Iterator[tuple[int, Frame]]:
    """Frames ``(time_ns, frame)`` in bus order.

    Time stamps are whole microseconds, as in the candump log; BLF stores them as floating-point seconds.

    :raises InputError: see :func:`railhil.record.framelog.read_log`.
    """
    allowed = "a BLF file with at least one frame"
    count = 0
    first: object = None
    with refuse_unreadable(path, allowed):
        try:
            with BLFReader(path) as reader:
                for message in reader:
                    count += 1
                    first = message.channel if first is None else first
                    if message.channel != first:
                        one = f"{first}, as in the first frame: the log of one bus"
                        raise InputError(path, f"frame {count}: channel", message.channel, one)
                    yield round(message.timestamp * 1e6) * _NS_PER_US, from_message(message)
                announced = reader.object_count
        except _NO_BLF as error:
            where = f"after frame {count}" if count else ""
            raise InputError(
                path, where, Words("cannot be read"), allowed, str(error) or type(error).__name__
            ) from error
    if count == 0 or count < announced:
        raise InputError(path, "", Words(f"has {count} of {count_of(announced, 'frame')}"), f"{allowed}, whole")
