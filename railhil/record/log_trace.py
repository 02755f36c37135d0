"""The trace of a frame log.

Most parts of most logs contain only whole telegrams: complete, in order and without a fault, each poll answered before
the next one of its port. These parts are read as columns. Every other part is read frame by frame
(:class:`railhil.record.trace.TraceReader`), which defines the result; the tests compare both.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.bus.mvb import CHECK_TABLES, master_tail
from railhil.bus.store import ASSEMBLY_NS
from railhil.common.arrays import distinct
from railhil.dbc import Contract, Port
from railhil.record.framelog import log_parts, read_log, timed_frames
from railhil.record.log_columns import ClassicColumns
from railhil.record.log_files import is_candump
from railhil.record.senders import Senders
from railhil.record.trace import Noted, Telegrams, Trace, TraceReader

Ints: TypeAlias = npt.NDArray[np.int64]
_IDS: Final = 0x800
#: Kinds of identifiers: not a classic one of the contract, the polls', a block, the end of a telegram.
_STRANGE, _POLL, _BLOCK, _END = range(4)
_POLL_BYTES, _FRAME_BYTES = 3, 8
_TABLES = tuple(np.frombuffer(table, np.uint8) for table in CHECK_TABLES)


def trace_of_log(log: Path, contract: Contract, senders: Senders | None = None) -> Trace:
    """Trace of a log, of which candump logs are read as columns.

    :param contract: the one used for recording.
    :param senders: compares the frames with the nodes' own lists while they are read.
    :raises InputError: as :func:`railhil.record.framelog.read_log`.
    """
    reader = TraceReader(contract)
    if not is_candump(log):
        frames = read_log(log)
        reader.take(frames if senders is None else senders.passing(frames))
        return reader.trace
    whole = _Whole(reader.trace.contract)
    # The beginning of a telegram whose end is in the next part.
    begun: ClassicColumns | None = None
    for part in log_parts(log):
        if not isinstance(part, ClassicColumns):
            if begun is not None:
                reader.take(timed_frames(begun))
                begun = None
            reader.take(part if senders is None else senders.passing(part))
            continue
        if senders is not None:
            senders.pass_columns(part)
        if begun is not None:
            part = begun.followed_by(part)
        size = whole.end(part)
        begun = part.rows(size, len(part.times_ns)) if size < len(part.times_ns) else None
        ended = part.rows(0, size)
        if size and not (reader.is_between_telegrams and whole.take(ended, reader.trace)):
            reader.take(timed_frames(ended))
    if begun is not None:
        reader.take(timed_frames(begun))
    return reader.trace


class _Ended(NamedTuple):
    """Telegrams of a port, and for each the row of its last frame."""

    rows: Ints
    data: bytes


class _Whole:
    """Recognises parts with nothing but whole telegrams."""

    def __init__(self, contract: Contract) -> None:
        self._ports = contract.ports
        self._polls = [
            (master_tail(port.f_code, port.address), port.name) for port in self._ports if port.mode == "poll"
        ]
        self._kinds = np.full(_IDS, _STRANGE, np.uint8)
        self._owners = np.full(_IDS, -1, np.int16)
        for number, port in enumerate(self._ports):
            ids = list(port.can_ids)
            self._owners[ids] = number
            self._kinds[ids] = _BLOCK
            self._kinds[ids[-1]] = _END
        self._kinds[contract.poll_id] = _POLL

    def end(self, part: ClassicColumns) -> int:
        """Number of rows up to the last frame that is not the block of an unfinished telegram."""
        others = np.flatnonzero(self._kinds[part.can_ids] != _BLOCK)
        return int(others[-1]) + 1 if others.size else 0

    def take(self, part: ClassicColumns, trace: Trace) -> bool:
        """Take a part into a trace; False, and nothing is taken, if not everything is whole."""
        kinds = self._kinds[part.can_ids]
        wanted = np.where(kinds == _POLL, _POLL_BYTES, _FRAME_BYTES)
        if not kinds.all() or (part.lengths != wanted).any():
            return False
        words = part.data.view(">u2")
        octets = _octets(words)
        owners = self._owners[part.can_ids]
        found: dict[str, _Ended] = {}
        for number in distinct(owners[owners >= 0]).tolist():
            port, rows = self._ports[number], np.flatnonzero(owners == number)
            ended = _single(port, part, rows) if port.single_frame else _blocks(port, part, octets, rows)
            if ended is None:
                return False
            found[port.name] = ended
        polls = np.flatnonzero(kinds == _POLL)
        asked = {name: polls[(part.data[polls, :_POLL_BYTES] == list(tail)).all(1)] for tail, name in self._polls}
        if sum(map(len, asked.values())) != len(polls):
            return False
        left = []
        for name, rows in asked.items():
            ended = found.get(name)
            # Numbers of telegrams before the first poll, between two polls, and after the last one.
            between = np.bincount(np.searchsorted(rows, [] if ended is None else ended.rows), minlength=len(rows) + 1)
            if not between[1:-1].all() or (len(rows) and not between[0] and trace.is_awaited(name)):
                return False
            if len(rows) and not between[-1]:
                left.append((int(rows[-1]), name))
        is_end = np.zeros(len(kinds), np.int64)
        for ended in found.values():
            is_end[ended.rows] = 1
        order = np.cumsum(is_end) - 1
        trace.take_whole(
            [
                Telegrams(name, part.times_ns[ended.rows], order[ended.rows], ended.data)
                for name, ended in sorted(found.items(), key=lambda item: int(item[1].rows[0]))
            ],
            len(polls),
            [Noted(int(part.times_ns[row]), name, "no_answer") for row, name in sorted(left)],
        )
        trace.end_ns = int(part.times_ns[-1])
        return True


def _octets(words: npt.NDArray[np.uint16]) -> npt.NDArray[np.uint8]:
    """Check octet of each block; shape (n, words) -> (n,)."""
    count = words.shape[1]
    octets = np.zeros(len(words), np.uint8)
    for place, table in enumerate(_TABLES[-count:]):
        octets ^= table[words[:, place]]
    return octets


def are_whole(port: Port, frames: npt.NDArray[np.uint8]) -> bool:
    """Whether frames, shape (n, 8), are telegrams of a port with one frame each, without a fault."""
    words = frames.view(">u2")[:, : port.data_bytes // 2]
    return port.single_frame and not (frames[:, 4] != _octets(words)).any() and _is_of(port, frames)


def _single(port: Port, part: ClassicColumns, rows: Ints) -> _Ended | None:
    """Telegrams of one frame each; None if one is not as it should be."""
    frames = part.data[rows]
    return _Ended(rows, frames[:, : port.data_bytes].tobytes()) if are_whole(port, frames) else None


def _blocks(port: Port, part: ClassicColumns, octets: npt.NDArray[np.uint8], rows: Ints) -> _Ended | None:
    """Telegrams of several blocks and a trailer; None if one is not as it should be."""
    count = port.blocks
    if len(rows) % (count + 1):
        return None
    rows = rows.reshape(len(rows) // (count + 1), count + 1)
    times_ns, frames = part.times_ns[rows], part.data[rows]
    trailers = frames[:, count]
    if (
        (part.can_ids[rows] != port.can_ids).any()
        or (np.ptp(times_ns, axis=1) > ASSEMBLY_NS).any()
        or (trailers[:, 4] & 0xF != count).any()
        or (trailers[:, :count] != octets[rows[:, :count]]).any()
        or not _is_of(port, trailers)
    ):
        return None
    return _Ended(rows[:, count], frames[:, :count].tobytes())


def _is_of(port: Port, ends: npt.NDArray[np.uint8]) -> bool:
    """Whether the last frames of telegrams have the master word of their port."""
    return bool((ends[:, 5:] == list(master_tail(port.f_code, port.address))).all())
