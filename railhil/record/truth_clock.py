"""The recorder's time: the bus clock; under faults the telegrams of the truth, because a fault may touch the port that
opens the ticks, its life sign and TIME_SYNC."""

from __future__ import annotations

from operator import itemgetter
from typing import NamedTuple

from railhil.bus.frame import Frame
from railhil.bus.lifesign import MAX_STEP
from railhil.bus.mvb import master_frame
from railhil.bus.schedule import Schedule
from railhil.dbc import Contract

_LIFE_MODULUS = 16


class TruthClock:
    """Counts ticks by the telegrams of the truth, which no fault touches, and between them by the telegrams of the
    clock port.

    If the clock port is lost or wrong, the error of the time is less than the period of the truth.

    :param truth: name of the truth's port.
    """

    def __init__(self, contract: Contract, schedule: Schedule, truth: str) -> None:
        # A run without faults has no such clock and does not load the faults' modules.
        from railhil.faults.capability import life_signal

        port, clock = contract.port(truth), contract.clock_port
        self._base_tick_ns = schedule.base_tick_ns
        self._truth_ids = {port.can_ids[0], port.fd_id}
        self._truth_ticks, self._clock_ticks = schedule.ticks(truth), schedule.ticks(clock.name)
        self._life_signal = life_signal(port)
        self._truth_life = self._clock_life = -1
        # Ticks of the last telegrams of the truth and of the clock port.
        self._last, self._clock_tick = -self._truth_ticks, 0
        self._begun = False
        # The part of the silences that is less than the period of the truth.
        self._spare_ns = 0
        # Telegrams of the clock port since the last one of the truth.
        self._seen = 0
        self.tick = 0
        #: Simulation time of the present tick.
        self.now_ns = 0

    @property
    def truth_ids(self) -> set[int]:
        """Identifiers of the frames to be passed to :meth:`truth`: the first of each telegram."""
        return self._truth_ids

    def truth(self, frame: Frame) -> bool:
        """The first frame of a telegram of the truth; True if it begins a new tick."""
        step, found = 1, self._life_signal
        if found is not None and found.first_bit + found.length <= len(frame.data) * 8:
            modulus = 1 << found.length
            life = int.from_bytes(frame.data) >> len(frame.data) * 8 - found.first_bit - found.length & modulus - 1
            step = (life - self._truth_life) % modulus if self._truth_life >= 0 else 1
            self._truth_life = life
        self._last += step * self._truth_ticks
        if self._seen * self._clock_ticks == self._truth_ticks:
            # No frame is missing, so the last one has opened this tick.
            self._clock_tick = self._last
        self._seen = 0
        return self._set(max(self.tick, self._last))

    def clock(self, frame: Frame) -> bool:
        """A frame of the clock port; True if it begins a new tick."""
        if len(frame.data) < 4:
            return False
        life = frame.data[3] & 0xF
        round_ticks = _LIFE_MODULUS * self._clock_ticks
        tick = self._clock_tick + (life - self._clock_life) % _LIFE_MODULUS * self._clock_ticks
        # The first tick with this life sign that is not over.
        tick += max(0, -(-(self.tick - tick) // round_ticks)) * round_ticks
        latest = max(self._last + self._truth_ticks, self.tick)
        if self._clock_life < 0 or tick > latest:
            tick = min(self.tick + self._clock_ticks, latest)
        self._seen += 1
        self._clock_life, self._clock_tick = life, tick
        return self._set(tick)

    def silence(self, sim_ns: int) -> None:
        """Take note that nothing could be received for some simulation time."""
        frames, self._spare_ns = divmod(self._spare_ns + sim_ns, self._truth_ticks * self._base_tick_ns)
        self._last += frames * self._truth_ticks
        self._set(max(self.tick, self._last))

    def _set(self, tick: int) -> bool:
        new = tick > self.tick or not self._begun
        self.tick, self._begun = tick, True
        self.now_ns = tick * self._base_tick_ns
        return new


class TimeBase(NamedTuple):
    """Advances the time of a record besides the clock port.

    ``truth``: keeps the time instead of the bus clock; None: the bus clock does. ``pace``: the poll that advances the
    bus clock while the clock port is missing, the fastest one of any node; None: none does. ``pace_ticks``: its period.
    """

    truth: TruthClock | None
    pace: Frame | None
    pace_ticks: int

    @classmethod
    def of(cls, contract: Contract, schedule: Schedule, truth: str) -> TimeBase:
        """The time base of a contract.

        :param truth: name of the truth's port under faults; empty: there are no faults.
        """
        polled = [port for port in contract.ports if port.mode == "poll" and port.period_ns]
        ticks, fastest = min(((schedule.ticks(port.name), port) for port in polled), key=itemgetter(0))
        if truth:
            return cls(TruthClock(contract, schedule, truth), None, ticks)
        return cls(None, master_frame(fastest.f_code, fastest.address) if ticks <= MAX_STEP else None, ticks)
