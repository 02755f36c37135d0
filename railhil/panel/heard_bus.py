"""What the panel hears on the bus beside the telegrams: missed polls, load, and the frames by identifier."""

from __future__ import annotations

from collections import Counter, deque

from railhil.bus.frame import Frame
from railhil.bus.load import longest_frame_bits
from railhil.dbc import Contract
from railhil.live.bus_follower import BusObserver
from railhil.record.trace import Trace

#: Raw frames kept of an identifier that somebody watches.
WATCHED_FRAMES = 100
#: Simulation time over which the load of the bus is counted.
_LOAD_NS = 500_000_000


class SeenFrame:
    """The frames of one identifier: how many, the last two instants (simulation time; None: not known), the newest
    data."""

    __slots__ = ("before_ns", "count", "data", "flags", "last_ns")

    def __init__(self) -> None:
        self.count = 0
        self.last_ns: int | None = None
        self.before_ns: int | None = None
        self.data = b""
        self.flags = 0


class HeardBus(BusObserver):
    """Counts and keeps what passes on a bus."""

    def __init__(self, contract: Contract) -> None:
        self._contract = contract
        #: Identifiers of which raw frames are kept: instant in s and data.
        self.watched: dict[int, deque[tuple[float | None, bytes]]] = {}
        self.on_run()

    def on_run(self) -> None:
        self.frames: dict[int, SeenFrame] = {}
        self.frame_count = 0
        self.polls = 0
        self.missed: Counter[str] = Counter()
        self.on_hole()

    def on_hole(self) -> None:
        self._trace = Trace(self._contract)
        self._data: dict[str, bytes] = {}
        self._awaited: set[str] = set()
        for seen in self.frames.values():
            seen.before_ns = seen.last_ns = None
        self._bits = 0
        self._load_from_ns: int | None = None
        #: Share of the bus in use, in simulation time; None: not known yet.
        self.load: float | None = None

    def on_frame(self, frame: Frame, now_ns: int | None) -> None:
        can_id, data, flags = frame
        seen = self.frames.get(can_id)
        if seen is None:
            seen = self.frames[can_id] = SeenFrame()
        seen.count += 1
        seen.before_ns, seen.last_ns = seen.last_ns, now_ns
        seen.data, seen.flags = data, flags
        self.frame_count += 1
        if can_id in self.watched:
            self.watched[can_id].append((None if now_ns is None else now_ns / 1e9, data))
        if now_ns is None:
            return
        if self._load_from_ns is None:
            self._load_from_ns = now_ns
        self._bits += longest_frame_bits(len(data))
        if now_ns - self._load_from_ns >= _LOAD_NS:
            self.load = self._bits * 1e9 / (now_ns - self._load_from_ns) / self._contract.bit_rate
            self._bits, self._load_from_ns = 0, now_ns

    def on_poll(self, port: str) -> None:
        self.polls += 1
        self.missed[port] += port in self._awaited
        self._awaited.add(port)

    def on_telegram(self, port: str, now_ns: int, data: bytes) -> None:
        self._awaited.discard(port)
        self._data[port] = data
        self._trace.add(port, now_ns, data)

    def next_trace(self) -> Trace:
        """The telegrams since the last call, behind the newest one of each port before them."""
        trace, self._trace = self._trace, Trace(self._contract)
        self._trace.idents = trace.idents
        for port, data in self._data.items():
            if times_ns := trace.times_ns(port):
                self._trace.add(port, times_ns[-1], data)
        return trace
