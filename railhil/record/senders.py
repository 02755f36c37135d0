"""Senders of the frames of a record: it is compared with each node's own list of frames that it has sent.

Any program on a shared bus can send under any identifier. Frames that decide the verdict (SIM_TRUTH, RUN_EVENT) or move
the train must come from the node that owns the port: a frame that its owner did not send makes the record INVALID. A
node that the supervisor has not started (attached, a board) leaves no list. Its ports are *not witnessed*, except that
none may be answered more often than the plant has polled it.
"""

from __future__ import annotations

import json
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, overload

import numpy as np
import numpy.typing as npt

from railhil.bus.frame import Frame
from railhil.bus.hub.columns import PACKED
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame
from railhil.bus.own_frames import NO_TELEGRAM, OwnFrames
from railhil.bus.packing import SFF_MASK
from railhil.common.arrays import distinct
from railhil.common.digits import count_of
from railhil.dbc import Contract, Port
from railhil.record.log_columns import ClassicColumns

Array: TypeAlias = npt.NDArray[Any]
#: Beginning of the data of a packed frame.
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


class NodeReport(NamedTuple):
    """A node's file: data of the telegrams' frames that it has sent, in order, by CAN identifier; the telegrams that it
    received."""

    frames: dict[int, Sequence[bytes]]
    received: dict[str, Any] | None


def read_sent(path: Path) -> NodeReport | None:
    """The list of a node; None without a readable file."""
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
    return NodeReport(found, received)


def _by_id(ids: Array, telegrams: Array, lengths: Array, data: Array, starts: Array) -> dict[int, Sequence[bytes]]:
    """Frames that are telegrams, by identifier: columns of frames whose data begin at ``starts`` of ``data``."""
    rows = {int(can_id): np.flatnonzero((ids == can_id) & telegrams) for can_id in distinct(ids[telegrams])}
    return {can_id: _frames(data, starts[at], lengths[at]) for can_id, at in rows.items()}


def _frames(data: Array, starts: Array, lengths: Array) -> Sequence[bytes]:
    """Frames of one identifier: they have one length, except under faults (empty frames for "no answer", truncated
    frames, frames of another port)."""
    size = int(lengths[0])
    if size and (lengths == size).all():
        return EqualFrames(data[starts[:, None] + np.arange(size)].tobytes(), size)
    text = data.tobytes()
    ends = (starts + lengths).tolist()
    return [text[start:end] for start, end in zip(starts.tolist(), ends, strict=True)]


#: Nodes that write a list of the frames that they have sent; the supervisor knows its own frames.
WITNESSES = ("plant", "controller")
#: Frames that may be missing in a row where the record differs from the list.
_AHEAD = (0, 1, 8, 64, 512)


def sent_file(folder: Path, node: str) -> Path:
    """File of a node's list of sent frames; it is removed when the record agrees with it."""
    return folder / f"{node}.sent"


class ForeignFrames:
    """Frames of one port that its owner did not send: their number, and the time of the first one (ns)."""

    __slots__ = ("count", "first_ns")

    def __init__(self) -> None:
        self.count = 0
        self.first_ns = 0

    def add(self, time_ns: int) -> None:
        """Count one more."""
        if not self.count or time_ns < self.first_ns:
            self.first_ns = time_ns
        self.count += 1

    def sentence(self, what: str, node: str) -> str:
        """The clause of the verdict; empty: there were no such frames."""
        if not self.count:
            return ""
        frames = count_of(self.count, "frame")
        return f"{frames} on {what} that the {node} did not send, first at {self.first_ns / 1e9:.2f} s"


@dataclass(slots=True)
class _Stream:
    """The frames of one identifier: the list of its owner, and its agreement with the record.

    ``foreign``: frames that the other node has sent under the identifier because of a fault of the run (masquerade).
    """

    sent: Sequence[bytes] = ()
    foreign: Counter[bytes] = field(default_factory=Counter)
    position: int = 0
    #: The recorded frames from the first deviation from the list on.
    rest: list[tuple[int, bytes]] = field(default_factory=list)

    def take(self, time_ns: int, data: bytes) -> None:
        """Take a recorded frame."""
        position = self.position
        if not self.rest and position < len(self.sent) and self.sent[position] == data:
            self.position = position + 1
        else:
            self.rest.append((time_ns, data))

    def take_equal(self, count: int, size: int, joined: bytes) -> bool:
        """Take recorded frames of one length if they are the next ones sent; False: they are not."""
        first, sent = self.position, self.sent
        if self.rest:
            return False
        if isinstance(sent, EqualFrames):
            same = sent.size == size and sent.joined[first * size : (first + count) * size] == joined
        else:
            due = sent[first : first + count]
            same = len(due) == count and {*map(len, due)} == {size} and b"".join(due) == joined
        self.position += count * same
        return same

    def judge(self, foreign_frames: ForeignFrames) -> int:
        """Count the frames that were not sent; returns the number of sent frames that are missing in the record."""
        due, rest, foreign = self.sent[self.position :], [], self.foreign.copy()
        for time_ns, data in self.rest:
            if foreign[data]:
                foreign[data] -= 1
            else:
                rest.append((time_ns, data))
        # A strange frame may look like one that was sent later: the explanation with the fewest strange frames is
        # taken.
        each = [_strange(rest, due, ahead) for ahead in (*_AHEAD, len(due))] if rest else [([], len(due))]
        found, missing = min(each, key=lambda item: len(item[0]))
        for time_ns in found:
            foreign_frames.add(time_ns)
        return missing


def _strange(rest: Sequence[tuple[int, bytes]], due: Sequence[bytes], ahead: int) -> tuple[list[int], int]:
    """Times of recorded frames that are not among the due ones, in their order, and the number of due frames that are
    missing.

    :param ahead: largest number of frames that may be missing in a row.
    """
    places: dict[bytes, list[int]] = {}
    for place, data in enumerate(due):
        places.setdefault(data, []).append(place)
    strange, missing, following = [], 0, 0
    for time_ns, data in rest:
        at = places.get(data, [])
        index = bisect_left(at, following)
        if index == len(at) or at[index] - following > ahead:
            strange.append(time_ns)
        else:
            missing += at[index] - following
            following = at[index] + 1
    return strange, missing + len(due) - following


@dataclass(slots=True)
class Findings:
    """``said``: one clause for each port with foreign or missing frames; ``not_witnessed``: names of the recorded ports
    whose owner has left no list."""

    said: list[str] = field(default_factory=list)
    not_witnessed: list[str] = field(default_factory=list)


class Senders:
    """Compares a record with the nodes' own lists.

    :param folder: folder of the nodes' lists.
    :param complete: no frame can have been lost on its way to the recorder, so all sent frames must be recorded.
    """

    def __init__(self, folder: Path, contract: Contract, *, complete: bool) -> None:
        self._contract = contract
        self._own = OwnFrames(contract)
        self._complete = complete
        self._folder = folder
        self._streams: dict[int, _Stream] = {}
        # Frames of nodes without a list, and foreign frames.
        self._answers: Counter[int] = Counter()
        lists = {node: read_sent(sent_file(folder, node)) for node in WITNESSES}
        #: Telegrams received, by node (:mod:`railhil.bus.reception`).
        self.received = {node: sent.received for node, sent in lists.items() if sent is not None and sent.received}
        self._witnesses = [node for node, sent in lists.items() if sent is not None]
        owned = [(port.source, can_id) for port in contract.ports for can_id in (*port.can_ids, port.fd_id)]
        for node, can_id in [*owned, ("plant", contract.poll_id)]:
            sent = lists.get(node)
            if sent is not None:
                self._streams[can_id] = _Stream(sent.frames.get(can_id, ()), self._foreign(node, can_id, lists))
        if "plant" in self._witnesses:
            self._streams[contract.poll_id] = self._polls = _without_scan(self._streams[contract.poll_id])

    @staticmethod
    def _foreign(owner: str, can_id: int, lists: Mapping[str, NodeReport | None]) -> Counter[bytes]:
        others = [sent.frames for node, sent in lists.items() if node != owner and sent is not None]
        return Counter(data for frames in others for data in frames.get(can_id, ()))

    def passing(self, frames: Iterable[tuple[int, Frame]]) -> Iterator[tuple[int, Frame]]:
        """The frames of a record, compared on their way to another reader."""
        streams, answers, own = self._streams, self._answers, self._own
        for item in frames:
            time_ns, (can_id, data, _) = item
            stream = streams.get(can_id)
            if item[1] not in own:
                pass
            elif stream is None:
                answers[can_id] += 1
            else:
                stream.take(time_ns, data)
            yield item

    def pass_columns(self, part: ClassicColumns) -> None:
        """As :meth:`passing`, but the frames of each identifier are taken together where they are the next ones
        sent."""
        ids = part.can_ids
        for can_id in distinct(ids).tolist():
            rows = np.flatnonzero(ids == can_id)
            stream = self._streams.get(can_id)
            if stream is None:
                self._answers[can_id] += len(rows)
                continue
            lengths, data = part.lengths[rows].tolist(), part.data[rows]
            size = lengths[0]
            equal = lengths.count(size) == len(lengths)
            if equal and stream.take_equal(len(rows), size, data[:, :size].tobytes()):
                continue
            for time_ns, block, size in zip(part.times_ns[rows].tolist(), data, lengths, strict=True):
                stream.take(time_ns, block[:size].tobytes())

    def findings(self) -> Findings:
        """The result of the comparison; lists that agree with the record are removed."""
        found = Findings()
        for port in self._contract.ports:
            if port.source in self._witnesses:
                found.said += self._said(port.name, port.source, (*port.can_ids, port.fd_id))
            elif port.source in WITNESSES and any(self._answers[can_id] for can_id in (*port.can_ids, port.fd_id)):
                found.not_witnessed.append(port.name)
                found.said += self._beyond_polls(port)
        if "plant" in self._witnesses:
            found.said += self._said("the identifier of the polls", "plant", [self._contract.poll_id])
        if not found.said:
            for node in self._witnesses:
                sent_file(self._folder, node).unlink(missing_ok=True)
        return found

    def _said(self, what: str, node: str, can_ids: Sequence[int]) -> list[str]:
        """Clauses on the frames of one port, in its classic form and in that of CAN FD."""
        foreign_frames = ForeignFrames()
        missing = sum(self._streams[can_id].judge(foreign_frames) for can_id in can_ids)
        said = [foreign_frames.sentence(what, node)] if foreign_frames.count else []
        if missing and self._complete:
            said.append(
                f"{count_of(missing, 'frame')} on {what} that the {node} sent {'is' if missing == 1 else 'are'} missing"
            )
        return said

    def _beyond_polls(self, port: Port) -> list[str]:
        """A port without witness is answered at most once for each poll."""
        if "plant" not in self._witnesses or port.mode != "poll":
            return []
        surplus = max(self._answers[port.can_ids[-1]], self._answers[port.fd_id])
        surplus -= self._polls.sent.count(master_frame(port.f_code, port.address).data)
        return [f"{count_of(surplus, 'frame')} on {port.name} more than the plant has polled"] if surplus > 0 else []


def _without_scan(polls: _Stream) -> _Stream:
    """The polls except the device status polls, which are not recorded."""
    return _Stream([data for data in polls.sent if not data or data[0] >> 4 != F_DEVICE_STATUS])
