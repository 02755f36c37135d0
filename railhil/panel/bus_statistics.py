"""Statistics of the bus: frames by identifier, missed polls, load. The page's list of frames is like CANoe's trace in
fixed mode: count, period, age, and the decoded telegram."""

from __future__ import annotations

from collections import Counter, deque
from typing import Any

from railhil.bus.frame import Frame
from railhil.bus.injector.follower import raw_of
from railhil.bus.schedule import longest_frame_bits
from railhil.dbc import Contract, Signal
from railhil.dbc.contract import ANTIVALENT_VALUES, CHECK_VALUES
from railhil.live.bus_follower import BusObserver, Listener
from railhil.record.trace import Trace

#: Number of raw frames kept of a watched identifier.
WATCHED_FRAMES = 100
#: Simulation time over which the load of the bus is counted.
_LOAD_NS = 500_000_000


class FrameStatistics:
    """The frames of one identifier: their number, the last two instants (simulation time; None: unknown), the newest
    data."""

    __slots__ = ("before_ns", "count", "data", "flags", "last_ns")

    def __init__(self) -> None:
        self.count = 0
        self.last_ns: int | None = None
        self.before_ns: int | None = None
        self.data = b""
        self.flags = 0


class BusStatistics(BusObserver):
    """Counts the frames of a bus and keeps the newest."""

    def __init__(self, contract: Contract) -> None:
        self._contract = contract
        #: Identifiers of which raw frames are kept: instant in s and data.
        self.watched: dict[int, deque[tuple[float | None, bytes]]] = {}
        self.on_run()

    def on_run(self) -> None:
        self.frames: dict[int, FrameStatistics] = {}
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
            seen = self.frames[can_id] = FrameStatistics()
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
        """The telegrams since the last call, preceded by the newest earlier one of each port."""
        trace, self._trace = self._trace, Trace(self._contract)
        self._trace.idents = trace.idents
        for port, data in self._data.items():
            if times_ns := trace.times_ns(port):
                self._trace.add(port, times_ns[-1], data)
        return trace


class FrameList:
    """Decodes the newest telegram of each port; an unchanged one is not decoded again."""

    def __init__(self, contract: Contract) -> None:
        self._signals = {port.name: {item.name: item for item in port.signals} for port in contract.ports}
        self._names = {contract.poll_id: "poll", contract.device_status_id: "device status"}
        #: Identifier with which a telegram is complete -> its port.
        self._completes: dict[int, str] = {}
        for port in contract.ports:
            for number, can_id in enumerate(port.can_ids):
                self._names[can_id] = port.name if port.single_frame else f"{port.name} {number + 1}"
            self._names[port.can_ids[-1]] = port.name
            self._names[port.fd_id] = f"{port.name} FD"
            self._completes[port.can_ids[-1]] = self._completes[port.fd_id] = port.name
        self._decoded: dict[str, tuple[bytes, str]] = {}

    def list_rows(self, listener: Listener, heard: BusStatistics) -> list[list[Any]]:
        """A row per identifier: identifier, name, count, period and age in ms (None: not known), data in hex,
        decoded telegram."""
        now_ns = listener.clock.now_ns
        found = []
        for can_id, seen in sorted(heard.frames.items()):
            port = self._completes.get(can_id)
            # After frames were lost its telegram is not known before it comes again.
            whole = b"" if port is None else listener.newest.data(port)
            text = self._decode(port, whole) if port is not None and whole else ""
            last_ns, before_ns = seen.last_ns, seen.before_ns
            period_ms = None if last_ns is None or before_ns is None else (last_ns - before_ns) / 1e6
            age_ms = None if last_ns is None else (now_ns - last_ns) / 1e6
            name = self._names.get(can_id, "?")
            found.append([can_id, name, seen.count, period_ms, age_ms, seen.data.hex(" "), text])
        return found

    @staticmethod
    def list_watched(heard: BusStatistics) -> dict[int, list[list[Any]]]:
        """The last raw frames of the watched identifiers: instant in s and data in hex."""
        return {
            can_id: [[None if time_s is None else round(time_s, 4), data.hex(" ")] for time_s, data in kept]
            for can_id, kept in heard.watched.items()
        }

    def _decode(self, port: str, data: bytes) -> str:
        kept = self._decoded.get(port)
        if kept is not None and kept[0] == data:
            return kept[1]
        signals = self._signals[port].items()
        text = ", ".join(f"{name} {_format_value(item, raw_of(data, item))}" for name, item in signals)
        self._decoded[port] = (data, text if data else "")
        return self._decoded[port][1]


def _format_value(item: Signal, raw: int) -> str:
    """A raw value in the words of the wire contract, else in its unit."""
    words = {"chk": CHECK_VALUES, "antivalent": ANTIVALENT_VALUES}.get(item.check) or item.values
    if raw in words:
        return words[raw]
    return f"{raw * item.scale:.6g} {item.unit}".strip()
