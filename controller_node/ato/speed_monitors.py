"""Monitors of the TRN_SPEED channel: its latency, its long-term quality, and a second sender.

They see only counts and whole milliseconds, and keep no history.
"""

from __future__ import annotations

from typing import Final

from railhil.bus.schedule import Schedule
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd, TrnSpeed

#: Window of the long-term quality: the permitted bad telegrams may come at any instants within it.
CHANNEL_WINDOW_MS: Final = 10_000
#: Cost of a telegram older than the last one. The rate per second that pays exactly this cost is permitted for ever.
DISORDER_MS = 20
#: Counts above this are two senders: their life signs alternate, so that every other telegram is old.
DISORDER_MAX_MS = 80
#: The life sign counts the telegrams sent modulo this.
_LIFE_TURN: Final = 16


class Latency:
    """Age of the telegrams themselves, from the node's second time base: the bus administrator's polls.

    Telegrams and polls are sent on fixed periods. When the telegrams fall behind the polls, they are delayed on their
    way, although they arrive one after another in time. Times are base ticks, modulo 16 telegrams: a delay is seen
    modulo that time (160 ms at 10 ms), a constant one only after an undelayed beginning. Lost polls put the telegrams
    ahead, which becomes the new normal.

    ``limit_ticks``: largest latency that is not stale; ``poll_ticks``: between two polls.
    """

    __slots__ = ("_base", "_doubt", "_frame_ticks", "_is_old", "_lag", "_life", "_turn", "limit_ticks", "poll_ticks")

    def __init__(self, scenario: Scenario) -> None:
        timing = scenario.timing
        schedule = Schedule.from_contract(
            timing.base_tick_ns, timing.port_period_ns, scenario.installed_system.contract
        )
        self._frame_ticks = schedule.ticks(TrnSpeed.PORT)
        self.poll_ticks = schedule.ticks(NotchCmd.PORT)
        self._turn = _LIFE_TURN * self._frame_ticks
        # Between two polls, or two telegrams, the difference also changes without a delay.
        own = max(self._frame_ticks, self.poll_ticks)
        self.limit_ticks = scenario.watch.traction_cut_ms * 1_000_000 // timing.base_tick_ns + own
        self._lag = self._base = self._life = 0
        self._doubt = True
        self._is_old = False

    def received(self, life: int) -> None:
        """Take the life sign of a new telegram: the telegrams before it have been sent as well."""
        self._lag -= (life - self._life) % _LIFE_TURN * self._frame_ticks
        self._life = life
        self._is_old = False

    def doubt(self) -> bool:
        """Take an old telegram: the count is lost, and the difference at the next poll counts as normal.

        :returns: whether the telegram before was an old one as well.
        """
        was_old, self._is_old, self._doubt = self._is_old, True, True
        return was_old

    def polled(self) -> bool:
        """Take a poll; True when the telegrams are stale."""
        self._lag += self.poll_ticks
        latency = self._lag - self._base
        if self._doubt or latency < 0:
            self._base, self._doubt = self._lag, False
            return False
        if latency >= self._turn:
            self._lag -= self._turn
            latency -= self._turn
        return latency > self.limit_ticks


class Debt:
    """Counts events against time: each adds ``cost``, each ms pays ``paid_per_ms`` back.

    :param limit: above this, there are too many events.
    """

    __slots__ = ("_at_ms", "_cost", "_debt", "_limit", "_paid_per_ms")

    def __init__(self, cost: int, limit: int, paid_per_ms: int = 1) -> None:
        self._cost, self._limit, self._paid_per_ms = cost, limit, paid_per_ms
        self._debt = self._at_ms = 0

    def add(self, now_ms: int) -> bool:
        """Count an event; True when there were too many. A clock that was set back pays nothing."""
        paid = max(now_ms - self._at_ms, 0) * self._paid_per_ms
        self._at_ms = now_ms
        self._debt = min(max(self._debt - paid, 0) + self._cost, 2 * self._limit)
        return self._debt > self._limit
