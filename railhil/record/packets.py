"""Takes packed frames of pipes: most of them are recorded as they come, without being decoded.

The meaning of a frame is decided in one place for all transports (:class:`railhil.record.session.Session`); this module
handles only the frames of every tick. It takes the frames before one that needs more, and leaves the others.

A packet that ends with the poll of SUP_CMD may be answered before it is read, if nothing in it can change the answer.
Plant and controller then continue meanwhile, and many packets are read one after the other.
"""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterator, Sequence
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.bus.frame import Frame, quick_frame
from railhil.bus.hub.columns import PACKED
from railhil.bus.ident import CtlIdent
from railhil.bus.mvb import master_tail
from railhil.bus.own_frames import supervisor_polls
from railhil.bus.packing import CLASSIC_SIZE, SFF_MASK, pack_frame, pack_frames, unpack_frames
from railhil.bus.responder import Responder
from railhil.bus.telegrams import RunEvent
from railhil.dbc import Contract, Port
from railhil.record.framelog import LateLines
from railhil.record.log_trace import are_whole
from railhil.record.truth_clock import TimeBase

Ints: TypeAlias = npt.NDArray[np.int64]
#: An array of :data:`PACKED`.
Frames: TypeAlias = npt.NDArray[Any]
#: Kinds of frames: only recorded, of the clock port, a poll, of the truth; any other.
_PLAIN: Final = 0
_CLOCK: Final = 1
_POLL: Final = 2
_TRUTH: Final = 3
_OTHER: Final = 4
_POLL_BYTES: Final = 3
_DATA_BYTES: Final = 8
_LIFE_MASK: Final = 0xF


class Taken(NamedTuple):
    """Frames that have been recorded: their number, and the ticks that began with them; then the frame that needs more,
    if there is one."""

    frames: int
    ticks: list[int]
    others: list[Frame]


class FrameKinds:
    """Kind of each frame, by its identifier and its data.

    :param seen_ids: identifiers of all frames that the recorder reads; other frames are only recorded.
    :param truth_ids: identifiers of the truth, if it keeps the time of the record.
    """

    def __init__(self, contract: Contract, seen_ids: Collection[int], truth_ids: Collection[int]) -> None:
        # Polls that the supervisor answers, and polls of no port, need more.
        polled = (port for port in contract.ports if port.mode == "poll" and port.source != "supervisor")
        self._polls = [int.from_bytes(master_tail(port.f_code, port.address)) for port in polled]
        # Kind by identifier; the last entry is for all identifiers that are not standard ones.
        self._kinds = np.full(SFF_MASK + 2, _PLAIN, np.uint8)
        self._kinds[[*seen_ids, SFF_MASK + 1]] = _OTHER
        self._kinds[contract.poll_id] = _POLL
        self._kinds[contract.clock_port.address] = _CLOCK
        # Packed frames are classic. One with the identifier of an FD frame is foreign and is read by itself.
        self._kinds[list({*truth_ids} - {port.fd_id for port in contract.ports})] = _TRUTH

    def of(self, frames: Frames, numbers: Ints) -> npt.NDArray[np.uint8]:
        """Kind of each frame.

        :param numbers: the first three octets of its data.
        """
        lengths = frames["length"]
        # Frames with flags have larger identifiers.
        kinds: npt.NDArray[np.uint8] = self._kinds[np.minimum(frames["can_id"], SFF_MASK + 1)]
        kinds[(kinds == _POLL) & ~((lengths == _POLL_BYTES) & np.isin(numbers, self._polls))] = _OTHER
        kinds[((kinds == _CLOCK) | (kinds == _TRUTH)) & (lengths != _DATA_BYTES)] = _OTHER
        return kinds


class Backlog:
    """Packets that are answered and not recorded yet, each with its answers.

    :param waits: a packet that ends with the poll of SUP_CMD may be answered before it is looked at.
    """

    def __init__(self, contract: Contract, *, waits: bool) -> None:
        self._waits = waits
        #: The poll of SUP_CMD.
        self.command_poll, ident_poll, status_poll = supervisor_polls(contract)
        self._command_poll = pack_frame(self.command_poll)
        # Other polls that the supervisor answers, and the ends of telegrams that change what it answers. PLT_IDENT is
        # repeated during the run; it is compared when CTL_IDENT comes.
        ends = (contract.port(kind.PORT).can_ids[-1] for kind in (RunEvent, CtlIdent))
        self._urgent = [
            pack_frame(ident_poll),
            pack_frame(status_poll),
            *(can_id.to_bytes(4, sys.byteorder) for can_id in ends),
        ]
        self._packets: list[bytes] = []
        # Places of polls and answers among the frames.
        self._answered: list[int] = []
        self._frames = 0

    def may_wait(self, packet: bytes) -> bool:
        """Whether a packet ends with the poll of SUP_CMD, and nothing before it needs or changes an answer."""
        if not self._waits or packet.find(self._command_poll) != len(packet) - CLASSIC_SIZE:
            return False
        # The search may also find data that look like it; the packet then only waits less.
        return not any(map(packet.__contains__, self._urgent))

    def hold(self, packet: bytes, answers: Sequence[Frame]) -> None:
        """Keep a packet that has been answered, to be recorded later with its answers."""
        self._packets += (packet, *pack_frames(answers))
        poll = self._frames + len(packet) // CLASSIC_SIZE - 1
        self._frames = poll + 1 + len(answers)
        self._answered += range(poll, self._frames)

    def release(self) -> tuple[bytes, list[int]]:
        """The packets that are kept, as one, and the places of polls and answers in it; they are kept no longer."""
        packet, answered = b"".join(self._packets), self._answered
        self._packets, self._answered, self._frames = [], [], 0
        return packet, answered


class Packets:
    """Takes the frames of every tick.

    :param backlog: packets that wait.
    """

    def __init__(
        self,
        responder: Responder,
        clock_port: Port,
        kinds: FrameKinds,
        base: TimeBase,
        late: LateLines,
        backlog: Backlog,
    ) -> None:
        self.backlog = backlog
        self._responder = responder
        self._clock = responder.clock
        self._clock_port = clock_port
        self._kinds = kinds
        self._truth = base.truth
        self._late = late
        self._pace = 0 if base.pace is None else int.from_bytes(base.pace.data)
        self._pace_ticks = base.pace_ticks

    def take(self, packet: bytes, known: Sequence[int] = ()) -> Iterator[Taken]:
        """Record the frames of a packet, up to each one that needs more. The caller records that frame before it asks
        for the next.

        :param known: places of frames that have been read already, and are only recorded.
        """
        frames = np.frombuffer(packet, PACKED)
        data = frames["data"]
        numbers = data[:, 0].astype(np.int64) << 16 | data[:, 1].astype(np.int64) << 8 | data[:, 2]
        kinds = self._kinds.of(frames, numbers)
        kinds[list(known)] = _PLAIN
        kinds[frames["length"] > _DATA_BYTES] = _OTHER
        begin = 0
        for end in (*np.flatnonzero(kinds == _OTHER).tolist(), len(kinds)):
            ticks: list[int] = []
            if end > begin:
                part = frames[begin:end]
                marks = np.flatnonzero(kinds[begin:end])
                clocks = marks[kinds[begin + marks] == _CLOCK]
                paces = marks[(kinds[begin + marks] == _POLL) & (numbers[begin + marks] == self._pace)]
                if self._truth is not None or not self._count(part, clocks, paces, ticks):
                    self._look(part, marks.tolist(), kinds[begin + marks].tolist(), ticks)
            yield Taken(end - begin, ticks, unpack_frames(packet[end * CLASSIC_SIZE : (end + 1) * CLASSIC_SIZE]))
            begin = end + 1

    def _count(self, part: Frames, clocks: Ints, paces: Ints, ticks: list[int]) -> bool:
        """Record frames if each frame of the clock port opens the next tick and no poll moves the time; otherwise do
        nothing and return False."""
        clock = self._clock
        if not clock.is_regular:
            return False
        opened = clock.tick + clock.ticks_per_frame * np.arange(len(clocks) + 1)
        data = part["data"][clocks]
        polled = opened[np.searchsorted(clocks, paces)]
        polls = np.concatenate(([clock.polled_tick], polled))
        if (
            not are_whole(self._clock_port, data)
            or (data[:, 3] & _LIFE_MASK != (clock.life + np.arange(1, len(clocks) + 1)) & _LIFE_MASK).any()
            or (polled % self._pace_ticks).any()
            or (polls[1:] <= polls[:-1]).any()
        ):
            return False
        self._late.add(
            part, (opened * clock.base_tick_ns).tolist(), np.diff(clocks, prepend=0, append=len(part)).tolist()
        )
        ticks += opened[1:].tolist()
        clock.count(len(clocks), int(polled[-1]) if len(polled) else -1)
        return True

    def _look(self, part: Frames, marks: list[int], kinds: list[int], ticks: list[int]) -> None:
        """Record frames, each of which may move the time."""
        clock, truth = self._clock, self._truth
        time_ns = clock.now_ns if truth is None else truth.now_ns
        times_ns, counts = [], []
        begin = 0
        for row, kind in zip(marks, kinds, strict=True):
            item = part[row]
            if kind == _POLL:
                if int.from_bytes(item["data"][:_POLL_BYTES].tobytes()) != self._pace:
                    continue
                tick = clock.tick
                clock.polled(self._pace_ticks)
                new = clock.tick > tick
            else:
                frame = quick_frame((int(item["can_id"]), item["data"].tobytes(), 0))
                if kind == _TRUTH:
                    new = truth is not None and truth.truth(frame)
                else:
                    new = self._responder.opens_tick(frame)
                    if truth is not None:
                        new = truth.clock(frame)
            if new:
                times_ns.append(time_ns)
                counts.append(row - begin)
                begin = row
                time_ns = clock.now_ns if truth is None else truth.now_ns
                ticks.append(clock.tick if truth is None else truth.tick)
        times_ns.append(time_ns)
        counts.append(len(part) - begin)
        self._late.add(part, times_ns, counts)
