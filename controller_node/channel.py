"""Monitors of the TRN_SPEED channel: its latency, its long-term quality, and a second sender.

They see only counts and whole milliseconds, and keep no history.
"""

from __future__ import annotations

from typing import Final

from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import NotchCmd, TrnSpeed
from railhil.scenarios.model import Scenario

#: Window of the long-term quality: the permitted bad telegrams may come at any instants within it.
CHANNEL_WINDOW_MS: Final = 10_000
#: A telegram older than the last one counts this much; as many per second as this fits into are permitted for ever.
DISORDER_MS = 20
#: Counts above this are two senders: their life signs alternate, so that every other telegram is old.
DISORDER_MAX_MS = 80
#: The life sign says how many telegrams were sent modulo this.
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
        schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns)
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
        """Take an old telegram: the count is lost, what the next poll shows is normal.

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
    """Counts events against time: each adds ``cost_ms``, each ms pays 1 back.

    :param limit_ms: above this, there were too many.
    """

    __slots__ = ("_at_ms", "_cost_ms", "_debt_ms", "_limit_ms")

    def __init__(self, cost_ms: int, limit_ms: int) -> None:
        self._cost_ms, self._limit_ms = cost_ms, limit_ms
        self._debt_ms = self._at_ms = 0

    def add(self, now_ms: int) -> bool:
        """Count an event; True when there were too many. A clock that was set back pays nothing."""
        paid_ms = max(now_ms - self._at_ms, 0)
        self._at_ms = now_ms
        self._debt_ms = min(max(self._debt_ms - paid_ms, 0) + self._cost_ms, 2 * self._limit_ms)
        return self._debt_ms > self._limit_ms


def channel_cost_ms(scenario: Scenario) -> int:
    """What a bad telegram counts, of :data:`CHANNEL_WINDOW_MS`."""
    return CHANNEL_WINDOW_MS // scenario.watch.channel_bad_max
