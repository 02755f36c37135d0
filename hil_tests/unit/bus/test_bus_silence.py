"""A silence of the whole bus that no interface reports: what a node's clock makes of it from the telegrams after it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.bus.clock import BusClock, to_time_sync
from railhil.bus.frame import Frame
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.responder import Responder, slow_port
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import TimeSync
from railhil.dbc import wire_contract
from railhil.wire.ato import NotchCmd, PltStat, TrkInfo, TrnPos, TrnSpeed

TICK_NS = 10_000_000
SCHEDULE = Schedule.from_contract(TICK_NS, {}, wire_contract())
SINKS = [kind.port() for kind in (TrnSpeed, TrnPos, TimeSync, PltStat, TrkInfo)]
#: Ticks from one telegram of the slow port to the next, and from one TIME_SYNC to the next.
SLOW, SYNC = SCHEDULE.ticks(PltStat.PORT), SCHEDULE.ticks(TimeSync.PORT)


class Bus:
    """The plant's telegrams of the clock, in time, and the node's polls."""

    def __init__(self) -> None:
        self.node = Responder(1, SCHEDULE, SINKS, {NotchCmd.PORT: NotchCmd}, contract=wire_contract())
        self._sources = {kind: TelegramSource(kind.port()) for kind in (TrnSpeed, PltStat, TimeSync)}
        self._poll = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)

    def frames(self, tick: int) -> Iterator[Frame]:
        yield from self.of(TrnSpeed(1, life=tick % 16))
        if tick % SLOW == 0:
            yield from self.of(PltStat(life=tick // SLOW % 16))
        if tick % SYNC == 0:
            yield from self.of(to_time_sync(tick, TICK_NS, life=tick // SYNC % 16))
        if tick % 2 == 0:
            yield self._poll

    def of(self, telegram: Telegram) -> list[Frame]:
        return self._sources[type(telegram)].frames(telegram.encode())

    def go(self, ticks: range) -> None:
        for tick in ticks:
            for frame in self.frames(tick):
                self.node.handle(frame)


def test_the_slow_port_is_the_slowest_with_a_life_sign_of_four_bits() -> None:
    clock_port = wire_contract().clock_port
    assert slow_port(SINKS, clock_port, SCHEDULE) == PltStat.port()
    assert slow_port([TrnSpeed.port(), TrkInfo.port(), TimeSync.port()], clock_port, SCHEDULE) is None
    fast = Schedule.from_contract(TICK_NS, {PltStat.PORT: TICK_NS}, wire_contract())
    assert slow_port(SINKS, clock_port, fast) == TrnPos.port()


@settings(max_examples=150, deadline=None)
@given(start=st.integers(1, 600), silent=st.integers(1, 11 * SLOW), second=st.integers(1, 11 * SLOW))
def test_up_to_eleven_periods_of_the_slow_port_are_counted(start: int, silent: int, second: int) -> None:
    """At the second telegram of the slow port after it, or at TIME_SYNC; and another silence after that."""
    bus, end = Bus(), start + silent
    bus.go(range(start))
    bus.go(range(end, end + 2 * SLOW + 2))
    assert bus.node.clock.tick == end + 2 * SLOW + 1
    start, end = end + 2 * SLOW + 2, end + 2 * SLOW + 2 + second
    bus.go(range(end, end + 2 * SLOW + 2))
    assert bus.node.clock.tick == end + 2 * SLOW + 1


@pytest.mark.parametrize("silent", [12 * SLOW, 200, 500, 800, 2500])
def test_a_longer_silence_is_counted_by_time_sync(silent: int) -> None:
    bus, end = Bus(), 300 + silent
    bus.go(range(300))
    bus.go(range(end, end + 2 * SYNC + 1))
    assert bus.node.clock.tick == end + 2 * SYNC


@pytest.mark.parametrize("life", range(16))
def test_one_wrong_life_sign_of_the_slow_port_changes_nothing(life: int) -> None:
    bus = Bus()
    bus.go(range(7 * SLOW))
    for tick in range(7 * SLOW, 400):
        # In the place of the right one.
        wrong = bus.of(PltStat(life=life)) if tick == 7 * SLOW else []
        right = [one for one in bus.frames(tick) if not wrong or one.can_id != PltStat.port().address]
        for frame in [*right, *wrong]:
            bus.node.handle(frame)
        assert bus.node.clock.tick == tick


@pytest.mark.parametrize("late", [1, 15, 16, 17, 48, 160])
def test_a_late_slow_port_changes_nothing(late: int) -> None:
    """All its telegrams come late from some instant on, by a turn of the clock port's life sign, too."""
    bus = Bus()
    bus.go(range(100))
    held: dict[int, list[Frame]] = {}
    for tick in range(100, 700):
        for frame in bus.frames(tick):
            if frame.can_id == PltStat.port().address:
                held.setdefault(tick + late, []).append(frame)
            else:
                bus.node.handle(frame)
        for frame in held.pop(tick, []):
            bus.node.handle(frame)
        assert bus.node.clock.tick == tick


def test_time_sync_takes_back_what_a_forged_slow_port_has_told() -> None:
    bus = Bus()
    bus.go(range(SYNC + 10))
    at = SYNC + SLOW
    bus.go(range(SYNC + 10, at))
    for tick in range(at, at + SLOW + 1):
        forged = bus.of(PltStat(life=12 + (tick - at) // SLOW)) if tick % SLOW == 0 else []
        for frame in [*(one for one in bus.frames(tick) if one.can_id != PltStat.port().address), *forged]:
            bus.node.handle(frame)
    assert bus.node.clock.tick == at + SLOW + 3 * SLOW
    bus.go(range(at + SLOW + 1, 2 * SYNC + 1))
    assert bus.node.clock.tick == 2 * SYNC


def test_no_estimate_without_a_silence() -> None:
    """A time in the past is refused as ever: there is nothing to take back."""
    bus = Bus()
    bus.go(range(100))
    assert not bus.node.clock.synchronise(to_time_sync(98, TICK_NS, life=1))
    assert bus.node.clock.tick == 99
    assert bus.node.store.counters == {"time_backward": 1}


@pytest.mark.parametrize(
    ("frame_ticks", "ahead", "since", "follows"),
    [(2, 32, 16, True), (2, 16, 16, False), (2, 32, 64, True), (2, 32, 80, False), (2, 160, 64, True),
     (1, 176, 16, True), (1, 192, 16, False), (1, 16, 48, True), (1, 16, 64, False)],
)  # fmt: skip
def test_where_the_clock_follows_the_slow_port(frame_ticks: int, ahead: int, since: int, follows: bool) -> None:
    """16 ticks from one slow telegram to the next: whole turns of 16 frames, if both telegrams come within 48 ticks and
    a turn of the last right one, and less than what is left of 256."""
    clock = BusClock(TICK_NS, frame_ticks)
    clock.feed(TrnSpeed(0, life=0).encode())
    clock.slow(0, 16, 0)
    for number in range(2):
        at_tick = since + 16 * number
        clock.slow((ahead + at_tick) // 16 % 16, 16, at_tick * TICK_NS)
    assert clock.tick == (ahead if follows else 0)
