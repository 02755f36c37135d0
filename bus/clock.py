"""Simulation time as every node reads it from the bus, and pacing against the wall clock.

This is the only module of the bench that looks at a wall clock to pace anything.
"""

from __future__ import annotations

import time

from bus.frame import BRS, FD, Frame
from bus.mvb import check_sequence
from bus.telegrams import TimeSync
from dbc import wire_contract

_FRACTION = 65536


def to_time_sync(tick: int, base_tick_ns: int, **fields: int) -> TimeSync:
    """TIME_SYNC telegram for a tick (seconds and 1/65536 s, rounded)."""
    total = (tick * base_tick_ns * _FRACTION + 500_000_000) // 1_000_000_000
    return TimeSync(seconds_s=total // _FRACTION, fraction_65536th_s=total % _FRACTION, **fields)


def from_time_sync(telegram: TimeSync, base_tick_ns: int) -> int:
    """Tick that a TIME_SYNC telegram stands for (nearest)."""
    total_ns = (telegram.seconds_s * _FRACTION + telegram.fraction_65536th_s) * 1_000_000_000 // _FRACTION
    return (total_ns + base_tick_ns // 2) // base_tick_ns


class BusClock:
    """Counts ticks from the life sign of the clock port (the plant's fastest port, first in every tick).

    Up to 15 lost ticks are bridged by the life sign; TIME_SYNC sets the absolute value. Before the first clock frame
    ``tick`` is 0 and ``running`` is False.
    """

    __slots__ = ("_ids", "_life", "_ticks_per_frame", "base_tick_ns", "running", "tick")

    def __init__(self, base_tick_ns: int) -> None:
        port = wire_contract().clock_port
        self.base_tick_ns = base_tick_ns
        self._ids = (port.address, port.fd_id)
        self._ticks_per_frame = max(1, port.period_ns // base_tick_ns)
        self._life = -1
        self.tick = 0
        self.running = False

    def feed(self, frame: Frame) -> bool:
        """Take a frame in bus order; True when it opened a new tick."""
        can_id, data, flags = frame
        if can_id not in self._ids or flags & ~(FD | BRS) or len(data) != 8 or check_sequence(data[:4]) != data[4]:
            return False
        life = data[3] & 0xF
        if self._life >= 0:
            self.tick += ((life - self._life) & 0xF) * self._ticks_per_frame
        self._life = life
        self.running = True
        return True

    def synchronise(self, telegram: TimeSync) -> None:
        """Take the absolute tick of a TIME_SYNC telegram of the current tick."""
        self.tick = from_time_sync(telegram, self.base_tick_ns)

    @property
    def now_ns(self) -> int:
        """Simulation time of the current tick in ns."""
        return self.tick * self.base_tick_ns


class Pacer:
    """Waits for the wall clock: absolute deadlines on the monotonic clock, so lateness never accumulates.

    :param rate: simulated seconds per wall second; 0 means lockstep, ``wait`` then returns at once.
    """

    def __init__(self, rate: float = 0.0) -> None:
        self.rate = rate
        self._start_ns = 0

    def start(self) -> None:
        """Simulation time 0 is now."""
        self._start_ns = time.monotonic_ns()

    def deadline_ns(self, sim_ns: int) -> int:
        """Monotonic time at which ``sim_ns`` is due."""
        return self._start_ns + int(sim_ns / self.rate)

    def wait(self, sim_ns: int) -> int:
        """Sleep until ``sim_ns`` is due; returns the lateness in ns (0 in lockstep)."""
        if not self.rate:
            return 0
        deadline_ns = self.deadline_ns(sim_ns)
        while True:
            remaining_ns = deadline_ns - time.monotonic_ns()
            if remaining_ns <= 0:
                return -remaining_ns
            time.sleep(remaining_ns / 1e9)
