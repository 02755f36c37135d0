"""Follows a run on the bus by listening: simulation time, newest telegrams, milestones. Nothing is sent or kept."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable

from railhil.bus.clock import BusClock
from railhil.bus.frame import Frame
from railhil.bus.ident import CtlIdent
from railhil.bus.lifesign import MAX_STEP
from railhil.bus.mvb import master_tail
from railhil.bus.own_frames import OwnFrames
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.dbc import Contract
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import system_named
from railhil.scenarios.unknown import UnknownScenario
from railhil.supervisor.events.derive import milestones
from railhil.supervisor.events.event import RecordedEvent
from railhil.supervisor.now import Newest

#: Milestones that are remembered.
MILESTONES = 6


class HeardTime:
    """Simulation time of a run that is only listened to, perhaps not from its beginning and not without gaps.

    It is known from the handshake on, or from the TIME_SYNC on that the clock takes. Until then nothing that is heard
    has an instant.

    :param counters: of the clock.
    """

    def __init__(self, scenario: AnyScenario, contract: Contract, counters: Counter[str]) -> None:
        timing = scenario.timing
        self.schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, contract)
        port = contract.clock_port
        #: Identifiers of the clock port.
        self.clock_ids = {port.address, port.fd_id} if port.name != TimeSync.PORT else set()
        asked = contract.port(CtlIdent.PORT)
        #: The poll with which the handshake of a run goes on: whoever has heard ticks before hears another run.
        self.handshake_poll = master_tail(asked.f_code, asked.address)
        self._ticks = self.schedule.ticks(port.name)
        # The polls of the fastest port keep the time going while the clock port is missing.
        polled = [one for one in contract.ports if one.mode == "poll" and one.period_ns]
        paces = ((self.schedule.ticks(one.name), one.name, master_tail(one.f_code, one.address)) for one in polled)
        self._pace_ticks, _, self._pace = min(paces, default=(MAX_STEP + 1, "", b""))
        # Periods that are only believed may be others: then the clock does not agree with TIME_SYNC.
        self._is_believed = isinstance(scenario, UnknownScenario)
        self.counters = counters
        self.is_known = False
        self.clock = self._clock()

    def _clock(self) -> BusClock:
        return BusClock(self.schedule.base_tick_ns, self._ticks, self.counters)

    def begin(self) -> None:
        """The handshake was heard: the run begins."""
        self.clock, self.is_known = self._clock(), True

    def polled(self, data: bytes) -> None:
        """Take a poll."""
        if data == self._pace and self._pace_ticks <= MAX_STEP:
            self.clock.polled(self._pace_ticks)

    def hole(self) -> None:
        """Frames were lost, nobody knows how many: the time is not known until TIME_SYNC tells it."""
        self.clock, self.is_known = self._clock(), False

    def synchronise(self, telegram: TimeSync) -> bool:
        """Take TIME_SYNC; True if the time is known from now on and was not before."""
        off = self.counters["time_ahead"] + self.counters["time_backward"]
        if self.clock.synchronise(telegram):
            was_known, self.is_known = self.is_known, True
            return not was_known
        if self._is_believed and self.is_known and off != self.counters["time_ahead"] + self.counters["time_backward"]:
            self.hole()
        return False


class Follower:
    """Takes the frames of a bus; a new handshake begins another run.

    :param scenario: what runs there.
    """

    def __init__(self, scenario: AnyScenario) -> None:
        system = system_named(scenario.system)
        self._scenario, self._own, self._contract = scenario, system.events, system.contract
        self._own_frames = OwnFrames(system.contract)
        self._begin()

    def _begin(self) -> None:
        self.newest = Newest(self._contract)
        self.time = HeardTime(self._scenario, self._contract, self.newest.counters)
        self.milestones: deque[RecordedEvent] = deque(maxlen=MILESTONES)

    @property
    def now_s(self) -> float | None:
        """Simulation time of the newest frame; None: not known."""
        return self.time.clock.now_ns / 1e9 if self.time.is_known else None

    def hole(self) -> None:
        """Frames were lost: what was heard before is not of now."""
        self._forget()
        self.time.hole()

    def _forget(self) -> None:
        self.newest = Newest(self._contract)

    def take(self, frames: Iterable[Frame]) -> None:
        """Take frames in bus order."""
        time = self.time
        for frame in frames:
            if frame.can_id in time.clock_ids and self.newest.accepts(frame):
                time.clock.feed(frame.data)
            if frame.can_id == self._contract.poll_id:
                if frame in self._own_frames:
                    time.polled(frame.data)
                    if frame.data == time.handshake_poll:
                        if time.clock.running:
                            self._begin()
                            time = self.time
                        time.begin()
                continue
            port = self.newest.take(time.clock.now_ns, frame)
            if port == TimeSync.PORT:
                if time.synchronise(TimeSync.decode(self.newest.data(port))):
                    # Heard before the time was known.
                    self._forget()
            elif port == RunEvent.PORT:
                self._milestone()

    def _milestone(self) -> None:
        """RUN_EVENT is repeated; each milestone counts once."""
        for event in milestones(self.newest.trace(RunEvent.PORT), self._own):
            if event not in self.milestones:
                self.milestones.append(event)
