"""What a node has put on the bus, read from the file that it has written (:mod:`railhil.bus.sent`)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, overload

import numpy as np
import numpy.typing as npt

from railhil.bus.hub.columns import PACKED
from railhil.bus.hub.wire import SFF_MASK
from railhil.bus.own_frames import NO_TELEGRAM
from railhil.common.arrays import distinct

Array: TypeAlias = npt.NDArray[Any]
#: Where the data of a packed frame begin.
_DATA_AT = 8


class EqualFrames(Sequence[bytes]):
    """Data of frames of one length, joined; a sequence of the data of each.

    :param size: length of each in bytes, not 0.
    """

    __slots__ = ("joined", "size")

    def __init__(self, joined: bytes, size: int) -> None:
        self.joined = joined
        self.size = size

    def __len__(self) -> int:
        return len(self.joined) // self.size

    @overload
    def __getitem__(self, place: int) -> bytes: ...

    @overload
    def __getitem__(self, place: slice) -> list[bytes]: ...

    def __getitem__(self, place: int | slice) -> bytes | list[bytes]:
        if isinstance(place, slice):
            return [self[at] for at in range(*place.indices(len(self)))]
        start = (place if place >= 0 else place + len(self)) * self.size
        if not 0 <= start < len(self.joined):
            raise IndexError(place)
        return self.joined[start : start + self.size]


class Told(NamedTuple):
    """A node's file: data of the telegrams' frames that it has sent, in order, by CAN identifier; what it received."""

    frames: dict[int, Sequence[bytes]]
    received: dict[str, Any] | None


def read_sent(path: Path) -> Told | None:
    """What a node has written; None without a readable file."""
    try:
        line, _, columns = path.read_bytes().partition(b"\n")
        head = json.loads(line)
        packed_count, count, received = head["packed"], head["frames"], head["received"]
        packed = np.frombuffer(columns, PACKED, packed_count)
        start = packed.nbytes
        ids = np.frombuffer(columns, np.uint32, count, start)
        start += ids.nbytes
        lengths, flags = np.frombuffer(columns, np.uint8, 2 * count, start).reshape(2, count)
        start += 2 * count
    except (OSError, ValueError, KeyError, TypeError):
        return None
    data = np.frombuffer(columns, np.uint8)[start:]
    ends = np.cumsum(lengths, dtype=np.int64)
    # For numpy -1 is "all".
    if min(packed_count, count) < 0 or len(data) != (ends[-1] if count else 0):
        return None
    starts = np.arange(packed_count) * PACKED.itemsize + _DATA_AT
    found = _by_id(packed["can_id"], packed["can_id"] <= SFF_MASK, packed["length"], packed.view(np.uint8), starts)
    found |= _by_id(ids, (flags & NO_TELEGRAM) == 0, lengths, data, ends - lengths)
    return Told(found, received)


def _by_id(ids: Array, telegrams: Array, lengths: Array, data: Array, starts: Array) -> dict[int, Sequence[bytes]]:
    """Frames that are telegrams, by identifier: columns of frames whose data begin at ``starts`` of ``data``."""
    rows = {int(can_id): np.flatnonzero((ids == can_id) & telegrams) for can_id in distinct(ids[telegrams])}
    return {can_id: _frames(data, starts[at], lengths[at]) for can_id, at in rows.items()}


def _frames(data: Array, starts: Array, lengths: Array) -> Sequence[bytes]:
    """Frames of one identifier: they have one length, except under faults (empty ones for "no answer", truncated ones,
    those of another port)."""
    size = int(lengths[0])
    if size and (lengths == size).all():
        return EqualFrames(data[starts[:, None] + np.arange(size)].tobytes(), size)
    text = data.tobytes()
    ends = (starts + lengths).tolist()
    return [text[start:end] for start, end in zip(starts.tolist(), ends, strict=True)]
