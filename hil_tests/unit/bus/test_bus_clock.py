"""Simulation time from the bus: clock frames, polls, and pacing."""

from __future__ import annotations

import pytest

from hil_tests.support.bus_clock import POLL_TICKS, TELEGRAMS, TICK_NS, started
from hil_tests.support.clock import SetClock
from railhil.bus.clock import BusClock, Pacer, to_time_sync
from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.mvb import TelegramSource
from railhil.bus.responder import Responder
from railhil.bus.schedule import Schedule
from railhil.dbc import wire_contract
from railhil.wire.ato import NotchCmd, TrnSpeed


def frame_of(tick: int, *, fd: bool = False) -> Frame:
    return TelegramSource(TrnSpeed.port(), fd).frames(TrnSpeed(123, life=tick % 16).encode())[0]


def listener() -> Responder:
    """A node that sinks the clock port alone."""
    return Responder(
        1, Schedule.from_contract(TICK_NS, {}, wire_contract()), [TrnSpeed.port()], {}, contract=wire_contract()
    )


@pytest.mark.parametrize("fd", [False, True])
def test_every_clock_frame_is_one_tick(fd: bool) -> None:
    node, alone = listener(), listener()
    clock = node.clock
    for tick in range(100):
        assert node.opens_tick(frame_of(tick, fd=fd))
        alone.handle(frame_of(tick, fd=fd))
        assert alone.clock.tick == tick
        assert clock.tick == tick


@pytest.mark.parametrize("start", [0, 7, 8, 15])
def test_lost_ticks_are_bridged_by_the_life_sign(start: int) -> None:
    """Without any poll: up to six at once, more as soon as a second frame confirms that the first was no old one."""
    for lost in range(1, 14):
        clock = started(start)
        first = start + lost + 1
        assert clock.feed(TELEGRAMS[first % 16]) == (lost <= 6)
        clock.feed(TELEGRAMS[(first + 1) % 16])
        assert clock.tick == first + 1
        assert clock.feed(TELEGRAMS[(first + 2) % 16])
        assert clock.tick == first + 2


def run(clock: BusClock, ticks: range, lost: range) -> list[int]:
    """Frames (but the lost ones) and a poll every second tick; the clock's tick after each tick."""
    seen = []
    for tick in ticks:
        if tick not in lost:
            clock.feed(TELEGRAMS[tick % 16])
        if tick % POLL_TICKS == 0:
            clock.polled(POLL_TICKS)
        seen.append(clock.tick)
    return seen


@pytest.mark.parametrize("start", [10, 11, 24, 25])
def test_polls_carry_time_through_any_loss_of_the_clock_port(start: int) -> None:
    for lost in (*range(1, 40), 127, 1000):
        end = start + lost
        seen = run(BusClock(TICK_NS, 1), range(end + 4), range(start, end))
        assert seen[:start] == list(range(start))
        # While frames are missing the clock stands at the last poll, never ahead.
        assert seen[start:end] == [tick - tick % POLL_TICKS for tick in range(start, end)]
        # Fifteen lost frames (modulo sixteen) look like a repeated one; the second frame is enough.
        assert seen[end + 1 :] == list(range(end + 1, end + 4))


@pytest.mark.parametrize("copies", [1, 2])
def test_repeated_polls_never_run_away(copies: int) -> None:
    clock = BusClock(TICK_NS, 1)
    for tick in range(400):
        clock.feed(TELEGRAMS[tick % 16])
        if tick % POLL_TICKS == 0:
            for _ in range(1 + copies):
                clock.polled(POLL_TICKS)
        assert tick <= clock.tick <= tick + copies * POLL_TICKS


def test_polls_before_the_first_frame_are_no_time() -> None:
    clock = BusClock(TICK_NS, 1)
    for _ in range(10):
        clock.polled(POLL_TICKS)
    assert (clock.running, clock.tick, clock.own_ns, clock.is_set) == (False, 0, 0, False)


@pytest.mark.parametrize("lost", [3, 5, 13, 255])
def test_the_second_poll_begins_the_time_of_a_node_that_is_polled_in_a_run_only(lost: int) -> None:
    """Counted from the first one; where the ticks before the first frame are odd in number, it is that of the run."""
    clock = BusClock(TICK_NS, 1)
    for tick in range(0, lost, POLL_TICKS):
        clock.polled(POLL_TICKS, begins=True)
        assert (clock.running, clock.tick, clock.own_ns, clock.is_set) == (tick > 0, tick, tick * TICK_NS, False)
        assert not clock.is_regular
    for tick in range(lost, lost + 40):
        assert clock.feed(TELEGRAMS[tick % 16])
        assert clock.tick == tick
        if tick % POLL_TICKS == 0:
            clock.polled(POLL_TICKS, begins=True)
            assert clock.tick == tick


def test_a_clock_frame_after_the_first_poll_begins_the_time() -> None:
    """It is of the tick of the poll or of the next one."""
    for polls_after in (0, 1):
        polled, other = BusClock(TICK_NS, 1), BusClock(TICK_NS, 1)
        polled.polled(POLL_TICKS, begins=True)
        for clock in (polled, other):
            assert clock.feed(TELEGRAMS[9])
            for _ in range(polls_after):
                clock.polled(POLL_TICKS, begins=True)
            assert (clock.tick, clock.polled_tick) == (0, 0 if polls_after else -1)
        assert slots_of(polled) == slots_of(other)


def test_a_node_that_hears_polls_alone_takes_the_time_that_two_time_sync_tell() -> None:
    clock = BusClock(TICK_NS, 1)
    for tick in range(1500, 1500 + 300):
        if tick % 128 == 0:
            assert clock.synchronise(to_time_sync(tick, TICK_NS, life=tick // 128 % 16)) == (tick >= 1664)
            assert clock.is_set == (tick >= 1664)
        if tick % POLL_TICKS == 0:
            clock.polled(POLL_TICKS, begins=True)
    # The instant of the run; and its own time, in which the poll of the tick of TIME_SYNC had not come yet.
    assert (clock.tick, clock.own_ns) == (1798, (298 - POLL_TICKS) * TICK_NS)


@pytest.mark.parametrize("back", range(1, 8))
def test_repeated_and_old_frames_open_no_tick(back: int) -> None:
    clock = started(40)
    assert not clock.feed(TELEGRAMS[40 % 16])
    assert not clock.feed(TELEGRAMS[(40 - back) % 16])
    assert clock.tick == 40
    assert clock.feed(TELEGRAMS[41 % 16])
    assert clock.tick == 41


def test_stuck_clock_frames_do_not_stop_time() -> None:
    clock = started(40)
    for tick in range(40, 200):
        clock.feed(TELEGRAMS[40 % 16])
        if tick % POLL_TICKS == 0:
            clock.polled(POLL_TICKS)
    assert clock.tick == 198


def changed(frame: Frame, byte: int, mask: int = 1) -> Frame:
    data = bytearray(frame.data)
    data[byte] ^= mask
    return frame._replace(data=bytes(data))


def test_frames_that_fail_a_check_are_no_time() -> None:
    right, fd = frame_of(1), frame_of(1, fd=True)
    for frame in (
        *(changed(right, byte, 1 << bit) for byte in range(8) for bit in range(8)),
        right._replace(data=right.data[:7]),
        right._replace(data=right.data + b"\0"),
        *(right._replace(flags=flags) for flags in (ERROR, REMOTE, EXTENDED, FD, BRS)),
        *(fd._replace(flags=flags) for flags in (0, FD | EXTENDED, FD | ERROR)),
        # A right telegram of another port under the clock's identifier.
        TelegramSource(NotchCmd.port()).frames(NotchCmd(life=1).encode())[0]._replace(can_id=TrnSpeed.port().address),
        right._replace(can_id=0x110),
    ):
        node, other = listener(), listener()
        assert not node.opens_tick(frame), frame
        assert not node.clock.running
        assert not node.store.counters
        other.handle(frame)
        assert not other.clock.running
        assert sum(other.store.counters.values()) == 1


@pytest.mark.parametrize("rate", [0.5, 1.0, 10.0])
def test_pacer_deadlines_are_absolute(rate: float) -> None:
    wall = SetClock(5_000, oversleep_ns=70_000)
    pacer = Pacer(rate, wall)
    pacer.start()
    late_ns = []
    for tick in range(200):
        late_ns.append(pacer.wait(tick * TICK_NS))
        # Work that takes a third of a tick, and once far longer than one.
        wall.now_ns += int(TICK_NS / rate / 3) if tick != 50 else int(4.5 * TICK_NS / rate)
    # Nothing accumulates: the deadlines are those of the start, whatever the sleeps did.
    assert late_ns[:51] == [0, *[70_000] * 50]
    assert late_ns[51] == pytest.approx(3.5 * TICK_NS / rate + 70_000, abs=2)
    assert late_ns[60:] == [70_000] * 140
    assert pacer.deadline_ns(199 * TICK_NS) == 5_000 + int(199 * TICK_NS / rate)


def test_pacer_in_lockstep_never_waits() -> None:
    wall = SetClock(5_000)
    assert Pacer(0.0, wall).wait(10**12) == 0
    assert wall.now_ns == 5_000


def test_a_frame_that_looks_old_is_confirmed_by_the_next_one_only() -> None:
    clock = started(0)
    assert not clock.feed(TELEGRAMS[10])
    for life in (1, 2, 3):
        assert clock.feed(TELEGRAMS[life])
    # It would have been the next one of the first.
    assert not clock.feed(TELEGRAMS[11])
    assert clock.tick == 3


def test_after_lost_frames_no_old_frame_is_confirmed() -> None:
    clock = started(0)
    assert not clock.feed(TELEGRAMS[10])
    assert clock.feed(TELEGRAMS[2])
    assert not clock.feed(TELEGRAMS[11])
    assert clock.tick == 2
    clock = started(0)
    assert clock.feed(TELEGRAMS[5])
    assert not clock.feed(TELEGRAMS[0])
    assert clock.tick == 5


def test_a_lost_poll_is_made_good_by_the_clock_frames() -> None:
    clock = started(0)
    clock.polled(POLL_TICKS)
    # The poll of tick 2 is lost, then the clock frames of the ticks 5 and 6.
    for life in (1, 2, 3, 4):
        assert clock.feed(TELEGRAMS[life])
    clock.polled(POLL_TICKS)
    assert clock.tick == 4
    clock.polled(POLL_TICKS)
    assert clock.tick == 6


def test_frames_behind_the_polls_open_no_tick() -> None:
    clock = started(0)
    clock.polled(POLL_TICKS)
    clock.polled(POLL_TICKS)
    assert clock.tick == 2
    assert [clock.feed(TELEGRAMS[life]) for life in (1, 2, 3)] == [False, False, True]
    assert clock.tick == 3


def test_a_clock_port_that_opens_every_second_tick() -> None:
    clock = BusClock(TICK_NS, 2)
    assert [clock.feed(TELEGRAMS[life]) for life in (5, 6, 9)] == [True] * 3
    assert clock.tick == 8
    for _ in range(10):
        clock.polled(4)
    assert clock.tick == 8 + 36
    # 18 frames lost: nearest to the polls.
    assert clock.feed(TELEGRAMS[(9 + 19) % 16])
    assert clock.tick == 8 + 38
    # Life signs bridge seven frames: 14 ticks.
    assert not clock.synchronise(to_time_sync(46 + 15, TICK_NS, life=0))
    assert clock.counters == {"time_ahead": 1}
    clock.polled(2)
    assert clock.synchronise(to_time_sync(46 + 14, TICK_NS, life=0))
    # The clock frames have been missing since before the poll: their life sign continues.
    assert not clock.feed(TELEGRAMS[(9 + 19 + 7) % 16])
    assert clock.tick == 46 + 14


def slots_of(clock: BusClock) -> dict[str, object]:
    return {name: getattr(clock, name) for name in BusClock.__slots__ if name not in ("counters", "_sync_life")}


@pytest.mark.parametrize("ticks_per_frame", [1, 3])
@pytest.mark.parametrize("first", [0, 1, 14, 15])
@pytest.mark.parametrize("frames", [0, 1, 2, 17, 40])
def test_counted_frames_are_the_same_as_each_of_them(frames: int, first: int, ticks_per_frame: int) -> None:
    one, all_at_once = (BusClock(TICK_NS, ticks_per_frame) for _ in range(2))
    for polls in ((), (0,), (1,), (frames,), (), (0, frames)):
        for clock in (one, all_at_once):
            if not clock.running:
                clock.feed(TELEGRAMS[first])
            # As if an old frame had come before, and a poll in this tick.
            clock.feed(TELEGRAMS[(clock.life - 3) % 16])
        period = ticks_per_frame
        begun, begun_life, polled_tick = one.tick, one.life, -1
        # A second poll in a tick is no regular one.
        places = [place for place in polls if place <= frames and (place or one.polled_tick < begun)]
        for place in range(frames + 1):
            if place:
                assert one.feed(TELEGRAMS[(begun_life + place) % 16])
            if place in places:
                one.polled(period)
                polled_tick = one.tick
        assert one.is_regular
        assert polled_tick == (begun + places[-1] * ticks_per_frame if places else -1)
        all_at_once.count(frames, polled_tick)
        assert slots_of(all_at_once) == slots_of(one)
        assert (all_at_once.ticks_per_frame, all_at_once.is_regular) == (ticks_per_frame, True)
        assert all_at_once.polled_tick == (one.tick if polled_tick == one.tick or (not frames and one._polls) else -1)


def test_a_clock_is_regular_while_its_time_is_that_of_the_last_frame() -> None:
    clock = BusClock(TICK_NS, 1)
    assert not clock.is_regular
    assert clock.life == -1
    clock.feed(TELEGRAMS[5])
    assert clock.is_regular
    assert (clock.life, clock.polled_tick) == (5, -1)
    clock.polled(POLL_TICKS)
    assert (clock.is_regular, clock.polled_tick) == (True, 0)
    clock.polled(POLL_TICKS)
    assert not clock.is_regular
    assert (clock.tick, clock.polled_tick) == (POLL_TICKS, 0)


def test_nothing_elapses_before_the_first_frame() -> None:
    clock = BusClock(TICK_NS, 1)
    assert (clock.tick, clock.now_ns, clock.rate) == (0, 0, 0.0)
    clock.elapsed(10**9)
    assert (clock.tick, clock.now_ns, clock.running) == (0, 0, False)


def test_a_pacer_at_the_edges_of_its_deadlines() -> None:
    wall = SetClock(0)
    # Lockstep unless it is told a rate; before its start the clock's own 0 counts.
    assert Pacer(wall=wall).wait(10**12) == 0
    assert wall.now_ns == 0
    pacer = Pacer(1.0, wall)
    assert pacer.deadline_ns(5) == 5
    assert pacer.wait(1) == 0
    assert wall.now_ns == 1
    assert pacer.wait(10**11) == 0
    assert len(wall.slept_s) == 2
    assert pacer.wait(10**11 - 7) == 7
