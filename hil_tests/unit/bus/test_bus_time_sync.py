"""Simulation time from the bus: TIME_SYNC, and outages of the whole bus."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.support.bus_clock import POLL_TICKS, TELEGRAMS, TICK_NS, started
from railhil.bus.clock import BusClock, from_time_sync, rate_to_10th, to_time_sync
from railhil.bus.telegrams import TimeSync


@given(
    st.sampled_from([1_000_000, 2_000_000, 5_000_000, 10_000_000, 16_000_000, 20_000_000, 33_333_333, 500_000_000]),
    st.integers(0, 3_600_000),
)
def test_time_sync_round_trip_for_an_hour(base_tick_ns: int, tick: int) -> None:
    tick = min(tick, 3_600_000_000_000 // base_tick_ns)
    telegram = to_time_sync(tick, base_tick_ns, life=tick & 15)
    assert from_time_sync(type(telegram).decode(telegram.encode()), base_tick_ns) == tick
    stated_s = telegram.seconds_s + telegram.fraction_65536th_s / 65536
    assert stated_s == pytest.approx(tick * base_tick_ns / 1e9, abs=0.5 / 65536 + 1e-9)


@pytest.mark.parametrize("base_tick_ns", [10_000_000, 16_000_000])
@pytest.mark.parametrize("target", [41, 47, 48, 128, 359_999])
def test_resynchronisation(base_tick_ns: int, target: int) -> None:
    """Ahead at once as far as life signs can bridge, further when the next TIME_SYNC confirms it."""
    clock = started(40, base_tick_ns)
    taken = clock.synchronise(to_time_sync(target, base_tick_ns, life=3))
    assert taken == (target <= 47)
    if not taken:
        assert (clock.tick, clock.counters) == (40, {"time_ahead": 1})
        assert clock.feed(TELEGRAMS[41 % 16])
        target += 1
        assert clock.synchronise(to_time_sync(target, base_tick_ns, life=4))
    assert clock.now_ns == target * base_tick_ns
    # The frame of that tick may have been lost or not: the next one is one tick later in both cases.
    assert clock.feed(TELEGRAMS[42 % 16])
    assert clock.tick == target + 1


@pytest.mark.parametrize(
    ("telegram", "cause"),
    [
        (to_time_sync(40, TICK_NS, life=5), "time_duplicate"),
        (to_time_sync(40, TICK_NS, life=4), "time_out_of_order"),
        (to_time_sync(40, TICK_NS, life=13), "time_out_of_order"),
        (to_time_sync(40, TICK_NS, life=6, check=0), "time_check"),
        (to_time_sync(39, TICK_NS, life=6), "time_backward"),
        (to_time_sync(0, TICK_NS, life=12), "time_backward"),
        (to_time_sync(48, TICK_NS, life=6), "time_ahead"),
    ],
)
def test_an_implausible_time_sync_is_refused_and_counted(telegram: TimeSync, cause: str) -> None:
    clock = started(40)
    assert clock.synchronise(to_time_sync(40, TICK_NS, life=5, rate_10th=10))
    telegram.rate_10th = 0
    assert not clock.synchronise(telegram)
    assert (clock.tick, clock.rate, clock.counters) == (40, 1.0, {cause: 1})
    assert clock.feed(TELEGRAMS[41 % 16])
    assert clock.tick == 41
    # What was refused has taken no life sign from the next right one.
    assert clock.synchronise(to_time_sync(41, TICK_NS, life=6))


@pytest.mark.parametrize(
    ("second", "taken"),
    [
        (to_time_sync(1128, TICK_NS, life=1), True),
        (to_time_sync(1135, TICK_NS, life=1), True),
        (to_time_sync(1136, TICK_NS, life=1), False),
        (to_time_sync(1000, TICK_NS, life=1), False),
        (to_time_sync(1128, TICK_NS, life=2), False),
    ],
)
def test_only_the_next_time_sync_confirms_a_time_far_ahead(second: TimeSync, taken: bool) -> None:
    clock = started(40)
    assert not clock.synchronise(to_time_sync(1000, TICK_NS, life=0))
    for tick in range(41, 169):
        clock.feed(TELEGRAMS[tick % 16])
    assert clock.synchronise(second) == taken
    assert clock.tick == (from_time_sync(second, TICK_NS) if taken else 168)


def test_the_estimate_of_an_outage_is_corrected_but_not_to_before_it() -> None:
    clock = started(40)
    assert clock.synchronise(to_time_sync(40, TICK_NS, life=0, rate_10th=10))
    clock.silence(2_000_000_000)
    clock.silence(1_000_000_000)
    assert clock.tick == 340
    assert not clock.synchronise(to_time_sync(40, TICK_NS, life=1, rate_10th=10))
    assert clock.synchronise(to_time_sync(128, TICK_NS, life=1, rate_10th=10))
    assert clock.tick == 128
    assert not clock.synchronise(to_time_sync(127, TICK_NS, life=2, rate_10th=10))


@pytest.mark.parametrize("lost", [[], [128], [127, 128], [126, 127, 128], [0], [0, 128]])
def test_loss_of_the_clock_frame_of_a_time_sync_tick(lost: list[int]) -> None:
    clock = BusClock(TICK_NS, 1)
    for tick in range(300):
        if tick not in lost:
            clock.feed(TELEGRAMS[tick % 16])
        if tick % 128 == 0:
            clock.synchronise(to_time_sync(tick, TICK_NS, life=tick // 128))
        if tick not in lost:
            assert clock.tick == tick


@pytest.mark.parametrize("first", [110, 111, 118, 127])
@pytest.mark.parametrize("count", [2, 4, 5, 20, 33])
def test_burst_loss_across_a_time_sync(first: int, count: int) -> None:
    clock = BusClock(TICK_NS, 1)
    for tick in range(300):
        lost = first <= tick < first + count
        if not lost:
            clock.feed(TELEGRAMS[tick % 16])
        if tick % 128 == 0:
            clock.synchronise(to_time_sync(tick, TICK_NS, life=tick // 128))
        if tick % POLL_TICKS == 0:
            clock.polled(POLL_TICKS)
            assert clock.tick == tick
        if tick > first + count + 1:
            assert clock.tick == tick


def test_joining_late_takes_the_time_that_two_time_syncs_agree_on() -> None:
    clock = BusClock(TICK_NS, 1)
    for tick in range(1000, 1300):
        clock.feed(TELEGRAMS[tick % 16])
        if tick % 128 == 0:
            clock.synchronise(to_time_sync(tick, TICK_NS, life=tick // 128))
        assert clock.is_set is (tick >= 1152)
        if tick >= 1152:
            assert clock.tick == tick
        # Nothing that was heard before the leap is older for it.
        assert clock.own_ns == (tick - 1000) * TICK_NS


def test_a_leap_of_a_clock_that_knew_the_time_is_time_that_has_passed() -> None:
    """The whole bus was silent."""
    clock = started(40)
    assert clock.synchronise(to_time_sync(40, TICK_NS, life=0))
    for tick in (1024, 1025):
        clock.feed(TELEGRAMS[tick % 16])
    assert not clock.synchronise(to_time_sync(1024, TICK_NS, life=1))
    assert clock.synchronise(to_time_sync(1025, TICK_NS, life=2))
    assert clock.now_ns == clock.own_ns == 1025 * TICK_NS


@pytest.mark.parametrize("lost", [1, 6, 7])
def test_frames_lost_before_the_first_time_sync_are_time_that_has_passed(lost: int) -> None:
    clock = started(40)
    assert clock.synchronise(to_time_sync(40 + lost, TICK_NS, life=0))
    assert clock.now_ns == clock.own_ns == (40 + lost) * TICK_NS


def test_pace_in_tenths() -> None:
    assert [rate_to_10th(rate) for rate in (0.0, 0.01, 0.1, 1.0, 25.5, 100.0)] == [0, 1, 1, 10, 255, 255]


def test_silence_goes_on_at_the_pace_of_the_run() -> None:
    clock = started(3)
    clock.silence(95_000_000)
    # In lockstep the time stands still while nothing can be heard.
    assert clock.tick == 3
    clock.synchronise(to_time_sync(3, TICK_NS, rate_10th=20))
    clock.silence(94_999_999)
    assert (clock.tick, clock.now_ns) == (3 + 18, 21 * TICK_NS)
    new = BusClock(TICK_NS, 1)
    new.silence(1_000_000_000)
    assert (new.tick, new.running) == (0, False)


def test_times_of_time_sync_at_the_end_of_their_range() -> None:
    """TIME_SYNC counts seconds in 32 bits."""
    assert to_time_sync(10**6, TICK_NS) == TimeSync(10**4, 0)
    assert from_time_sync(TimeSync(4 * 10**9, 0), TICK_NS) == 4 * 10**11
    # 4 and 6 ms: the nearest tick.
    assert [from_time_sync(TimeSync(0, fraction), TICK_NS) for fraction in (262, 393)] == [0, 1]


@pytest.mark.parametrize("ahead", [1, 7])
def test_a_time_sync_between_a_poll_and_lost_frames(ahead: int) -> None:
    """The life sign of the clock frames continues from its last value, also from 0."""
    clock = started(0)
    clock.polled(POLL_TICKS)
    assert clock.synchronise(to_time_sync(ahead, TICK_NS, life=0)) is True
    assert not clock.feed(TELEGRAMS[ahead])
    assert clock.tick == ahead
    assert clock.feed(TELEGRAMS[ahead + 1])
    assert clock.tick == ahead + 1


def test_after_a_time_sync_polls_count_from_it() -> None:
    clock = started(0)
    # Without a poll nobody knows whether the clock frame of this tick was lost.
    assert clock.synchronise(to_time_sync(2, TICK_NS, life=0))
    clock.polled(4)
    assert clock.tick == 4
    clock = started(0)
    assert clock.synchronise(to_time_sync(2, TICK_NS, life=0))
    clock.polled(2)
    assert clock.synchronise(to_time_sync(5, TICK_NS, life=1))
    clock.polled(2)
    assert clock.tick == 6
    # Also after one from far ahead.
    clock = started(0)
    clock.polled(2)
    assert not clock.synchronise(to_time_sync(1000, TICK_NS, life=0))
    assert clock.synchronise(to_time_sync(1000, TICK_NS, life=1))
    clock.polled(30)
    assert clock.tick == 1020


@pytest.mark.parametrize("begins", [0, 40])
@pytest.mark.parametrize("silent", [True, False])
def test_an_outage_in_parts_is_one_estimate(begins: int, silent: bool) -> None:
    """By the wall clock, or by the node's own timer."""
    clock = started(begins)
    assert clock.synchronise(to_time_sync(begins, TICK_NS, life=0, rate_10th=10))
    outage = clock.silence if silent else clock.elapsed
    outage(2_009_999_999)
    outage(1_000_000_000)
    assert (clock.tick, clock.now_ns) == (begins + 300, (begins + 300) * TICK_NS)
    assert not clock.synchronise(to_time_sync(begins, TICK_NS, life=1, rate_10th=10))
    assert clock.synchronise(to_time_sync(begins + 50, TICK_NS, life=1, rate_10th=10))
    assert clock.tick == begins + 50
    # From then on it is no estimate.
    assert not clock.synchronise(to_time_sync(begins + 49, TICK_NS, life=2, rate_10th=10))


def test_without_an_outage_no_time_sync_leads_back() -> None:
    clock = started(40)
    assert not clock.synchronise(to_time_sync(39, TICK_NS, life=0))
    clock.elapsed(10**9)
    assert not clock.synchronise(to_time_sync(40, TICK_NS, life=0))
    assert clock.synchronise(to_time_sync(41, TICK_NS, life=0))
