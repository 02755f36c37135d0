"""A silence of the whole bus that no interface reports: what a node's clock makes of it from the telegrams after it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.bus.clock import to_time_sync
from railhil.bus.frame import Frame
from railhil.bus.layout import Telegram
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.responder import Responder, slow_port
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import NotchCmd, PltStat, TimeSync, TrkInfo, TrnPos, TrnSpeed
from railhil.dbc import wire_contract

TICK_NS = 10_000_000
SCHEDULE = Schedule.from_contract(TICK_NS, {})
SINKS = [kind.port() for kind in (TrnSpeed, TrnPos, TimeSync, PltStat, TrkInfo)]
#: Ticks from one telegram of the slow port to the next, and from one TIME_SYNC to the next.
SLOW, SYNC = SCHEDULE.ticks(PltStat.PORT), SCHEDULE.ticks(TimeSync.PORT)


class Bus:
    """The plant's telegrams of the clock, in time, and the node's polls."""

    def __init__(self) -> None:
        self.node = Responder(1, SCHEDULE, SINKS, {NotchCmd.PORT: NotchCmd})
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
    fast = Schedule.from_contract(TICK_NS, {PltStat.PORT: TICK_NS})
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
