"""Ramps, ages, sums and counters over time lose nothing to rounding, whatever tick and periods a scenario has."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import accumulate

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.bus.clock import BusClock
from railhil.bus.schedule import Schedule
from railhil.bus.sdt import SAFE_DATA_VERSION, SafeSource, source_identity
from railhil.controller_node.ato.guard import Guard
from railhil.controller_node.ato.plausibility import Motion, MotionLimits
from railhil.controller_node.ato.safe_speed import SafeSpeed
from railhil.controller_node.ato.speed_monitors import CHANNEL_WINDOW_MS, Debt
from railhil.controller_node.ato.speed_watch import Ladder
from railhil.dbc import wire_contract
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Safety
from railhil.wire.ato import NotchCmd, SpeedSdt, TrnSpeed, WatchLevel

SCENARIO = load("lvshun_tieshan")
S = 1_000_000_000
#: Steps of time from one poll to the next, ns: every period that the schema allows, from a nanosecond on.
STEPS_NS = st.lists(
    st.one_of(st.integers(1, 10**10), st.integers(1, 2_000_000), st.integers(1, 1000).map(lambda ms: ms * 10**6)),
    min_size=1,
    max_size=60,
)


@given(steps_ns=STEPS_NS, since_ns=st.integers(0, 10**14), ramp=st.integers(1, 10**6))
def test_many_short_ramps_go_as_far_as_one(steps_ns: list[int], since_ns: int, ramp: int) -> None:
    ladder = Ladder.of(SCENARIO)._replace(ramp_code_per_s=ramp)
    at_ns = list(accumulate(steps_ns, initial=since_ns))
    gone = sum(map(ladder.ramp_codes, at_ns, at_ns[1:]))
    assert abs(gone - Fraction(ramp * sum(steps_ns), S)) < 1


@settings(max_examples=60, deadline=None)
@given(
    period_ns=st.one_of(st.integers(1, 50_000_000), st.integers(1, 50).map(lambda ms: ms * 10**6)),
    notches=st.integers(1, 254),
)
def test_the_service_brake_builds_up_and_goes_at_the_same_pace_with_every_period(period_ns: int, notches: int) -> None:
    """Also for a train of one notch, and with polls so often that a code needs many of them."""
    train = SCENARIO.train
    force_n = train.force_per_notch_n * train.notch_max / notches
    timing = replace(SCENARIO.timing, base_tick_ns=period_ns, port_period_ns={NotchCmd.PORT: period_ns})
    train = replace(train, notch_max=float(notches), force_per_notch_n=force_n)
    scenario = replace(SCENARIO, train=train, timing=timing)
    ladder, guard = Ladder.of(scenario), Guard(scenario)
    start_ns = 10 * S
    guard.speed(TrnSpeed(0), start_ns)
    assert guard.notch(0, start_ns) == (0, False)
    # Service brake from here on. Of very many polls some are left out.
    guard.wait(True)
    build_up_ns = ladder.service_code * S // ladder.ramp_code_per_s
    polls = range(1, build_up_ns // period_ns + 2)
    for poll in [*polls[:: max(1, len(polls) // 300)], polls[-1]]:
        now_ns = start_ns + poll * period_ns
        code, _ = guard.notch(0, now_ns)
        assert guard.level is WatchLevel.SERVICE_BRAKE
        exact = Fraction(ladder.ramp_code_per_s * (now_ns - start_ns), S)
        assert abs(-code - min(exact, ladder.service_code)) < 1


@given(lags=st.lists(st.integers(0, 2), max_size=60))
def test_a_clock_that_is_behind_at_some_polls_makes_no_step_of_the_ramp_larger(lags: list[int]) -> None:
    """The node tells its time by TRN_SPEED, which may be late; the polls come in time."""
    ladder, guard = Ladder.of(SCENARIO), Guard(SCENARIO)
    poll_ns, start_ns, now_ns, before = 20_000_000, 10 * S, 0, 0
    step = ladder.ramp_codes(0, poll_ns)
    guard.wait(True)
    for poll, lag in enumerate([*[0] * 60, *lags]):
        now_ns = max(now_ns, start_ns + poll * poll_ns - lag * 10_000_000)
        for life in (2 * poll, 2 * poll + 1):
            guard.speed(TrnSpeed(100_000 + life % 2, life=life % 16), now_ns)
        if poll == 50:
            guard.wait(False)
        code, _ = guard.notch(1792, now_ns)
        if guard.level is WatchLevel.NORMAL:
            assert step <= code - before <= step + 1
        before = code
    assert guard.level is WatchLevel.NORMAL


@given(
    steps_ns=st.lists(st.integers(100_000_000, 900_000_000), min_size=1, max_size=40),
    speed=st.integers(5_000, 300_000),
    resistance=st.integers(1_000, 20_000),
)
def test_sums_of_the_motion_are_those_of_the_whole_time(steps_ns: list[int], speed: int, resistance: int) -> None:
    limits = MotionLimits.of(SCENARIO)._replace(davis_a=resistance, davis_b_q20=0, davis_c_q40=0)
    motion, now_ns = Motion(limits), 7 * S + 123_456
    motion.sample(now_ns, speed, 0, None, 0, None)
    since_ms = now_ns // 10**6
    for step_ns in steps_ns:
        now_ns += step_ns
        motion.sample(now_ns, speed, 0, None, 0, None)
    elapsed_ms = now_ns // 10**6 - since_ms
    # The reading stands still while the resistance should have changed it.
    assert motion._due == -resistance * elapsed_ms
    assert motion._way == 2 * speed * elapsed_ms


@given(permitted=st.integers(1, 10_000), more=st.integers(1, 3))
def test_as_many_bad_telegrams_are_permitted_as_are_said(permitted: int, more: int) -> None:
    debt = Debt(CHANNEL_WINDOW_MS, CHANNEL_WINDOW_MS * permitted, permitted)
    assert not any(debt.add(0) for _ in range(permitted))
    assert all(debt.add(0) for _ in range(more))
    # A whole window later all of them are paid.
    assert not debt.add(2 * CHANNEL_WINDOW_MS)


@given(steps_ns=STEPS_NS, tick_ns=st.integers(1, 50_000_000))
def test_many_short_silences_are_as_long_as_one(steps_ns: list[int], tick_ns: int) -> None:
    clock = BusClock(tick_ns, 1)
    clock.feed(TrnSpeed(0, life=0).encode())
    for step_ns in steps_ns:
        clock.elapsed(step_ns)
    assert clock.tick == sum(steps_ns) // tick_ns


@pytest.mark.parametrize("late_percent", [0, 30, 60, 90])
def test_a_late_safe_telegram_does_not_take_the_time_of_a_lost_one(late_percent: int) -> None:
    """As many lost as the channel does not tolerate, after a late one: it begins anew, however late that one was."""
    scenario = replace(SCENARIO, safety=Safety(sdt=True))
    safe, source = SafeSpeed(scenario), SafeSource(source_identity(SpeedSdt.port().address), SAFE_DATA_VERSION)
    timing = scenario.timing
    period_ns = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, wire_contract()).ticks(SpeedSdt.PORT)
    period_ns *= timing.base_tick_ns
    confirmed = []
    for number in range(12 + scenario.safety.n_rxsafe):
        telegram = SpeedSdt.decode(source.secured(SpeedSdt(0).encode()))
        if not 10 < number <= 10 + scenario.safety.n_rxsafe:
            late_ns = late_percent * period_ns // 100 if number == 10 else 0
            safe.take(telegram, number * period_ns + late_ns, None, 0)
            confirmed.append(safe.accepted)
    assert confirmed == [0, *range(1, 11), 10]
