"""``frames.blf``: the frames of a log in Vector's Binary Logging Format, byte for byte as python-can writes them.

python-can needs a message object per frame and takes four times as long, and its import loads every log format.
Format: ``can/io/blf.py`` of python-can 4.6 (after Toby Lorenz, Vector BLF); a test compares the files.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from struct import Struct
from typing import BinaryIO

import numpy as np

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.record.framelog import log_parts
from railhil.record.log_columns import ClassicColumns

#: signature, its size, application (5: python-can) with version, version of the format, file size, uncompressed size,
#: count of objects, count read, and two SYSTEMTIMEs, which are 0 for a log in simulation time.
_FILE = Struct("<4sLBBBBBBBBQQLL32x72x")
#: signature, header size, header version, object size, object type
_OBJECT = "<4sHHLL"
#: compression method, uncompressed size
_CONTAINER = Struct(f"{_OBJECT}H6xL4x")
#: flags (time in ns), client, version, time; channel
_HEADER = f"{_OBJECT}LHHQH"
#: flags, length, identifier, data
_CLASSIC = Struct(f"{_HEADER}BBL8s")
#: flags, length code, identifier, frame length, bit count, FD flags, bytes of data, data
_FD = Struct(f"{_HEADER}BBLLBBB5x64s")
#: length, flags, error code, position, length, frame length, identifier, more flags, data
_ERROR = Struct(f"{_HEADER}HLBBBxLLH2x8s")
_CLASSIC_FIELDS = np.dtype(
    [
        ("sign", "S4"), ("header", "<u2"), ("version", "<u2"), ("size", "<u4"), ("type", "<u4"), ("flags", "<u4"),
        ("client", "<u2"), ("object_version", "<u2"), ("since_ns", "<u8"), ("channel", "<u2"), ("mark", "u1"),
        ("length", "u1"), ("id", "<u4"), ("data", "u1", 8),
    ]
)  # fmt: skip
_CLASSIC_TYPE, _CONTAINER_TYPE, _ERROR_TYPE, _FD_TYPE = 1, 10, 73, 100
_OBJECT_SIZE, _HEADER_SIZE = Struct(_OBJECT).size, 32
_CLASSIC_HEAD = (b"LOBJ", _HEADER_SIZE, 1, _CLASSIC.size, _CLASSIC_TYPE)
_ZLIB = 2
_TIME_IN_NS = 2
_CHANNEL = 1
_EXTENDED_ID, _REMOTE_FLAG = 0x8000_0000, 0x80
#: Objects are compressed together up to this size; one may continue in the next container.
_CONTAINER_BYTES = 128 * 1024
#: Length codes of CAN FD above 8 bytes.
_FD_CODES = {length: code for code, length in enumerate((*range(9), 12, 16, 20, 24, 32, 48, 64))}


def write_blf(log: Path, out: Path) -> None:
    """Write the frames of a candump log as BLF.

    :raises InputError: the log cannot be read.
    :raises OSError: the file cannot be written.
    """
    with out.open("wb") as stream:
        stream.write(bytes(_FILE.size))
        waiting = bytearray()
        size, count = _FILE.size, 0
        for number, objects in _objects(log):
            waiting += objects
            count += number
            while len(waiting) >= _CONTAINER_BYTES:
                size += _write_container(stream, waiting)
        while waiting:
            size += _write_container(stream, waiting)
        file_size = stream.tell()
        stream.seek(0)
        stream.write(_FILE.pack(b"LOGG", _FILE.size, 5, 0, 0, 0, 2, 6, 8, 1, file_size, size, count, 0))


def _objects(log: Path) -> Iterator[tuple[int, bytes]]:
    """Count and objects of each part of a log."""
    start_s = None
    for part in log_parts(log):
        if isinstance(part, ClassicColumns):
            start_s = _start_s(int(part.times_ns[0])) if start_s is None else start_s
            yield len(part.times_ns), _packed_columns(part, start_s)
            continue
        for time_ns, frame in part:
            start_s = _start_s(time_ns) if start_s is None else start_s
            yield 1, _packed(frame, _since_ns(time_ns, start_s))


def _start_s(time_ns: int) -> float:
    """Time of the first frame as the file has it, in whole ms."""
    return int(time_ns / 1e9 * 1000) / 1000


def start_ns(time_ns: int) -> int:
    """The instant from which the file counts, for a log whose first frame is at ``time_ns``."""
    return round(_start_s(time_ns) * 1e9)


def _packed_columns(columns: ClassicColumns, start_s: float) -> bytes:
    """As :func:`_packed` for each of the frames."""
    objects = np.zeros(len(columns.times_ns), _CLASSIC_FIELDS)
    for name, value in zip(("sign", "header", "version", "size", "type"), _CLASSIC_HEAD, strict=True):
        objects[name] = value
    objects["flags"] = _TIME_IN_NS
    objects["since_ns"] = np.maximum(0, ((columns.times_ns / 1e9 - start_s) * 1e9).astype(np.int64))
    objects["channel"] = _CHANNEL
    objects["length"], objects["id"], objects["data"] = columns.lengths, columns.can_ids, columns.data
    return objects.tobytes()


@lru_cache(maxsize=4)
def _since_ns(time_ns: int, start_s: float) -> int:
    """Time since the first frame, through seconds in floating point; shared by all frames of a tick."""
    return max(0, int((time_ns / 1e9 - start_s) * 1e9))


def _packed(frame: Frame, since_ns: int) -> bytes:
    can_id, data, flags = frame
    if flags & EXTENDED:
        can_id |= _EXTENDED_ID
    length = len(data)
    mark = 0
    if flags & REMOTE:
        mark, data = _REMOTE_FLAG, b""
    if flags & ERROR:
        code = _FD_CODES[length]
        head = (b"LOBJ", _HEADER_SIZE, 1, _ERROR.size, _ERROR_TYPE, _TIME_IN_NS, 0, 0, since_ns, _CHANNEL)
        return _ERROR.pack(*head, 0, 0, 0, 0, code, 0, can_id, 0, data)
    if flags & FD:
        head = (b"LOBJ", _HEADER_SIZE, 1, _FD.size, _FD_TYPE, _TIME_IN_NS, 0, 0, since_ns, _CHANNEL)
        code, fd_flags = _FD_CODES[length], 3 if flags & BRS else 1
        return _FD.pack(*head, mark, code, can_id, 0, 0, fd_flags, len(data), data)
    return _CLASSIC.pack(
        *_CLASSIC_HEAD, _TIME_IN_NS, 0, 0, since_ns, _CHANNEL, mark, length, can_id, data,
    )  # fmt: skip


def _write_container(stream: BinaryIO, waiting: bytearray) -> int:
    """Write the first objects and remove them; returns the bytes that they take uncompressed, with their header."""
    part = bytes(waiting[:_CONTAINER_BYTES])
    del waiting[:_CONTAINER_BYTES]
    packed = zlib.compress(part)
    size = _CONTAINER.size + len(packed)
    stream.write(_CONTAINER.pack(b"LOBJ", _OBJECT_SIZE, 1, size, _CONTAINER_TYPE, _ZLIB, len(part)))
    stream.write(packed)
    # python-can pads by the remainder, and its reader expects that.
    stream.write(bytes(size % 4))
    return _CONTAINER.size + len(part)
