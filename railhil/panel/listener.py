"""What the panel hears on the bus: simulation time, telegrams, missed polls, load, and the frames by identifier."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable

from railhil.bus.clock import BusClock
from railhil.bus.frame import Frame
from railhil.bus.load import longest_frame_bits
from railhil.bus.mvb import master_tail
from railhil.bus.own_frames import OwnFrames
from railhil.bus.store import TrafficStore
from railhil.bus.telegrams import TimeSync
from railhil.dbc import Contract
from railhil.scenarios.model import AnyScenario
from railhil.supervisor.follow import HeardTime
from railhil.supervisor.trace import Trace

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


class Listener:
    """Follows the frames of a bus; single frames that were lost are bridged by the clock, as in every node.

    :param scenario: what runs there.
    """

    def __init__(self, scenario: AnyScenario, contract: Contract) -> None:
        self._contract = contract
        self._scenario = scenario
        self._time = HeardTime(scenario, contract, Counter())
        self._poll_id = contract.poll_id
        self._own = OwnFrames(contract)
        self._polls = {
            master_tail(port.f_code, port.address): port.name for port in contract.ports if port.mode == "poll"
        }
        #: Identifiers of which raw frames are kept: instant in s and data.
        self.watched: dict[int, deque[tuple[float | None, bytes]]] = {}
        #: Number of the run since this process began; a new handshake of the plant begins a new one.
        self.run = 0
        self.restart()

    def restart(self) -> None:
        """Forget everything: another run begins."""
        contract = self._contract
        self.run += 1
        self.store = TrafficStore(contract.ports)
        self._time = HeardTime(self._scenario, contract, self.store.counters)
        # The last instant that was known before a hole; -1: there was none.
        self._last_ns = -1
        self.frames: dict[int, SeenFrame] = {}
        self.frame_count = 0
        self.polls = 0
        self.missed: Counter[str] = Counter()
        self._awaited: set[str] = set()
        self._bits = 0
        self._load_from_ns = 0
        #: Share of the bus in use, in simulation time; None: not known yet.
        self.load: float | None = None
        self.trace = Trace(contract)

    @property
    def clock(self) -> BusClock:
        """The clock, which tells the time of the run if :attr:`knows_time`."""
        return self._time.clock

    @property
    def knows_time(self) -> bool:
        """Whether the time is that of the run: its beginning was heard, or TIME_SYNC has told it."""
        return self._time.is_known

    @property
    def now_s(self) -> float | None:
        """Simulation time of the newest frame; None: not known."""
        return self.clock.now_ns / 1e9 if self.knows_time else None

    def hole(self) -> None:
        """Frames were lost: what was heard before is not of now, and the time is not known."""
        if self.knows_time:
            self._last_ns = self.clock.now_ns
        self._time.hole()
        self._forget()

    def _forget(self) -> None:
        """Forget the telegrams and instants so far: nobody knows when they were, or they are not of now."""
        self.store = TrafficStore(self._contract.ports)
        self.trace = Trace(self._contract)
        self._awaited.clear()
        for seen in self.frames.values():
            seen.before_ns = seen.last_ns = None
        self._bits, self._load_from_ns, self.load = 0, self.clock.now_ns, None

    def take(self, frames: Iterable[Frame]) -> None:
        """Take frames in bus order; their telegrams are added to :attr:`trace`."""
        for frame in frames:
            self._take(frame)

    def next_trace(self) -> Trace:
        """The telegrams since the last call, behind the newest one of each port before them."""
        trace, self.trace = self.trace, Trace(self._contract)
        self.trace.idents = trace.idents
        for port in self.store.ports:
            if times_ns := trace.times_ns(port):
                self.trace.add(port, times_ns[-1], self.store.raw(port))
        return trace

    def _take(self, frame: Frame) -> None:
        can_id, data, flags = frame
        clock = self.clock
        if can_id in self._time.clock_ids and not self.store.check(frame).cause:
            clock.feed(data)
        now_ns, knows_time = clock.now_ns, self._time.is_known
        seen = self.frames.get(can_id)
        if seen is None:
            seen = self.frames[can_id] = SeenFrame()
        seen.count += 1
        seen.before_ns, seen.last_ns = seen.last_ns, now_ns if knows_time else None
        seen.data, seen.flags = data, flags
        self.frame_count += 1
        self._bits += longest_frame_bits(len(data))
        if knows_time and now_ns - self._load_from_ns >= _LOAD_NS:
            self.load = self._bits * 1e9 / (now_ns - self._load_from_ns) / self._contract.bit_rate
            self._bits, self._load_from_ns = 0, now_ns
        if can_id in self.watched:
            self.watched[can_id].append((now_ns / 1e9 if knows_time else None, data))
        if can_id == self._poll_id and frame in self._own:
            self._polled(data)
            return
        port = self.store.feed(frame, now_ns)
        if port is None:
            return
        self._awaited.discard(port)
        data = self.store.raw(port)
        if port == TimeSync.PORT and self._time.synchronise(TimeSync.decode(data)):
            self._know()
        self.trace.add(port, self.clock.now_ns, data)

    def _polled(self, data: bytes) -> None:
        port = self._polls.get(data)
        if port is not None:
            self._time.polled(data)
            if data == self._time.handshake_poll:
                self._opened()
            self.polls += 1
            self.missed[port] += port in self._awaited
            self._awaited.add(port)

    def _know(self) -> None:
        """The time is known from now on; earlier than before the hole, it is that of another run."""
        if self.clock.now_ns < self._last_ns:
            self.run += 1
            self._last_ns = -1
        self._forget()

    def _opened(self) -> None:
        """The handshake: the plant begins a run, before its first tick."""
        if self.clock.running or self._last_ns >= 0:
            self.restart()
        self._time.begin()
