"""Follows a run on the bus by listening: simulation time, newest telegrams, milestones. Nothing is sent or kept."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from railhil.bus.clock import BusClock
from railhil.bus.frame import Frame
from railhil.bus.ident import PltIdent
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import system_named
from railhil.supervisor.events.derive import milestones
from railhil.supervisor.events.event import RecordedEvent
from railhil.supervisor.now import Newest

#: Milestones that are remembered.
MILESTONES = 6
#: Characters of a scenario's hash that the handshake carries, as a number.
_HASH_DIGITS = 8


class Follower:
    """Takes the frames of a bus; a new handshake of the plant begins another run.

    :param scenario: what is believed to run; the handshake says whether it does.
    """

    def __init__(self, scenario: AnyScenario) -> None:
        system = system_named(scenario.system)
        contract, timing = system.contract, scenario.timing
        self._scenario, self._own, self._contract = scenario, system.events, contract
        self._schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, contract)
        clock_port = contract.clock_port
        self._clock_ids = {clock_port.address, clock_port.fd_id}
        self.frames = 0
        self._begin()

    def _begin(self) -> None:
        self.newest = Newest(self._contract)
        self.clock = BusClock(
            self._schedule.base_tick_ns,
            self._schedule.ticks(self._contract.clock_port.name),
            self.newest.counters,
        )
        self.milestones: deque[RecordedEvent] = deque(maxlen=MILESTONES)
        #: Whether the handshake names another scenario; None: not heard.
        self.other_scenario: bool | None = None

    @property
    def now_s(self) -> float:
        """Simulation time of the newest frame."""
        return self.clock.now_ns / 1e9

    def take(self, frames: Iterable[Frame]) -> None:
        """Take frames in bus order."""
        for frame in frames:
            self.frames += 1
            if frame.can_id in self._clock_ids and self.newest.accepts(frame):
                self.clock.feed(frame.data)
            port = self.newest.take(self.clock.now_ns, frame)
            if port == TimeSync.PORT:
                self.clock.synchronise(TimeSync.decode(self.newest.data(port)))
            elif port == RunEvent.PORT:
                self._milestone()
            elif port == PltIdent.PORT:
                self._opened(frame)

    def _milestone(self) -> None:
        """RUN_EVENT is repeated; each milestone counts once."""
        for event in milestones(self.newest.trace(RunEvent.PORT), self._own):
            if event not in self.milestones:
                self.milestones.append(event)

    def _opened(self, frame: Frame) -> None:
        told = PltIdent.decode(self.newest.data(PltIdent.PORT)).scenario_hash
        if self.clock.running:
            # The handshake comes before the first tick: what is known belongs to the run before.
            self._begin()
            self.newest.take(0, frame)
        self.other_scenario = told != int(self._scenario.sha256[:_HASH_DIGITS], 16)
