"""Simulation time as every node derives it from the bus, and pacing by the wall clock.

This is the only module of the bench that uses a wall clock for pacing.
"""

from __future__ import annotations

import time
from collections import Counter
from typing import Final

from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.lifesign import MAX_STEP, LifeSign
from railhil.bus.telegrams import TimeSync
from railhil.common.patience import WallClock

_FRACTION: Final = 65536
_LIFE_MODULUS: Final = 16
#: SimRate in tenths: 0 is reserved for lockstep; the ends mean "this slow or slower" and "this fast or faster".
RATE_MIN_10TH, RATE_MAX_10TH = 1, 255


def to_time_sync(tick: int, base_tick_ns: int, **fields: int) -> TimeSync:
    """TIME_SYNC telegram for a tick (seconds and 1/65536 s, rounded)."""
    total = (tick * base_tick_ns * _FRACTION + 500_000_000) // 1_000_000_000
    return TimeSync(seconds_s=total // _FRACTION, fraction_65536th_s=total % _FRACTION, **fields)


def from_time_sync(telegram: TimeSync, base_tick_ns: int) -> int:
    """Tick of a TIME_SYNC telegram (nearest)."""
    total_ns = (telegram.seconds_s * _FRACTION + telegram.fraction_65536th_s) * 1_000_000_000 // _FRACTION
    return (total_ns + base_tick_ns // 2) // base_tick_ns


def rate_to_10th(rate: float) -> int:
    """SimRate of a pace in simulated seconds per wall second; 0 only in lockstep."""
    return min(max(round(rate * 10), RATE_MIN_10TH), RATE_MAX_10TH) if rate else 0


class BusClock:
    """Counts ticks from the life sign of the clock port (the plant's fastest port, first in every tick).

    ======================================== ========================================================================
    seen                                     what the clock does
    ======================================== ========================================================================
    life sign 1..7 ahead                     counts on; the ticks of lost frames are bridged
    life sign repeated, or behind by 1..8    nothing: a stuck, duplicated or old frame opens no tick
    8..14 ahead, and the next frame follows  the whole bus was silent: bridged by the second frame
    no clock frame since the last poll       the polls advance the clock: they are periodic
    life sign of a slower port ahead         a silence that the clock port's own cannot tell, see :meth:`slow`
    nothing at all, the interface was out    :meth:`silence` counts on, by the wall clock and the pace of the run
    TIME_SYNC                                takes its absolute value if it is plausible, see :meth:`synchronise`
    ======================================== ========================================================================

    The polls matter when only the clock port fails: without them the node's time would stop, and so would the ageing of
    the last speed. Before the first clock frame or TIME_SYNC ``tick`` is 0 and ``running`` is False. A node that is
    polled during a run only may count from its first poll on (:meth:`polled`).

    A node that comes late, as after a restart, counts from 0 until TIME_SYNC tells the time of the run (``is_set``).
    This jump is not elapsed time: ages are differences of ``own_ns``, which leaves it out.

    :param counters: where refused TIME_SYNC are counted by cause: ``time_check`` (check variable not correct),
        ``time_duplicate``, ``time_out_of_order`` (life sign), ``time_backward``, ``time_ahead``.
    """

    __slots__ = (
        "_ahead", "_began_tick", "_expected", "_frame_tick", "_known_tick", "_life", "_near_ticks", "_poll_tick",
        "_polls", "_slow", "_slow_ahead", "_spare_ns", "_sync_life", "_ticks_per_frame", "base_tick_ns", "counters",
        "is_set", "now_ns", "own_ns", "rate", "running", "tick",
    )  # fmt: skip

    def __init__(self, base_tick_ns: int, ticks_per_frame: int, counters: Counter[str] | None = None) -> None:
        self.counters: Counter[str] = Counter() if counters is None else counters
        self.base_tick_ns = base_tick_ns
        self._ticks_per_frame = ticks_per_frame
        # Largest number of lost ticks that life signs can bridge.
        self._near_ticks = MAX_STEP * self._ticks_per_frame
        # Life sign of the last clock frame (-1: not known) and its tick, which falls behind ``tick`` when polls advance
        # the clock.
        self._life = -1
        self._frame_tick = 0
        # The next life sign that would confirm that seemingly old frames are new.
        self._expected = -1
        # Polls since the last clock frame, and the tick of the first of them.
        self._polls = 0
        self._poll_tick = 0
        # Life sign of the last TIME_SYNC taken. For a TIME_SYNC refused as too far ahead: its life sign, and by how
        # much it was ahead.
        self._sync_life = LifeSign()
        self._ahead: tuple[int, int] | None = None
        # Life sign of a slower port, with the tick of this node's count at which it was right. For a life sign ahead of
        # the clock: by how much, and the life sign.
        self._slow: tuple[int, int] | None = None
        self._slow_ahead: tuple[int, int] | None = None
        # Since an outage of the interface the time is an estimate: the last tick before it (-1: it is no estimate).
        self._known_tick = -1
        # The part of that time that is less than a tick.
        self._spare_ns = 0
        self.tick = 0
        #: Simulation time of the current tick in ns; read ten times per tick, hence not a property.
        self.now_ns = 0
        # The tick at which a node that came late began to count.
        self._began_tick = 0
        #: Simulation time since the beginning of this node's count, for ages.
        self.own_ns = 0
        #: Whether a TIME_SYNC has been taken: the time is that of the run.
        self.is_set = False
        self.running = False
        #: Pace from TIME_SYNC in simulated seconds per wall second, see :func:`rate_to_10th`; 0: lockstep, or not
        #: known.
        self.rate = 0.0

    def feed(self, data: bytes) -> bool:
        """Take the process data of a telegram of the clock port, in bus order; True when it opened a new tick.

        Frames refused by the store's check must not be passed: they open no tick.
        """
        life = data[3] & 0xF
        if self.tick == self._frame_tick and self._life >= 0 and life == (self._life + 1) % _LIFE_MODULUS:
            # The next life sign, in time: nearly always the case, so it is decided first.
            self._life = life
            self.tick = self._frame_tick = tick = self.tick + self._ticks_per_frame
            self.now_ns = tick * self.base_tick_ns
            self.own_ns = (tick - self._began_tick) * self.base_tick_ns
            self._expected = -1
            self._polls = 0
            return True
        if not self.running:
            return self._open(0, life)
        if self._life < 0:
            return self._open(self.tick + self._ticks_per_frame, life)
        step = (life - self._life) % _LIFE_MODULUS
        if step == 0:
            return False
        # Of the ticks with this life sign, the one nearest to the time according to the polls.
        behind = (self.tick - self._frame_tick) // self._ticks_per_frame - step
        step += (behind + MAX_STEP) // _LIFE_MODULUS * _LIFE_MODULUS
        if step < 0:
            confirmed, self._expected = life == self._expected, (life + 1) % _LIFE_MODULUS
            if not confirmed:
                return False
            step += _LIFE_MODULUS
        return self._open(self._frame_tick + step * self._ticks_per_frame, life)

    @property
    def is_regular(self) -> bool:
        """Whether the time is that of the last clock frame, so that the next one need only be the next."""
        return self._life >= 0 and self.tick == self._frame_tick

    @property
    def life(self) -> int:
        """Life sign of the last clock frame; -1: not known."""
        return self._life

    @property
    def ticks_per_frame(self) -> int:
        """Ticks from one clock frame to the next."""
        return self._ticks_per_frame

    @property
    def polled_tick(self) -> int:
        """Tick of the first poll since the last clock frame; -1: there was none."""
        return self._poll_tick if self._polls else -1

    def count(self, frames: int, polled_tick: int) -> None:
        """:meth:`feed` of a number of clock frames with :meth:`polled` between them. The time must be regular: each
        frame is the next one, and each poll comes at a multiple of its period and once in a tick.

        :param polled_tick: tick of the last poll; -1: there was none.
        """
        if frames:
            self._life = (self._life + frames) % _LIFE_MODULUS
            self._frame_tick = self.tick + frames * self._ticks_per_frame
            self._set(self._frame_tick)
            self._expected = -1
            self._polls = 0
        if polled_tick >= 0:
            self._poll_tick = polled_tick
            self._polls = int(polled_tick == self.tick)

    def _open(self, tick: int, life: int) -> bool:
        new = tick > self.tick or not self.running
        self.running = True
        self._life = life
        self._frame_tick = tick
        self._expected = -1
        self._polls = 0
        if new:
            self._set(tick)
        return new

    def _set(self, tick: int) -> None:
        self.tick = tick
        self.now_ns = tick * self.base_tick_ns
        self.own_ns = (tick - self._began_tick) * self.base_tick_ns

    def polled(self, period_ticks: int, begins: bool = False) -> None:
        """Take a poll that is sent at every multiple of ``period_ticks``.

        A repeated poll puts the clock ahead by one period until the clock frames have caught up.

        :param begins: if nothing has begun the count by the second poll, tick 0 is that of the first one. Without it,
            time that no clock frame has begun stands still.
        """
        if not self.running:
            if not begins:
                return
            if self._polls == 0:
                self._polls = 1
                return
            self.running = True
        if self._polls == 0:
            self._poll_tick = -(-self._frame_tick // period_ticks) * period_ticks
        tick = self._poll_tick + self._polls * period_ticks
        if tick > self.tick:
            self._set(tick)
        self._polls += 1

    def silence(self, wall_ns: int) -> None:
        """Nothing could be received for ``wall_ns``: advance the time at the pace of the run.

        The result is an estimate, like that from the polls: the next clock frame is assigned to the nearest tick with
        its life sign. At a pace outside the range of SimRate (0.05, 25.5) the limit of the range is used until the next
        TIME_SYNC corrects the time. Until then a slow run overestimates the age of a speed, and a fast run
        underestimates it.
        """
        if self.running:
            self.elapsed(int(wall_ns * self.rate))

    def elapsed(self, sim_ns: int) -> None:
        """Nothing was received for ``sim_ns`` of simulation time: advance by it, as by the node's own timer."""
        if self.running:
            if self._known_tick < 0:
                self._known_tick = self.tick
                self._spare_ns = 0
            ticks, self._spare_ns = divmod(self._spare_ns + sim_ns, self.base_tick_ns)
            self._set(self.tick + ticks)

    def slow(self, life: int, period_ticks: int, received_ns: int) -> None:
        """Take the life sign of a port slower than the clock port; it counts more time than the clock port's own.

        A silence of the whole bus can shift the clock by whole turns of its life sign, which the clock port alone
        cannot show. If two telegrams in a row of the slower port are ahead by the same number of turns, the clock
        follows them. By the slower port's count, both must come soon after the last telegram that was not ahead;
        otherwise telegrams of the slower port itself are missing or late. The result is an estimate, see
        :meth:`silence`: TIME_SYNC may take it back.

        :param received_ns: :attr:`own_ns` at its arrival.
        """
        at_tick = received_ns // self.base_tick_ns
        if self._slow is None:
            self._slow = life, at_tick
            return
        right_life, right_tick = self._slow
        turn, slow_turn = _LIFE_MODULUS * self._ticks_per_frame, _LIFE_MODULUS * period_ticks
        # A period before the silence and two after it, and the part that the clock port shows.
        soon = 3 * period_ticks + turn
        since = at_tick - right_tick
        ahead = ((life - right_life) * period_ticks - since) % slow_turn
        before, self._slow_ahead = self._slow_ahead, None
        if ahead == 0:
            self._slow = life, at_tick
        elif since <= soon and ahead < slow_turn - soon and ahead % turn == 0:
            if before == (ahead, (life - 1) % _LIFE_MODULUS):
                self.elapsed(ahead * self.base_tick_ns)
                self._slow = life, at_tick + ahead
            else:
                self._slow_ahead = ahead, life

    def synchronise(self, telegram: TimeSync) -> bool:
        """Take pace and absolute tick of a TIME_SYNC telegram of the current tick; False when it is refused.

        Refused and counted are a wrong check variable, a life sign that is not new, and a time that the clock's own
        count contradicts: a repeated or forged TIME_SYNC must not stop the ageing of the last speed.

        - Never backwards, except to correct the estimate of :meth:`silence`, and never before that outage.
        - Ahead at most by the ticks that life signs can bridge. A time further ahead is taken when the next TIME_SYNC
          confirms it: the whole bus was silent, or this node came late.
        """
        cause, tick = self._implausible(telegram)
        if cause:
            self.counters[cause] += 1
            return False
        self._sync_life.accept(telegram.life)
        self._known_tick = -1
        if not self.is_set and tick - self.tick > self._near_ticks:
            self._began_tick = tick - self.tick
        self.is_set = True
        self.rate = telegram.rate_10th / 10
        if tick == self.tick and self.running:
            return True
        known = self._life >= 0 and self._polls > 0 and abs(tick - self.tick) <= self._near_ticks
        self.running = True
        self._set(tick)
        if known:
            # The clock frames have been missing since before the last poll: their life sign continues from its last
            # value.
            return True
        # It is unknown whether the clock frame of this tick was lost: the next one counts as the next tick.
        self._frame_tick = tick
        self._life = self._expected = -1
        self._polls = 0
        return True

    def _implausible(self, telegram: TimeSync) -> tuple[str, int]:
        """Why a TIME_SYNC is refused (empty: it is not), and its tick."""
        tick = from_time_sync(telegram, self.base_tick_ns)
        if telegram.check != CHECK_CORRECT:
            return "time_check", tick
        off, near = tick - self.tick, self._near_ticks
        if off > near:
            # A time ahead cannot be a repetition, and after a long silence the order of the life signs says nothing.
            before, self._ahead = self._ahead, (telegram.life, off)
            if before is not None and telegram.life == (before[0] + 1) % _LIFE_MODULUS and abs(off - before[1]) <= near:
                self._ahead = None
                return "", tick
            return "time_ahead", tick
        life = self._sync_life.judge(telegram.life)
        if not life.fresh:
            return f"time_{life.value}", tick
        self._ahead = None
        if off < 0:
            return "" if 0 <= self._known_tick < tick else "time_backward", tick
        return "", tick


class Pacer:
    """Paces by the wall clock, with absolute deadlines on the monotonic clock, so lateness never accumulates.

    :param rate: simulated seconds per wall second; 0 means lockstep, ``wait`` then returns at once.
    :param wall: the clock to wait on.
    """

    def __init__(self, rate: float = 0.0, wall: WallClock = time) -> None:
        self.rate = rate
        self.wall = wall
        self._start_ns = 0

    def start(self) -> None:
        """Define the present as simulation time 0."""
        self._start_ns = self.wall.monotonic_ns()

    def deadline_ns(self, sim_ns: int) -> int:
        """Monotonic time at which ``sim_ns`` is due."""
        return self._start_ns + int(sim_ns / self.rate)

    def wait(self, sim_ns: int) -> int:
        """Sleep until ``sim_ns`` is due; returns the lateness in ns (0 in lockstep)."""
        if not self.rate:
            return 0
        deadline_ns = self.deadline_ns(sim_ns)
        while True:
            remaining_ns = deadline_ns - self.wall.monotonic_ns()
            if remaining_ns <= 0:
                return -remaining_ns
            self.wall.sleep(remaining_ns / 1e9)
