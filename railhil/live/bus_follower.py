"""Follows a run on the bus by listening: simulation time, newest telegrams, milestones. Nothing is sent or kept."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable, Mapping

from railhil.bus.clock import BusClock
from railhil.bus.frame import Frame
from railhil.bus.ident import CtlIdent
from railhil.bus.lifesign import MAX_STEP
from railhil.bus.mvb import master_tail
from railhil.bus.own_frames import OwnFrames
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.dbc import Contract
from railhil.judge.events.event import RecordedEvent
from railhil.judge.events.telegrams import milestones
from railhil.live.live_values import Newest
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import UnknownScenario

#: Milestones that are remembered.
MILESTONES = 6


class HeardTime:
    """Simulation time of a run for a listener, perhaps without its beginning and with gaps.

    It is known from the handshake on, or from the TIME_SYNC on that the clock takes. Until then the instants of frames
    are unknown.

    :param counters: of the clock.
    """

    def __init__(self, scenario: AnyScenario, contract: Contract, counters: Counter[str]) -> None:
        timing = scenario.timing
        self.schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, contract)
        port = contract.clock_port
        #: Identifiers of the clock port.
        self.clock_ids = {port.address, port.fd_id} if port.name != TimeSync.PORT else set()
        asked = contract.port(CtlIdent.PORT)
        #: The poll that continues the handshake of a run: after ticks it means that another run begins.
        self.handshake_poll = master_tail(asked.f_code, asked.address)
        self._ticks = self.schedule.ticks(port.name)
        # The polls of the fastest port advance the time while the clock port is missing.
        polled = [one for one in contract.ports if one.mode == "poll" and one.period_ns]
        paces = ((self.schedule.ticks(one.name), one.name, master_tail(one.f_code, one.address)) for one in polled)
        self._pace_ticks, _, self._pace = min(paces, default=(MAX_STEP + 1, "", b""))
        # Assumed periods may be wrong: the clock then does not agree with TIME_SYNC.
        self._is_believed = isinstance(scenario, UnknownScenario)
        self.counters = counters
        self.is_known = False
        self.clock = self._clock()

    def _clock(self) -> BusClock:
        return BusClock(self.schedule.base_tick_ns, self._ticks, self.counters)

    def begin(self) -> None:
        """Take note that the handshake was heard: the run begins."""
        self.clock, self.is_known = self._clock(), True

    def take_poll(self, data: bytes) -> None:
        """Take a poll."""
        if data == self._pace and self._pace_ticks <= MAX_STEP:
            self.clock.polled(self._pace_ticks)

    def note_loss(self) -> None:
        """Take note that an unknown number of frames was lost: the time is unknown until TIME_SYNC gives it."""
        self.clock, self.is_known = self._clock(), False

    def synchronise(self, telegram: TimeSync) -> bool:
        """Take TIME_SYNC; True if the time is known from now on and was not before."""
        off = self.counters["time_ahead"] + self.counters["time_backward"]
        if self.clock.synchronise(telegram):
            was_known, self.is_known = self.is_known, True
            return not was_known
        if self._is_believed and self.is_known and off != self.counters["time_ahead"] + self.counters["time_backward"]:
            self.note_loss()
        return False


class BusObserver:
    """Gets the frames and events of a :class:`Listener`. Each method does nothing here."""

    def on_run(self) -> None:
        """Another run begins: the frames so far belong to an earlier one."""

    def on_hole(self) -> None:
        """Frames were lost, or the time was unknown: the last values are out of date."""

    def on_frame(self, frame: Frame, now_ns: int | None) -> None:
        """A frame at this simulation time; None: unknown."""

    def on_poll(self, port: str) -> None:
        """The bus administrator has polled a port."""

    def on_telegram(self, port: str, now_ns: int, data: bytes) -> None:
        """A telegram is complete."""


class Listener:
    """Follows the frames of a bus: the time of the run, and the newest telegram of each port. Single frames that were
    lost are bridged by the clock, as in every node. A new handshake begins another run.

    :param scenario: what runs there.
    :param contract: the ports that are known.
    """

    def __init__(self, scenario: AnyScenario, contract: Contract, *observers: BusObserver) -> None:
        self.contract = contract
        self._scenario = scenario
        self._observers = observers
        self._own = OwnFrames(contract)
        self._polls = {
            master_tail(port.f_code, port.address): port.name for port in contract.ports if port.mode == "poll"
        }
        #: Number of the run since this process began.
        self.run = 0
        self._restart()

    def _restart(self) -> None:
        self.run += 1
        self.newest = Newest(self.contract)
        self._time = HeardTime(self._scenario, self.contract, self.newest.counters)
        # The last known instant before a gap; -1: there was none.
        self._last_ns = -1
        for observer in self._observers:
            observer.on_run()

    @property
    def clock(self) -> BusClock:
        """The clock, which has the time of the run if :attr:`knows_time`."""
        return self._time.clock

    @property
    def knows_time(self) -> bool:
        """Whether the time of the run is known: its beginning was heard, or TIME_SYNC has given it."""
        return self._time.is_known

    @property
    def now_s(self) -> float | None:
        """Simulation time of the newest frame; None: not known."""
        return self.clock.now_ns / 1e9 if self.knows_time else None

    def note_loss(self) -> None:
        """Take note that frames were lost: the last values are out of date, and the time is unknown."""
        if self.knows_time:
            self._last_ns = self.clock.now_ns
        self._time.note_loss()
        self._forget()

    def _forget(self) -> None:
        """Forget the telegrams so far: their times are unknown, or they are out of date."""
        self.newest = Newest(self.contract)
        for observer in self._observers:
            observer.on_hole()

    def take(self, frames: Iterable[Frame]) -> None:
        """Take frames in bus order."""
        for frame in frames:
            self._take(frame)

    def _take(self, frame: Frame) -> None:
        if frame.can_id in self._time.clock_ids and self.newest.accepts(frame):
            self.clock.feed(frame.data)
        now_ns = self.clock.now_ns if self.knows_time else None
        for observer in self._observers:
            observer.on_frame(frame, now_ns)
        if frame.can_id == self.contract.poll_id and frame in self._own:
            self._take_poll(frame.data)
            return
        port = self.newest.take(self.clock.now_ns, frame)
        if port is None:
            return
        data = self.newest.data(port)
        if port == TimeSync.PORT and self._time.synchronise(TimeSync.decode(data)):
            self._know()
        for observer in self._observers:
            observer.on_telegram(port, self.clock.now_ns, data)

    def _take_poll(self, data: bytes) -> None:
        port = self._polls.get(data)
        if port is None:
            return
        self._time.take_poll(data)
        if data == self._time.handshake_poll:
            # The plant begins a run, before its first tick.
            if self.clock.running or self._last_ns >= 0:
                self._restart()
            self._time.begin()
        for observer in self._observers:
            observer.on_poll(port)

    def _know(self) -> None:
        """The time is known from now on. If it is earlier than before the gap, another run has begun."""
        if self.clock.now_ns < self._last_ns:
            self.run += 1
            self._last_ns = -1
        # The telegram was heard before the time was known.
        self._forget()


class Milestones(BusObserver):
    """The last milestones of a run.

    :param own_events: of the system.
    """

    def __init__(self, contract: Contract, own_events: Mapping[str, int]) -> None:
        self._contract, self._own = contract, own_events
        self.newest: deque[RecordedEvent] = deque(maxlen=MILESTONES)

    def on_run(self) -> None:
        self.newest.clear()

    def on_telegram(self, port: str, now_ns: int, data: bytes) -> None:
        if port != RunEvent.PORT:
            return
        trace = Trace(self._contract)
        trace.add(port, now_ns, data)
        # RUN_EVENT is repeated; each milestone counts once.
        for event in milestones(trace, self._own):
            if event not in self.newest:
                self.newest.append(event)
