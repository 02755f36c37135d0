"""Takes frames as they are packed on pipes: most of them are recorded as they come, without being taken apart.

What a frame means is decided where it is decided for all transports (:class:`railhil.supervisor.session.Session`); here
are only those that every tick brings. The frames before one that needs more are taken, and the others are left.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Final, NamedTuple

import numpy as np

from railhil.bus.frame import quick_frame
from railhil.bus.hub.wire import CLASSIC_SIZE, SFF_MASK
from railhil.bus.mvb import master_tail
from railhil.bus.responder import Responder
from railhil.dbc import Contract
from railhil.supervisor.framelog import LateLines
from railhil.supervisor.truth_clock import TruthClock

#: ``struct can_frame``, see :mod:`railhil.bus.hub.wire`.
PACKED: Final = np.dtype(
    {"names": ["can_id", "length", "data"], "formats": ["=u4", "u1", "(8,)u1"], "offsets": [0, 4, 8], "itemsize": 16}
)
#: Kinds of frames: only recorded, of the clock port, a poll, of the truth; any other.
_PLAIN: Final = 0
_CLOCK: Final = 1
_POLL: Final = 2
_TRUTH: Final = 3
_OTHER: Final = 4
_DATA_AT: Final = 8
_POLL_BYTES: Final = 3
_DATA_BYTES: Final = 8
#: Packets with so many different sequences of identifiers are known at the same time.
_SHAPES: Final = 512


class _Shape(NamedTuple):
    """Packets with the same identifiers and lengths in the same order.

    ``end``: place of the first frame of another kind; ``marks``: those that are not only recorded, place, kind and
    identifier.
    """

    end: int
    marks: list[tuple[int, int, int]]


class Packets:
    """Takes the frames that every tick brings.

    :param seen_ids: identifiers of all frames that the recorder looks at; the others are only recorded.
    :param pace: process data of the poll that keeps the time going while the clock port is missing; empty: none does.
    :param pace_ticks: its period.
    :param truth: keeps the time instead of the bus clock.
    """

    def __init__(
        self,
        responder: Responder,
        contract: Contract,
        seen_ids: Collection[int],
        pace: bytes,
        pace_ticks: int,
        truth: TruthClock | None,
        late: LateLines,
    ) -> None:
        self._responder = responder
        self._clock = responder.clock
        self._truth = truth
        self._late = late
        self._pace = pace
        self._pace_ticks = pace_ticks
        # Those that the supervisor answers, and those of nobody, need more.
        self._polls = {
            master_tail(port.f_code, port.address)
            for port in contract.ports
            if port.mode == "poll" and port.source != "supervisor"
        }
        # By identifier; the last one stands for all that are no standard ones.
        self._kinds = np.full(SFF_MASK + 2, _PLAIN, np.uint8)
        self._kinds[[*seen_ids, SFF_MASK + 1]] = _OTHER
        self._kinds[contract.poll_id] = _POLL
        self._kinds[contract.clock_port.address] = _CLOCK
        if truth is not None:
            self._kinds[list(truth.truth_ids)] = _TRUTH
        self._shapes: dict[bytes, _Shape] = {}
        #: Ticks that began in the packet taken last.
        self.ticks: list[int] = []

    def take(self, packet: bytes) -> int:
        """Record frames of a packet.

        :returns: how many of its bytes are taken.
        """
        self.ticks = ticks = []
        heads = np.frombuffer(packet, np.uint64)[::2].tobytes()
        shape = self._shapes.get(heads)
        if shape is None:
            shape = self._shape(packet, heads)
        clock, truth = self._clock, self._truth
        time_ns = clock.now_ns if truth is None else truth.now_ns
        times_ns, counts = [], []
        begin, end = 0, shape.end
        for row, kind, can_id in shape.marks:
            at = row * CLASSIC_SIZE + _DATA_AT
            if kind == _POLL:
                tail = packet[at : at + _POLL_BYTES]
                if tail not in self._polls:
                    end = row
                    break
                if tail != self._pace:
                    continue
                tick = clock.tick
                clock.polled(self._pace_ticks)
                new = clock.tick > tick
            else:
                frame = quick_frame((can_id, packet[at : at + _DATA_BYTES], 0))
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
        if not end:
            return 0
        times_ns.append(time_ns)
        counts.append(end - begin)
        self._late.add(np.frombuffer(packet, PACKED)[:end], times_ns, counts)
        return end * CLASSIC_SIZE

    def _shape(self, packet: bytes, heads: bytes) -> _Shape:
        frames = np.frombuffer(packet, PACKED)
        can_ids, lengths = frames["can_id"], frames["length"]
        # Those with flags have larger identifiers.
        kinds = self._kinds[np.minimum(can_ids, SFF_MASK + 1)]
        kinds[lengths > _DATA_BYTES] = _OTHER
        kinds[(kinds == _POLL) & (lengths != _POLL_BYTES)] = _OTHER
        kinds[((kinds == _CLOCK) | (kinds == _TRUTH)) & (lengths != _DATA_BYTES)] = _OTHER
        others = np.flatnonzero(kinds == _OTHER)
        end = int(others[0]) if others.size else len(kinds)
        marks = [(row, int(kinds[row]), int(can_ids[row])) for row in np.flatnonzero(kinds[:end]).tolist()]
        if len(self._shapes) == _SHAPES:
            self._shapes.clear()
        shape = self._shapes[heads] = _Shape(end, marks)
        return shape
