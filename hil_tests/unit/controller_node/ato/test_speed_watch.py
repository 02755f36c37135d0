"""The controller's reaction ladder against a second, differently written model, and at every threshold."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.speed_seen import (
    BAD,
    GOOD,
    IMPLAUSIBLE,
    LADDER,
    NONE,
    SCENARIO,
    Seen,
    after,
    goods,
    ramp,
    run_commands,
)
from railhil.controller_node.ato.speed_watch import (
    LEVELS,
    Finding,
    Ladder,
    SpeedWatchState,
    command,
    observe,
    stronger,
)
from railhil.wire.ato import CtlCause, WatchLevel


class Reference:
    """The table of the ladder row by row, on a full history instead of counters."""

    def __init__(self) -> None:
        self.level = 0
        self.telegrams: list[bool] = []
        self.since_trouble = 0
        #: Whether the level was entered because the telegrams themselves are doubted.
        self.doubted = False

    def look(self, seen: Seen) -> int:
        if seen.telegram is not NONE:
            self.telegrams.append(seen.telegram is GOOD)
        bad = seen.telegram in (BAD, IMPLAUSIBLE)
        trouble = bad or seen.finding or seen.age_ms > 20
        self.since_trouble = 0 if trouble else self.since_trouble + (seen.telegram is GOOD)
        left = {
            0: True,
            1: self.since_trouble >= 1,
            2: self.since_trouble >= 5,
            3: (seen.standstill and not self.doubted) or self.since_trouble >= 10,
            4: False,
        }[self.level]
        counts = bad or (self.level == 3 and self.since_trouble < 5)
        rules = {
            1: seen.age_ms > 20 or bad,
            2: seen.age_ms > 64 or (counts and self.telegrams[-10:].count(False) >= 3),
            3: seen.age_ms > 256,
            4: seen.overspeed or (seen.age_ms > 1000 and not seen.standstill),
        }
        if seen.finding:
            rules[seen.finding.level] = True
        demanded = max([level for level, holds in rules.items() if holds], default=0)
        before, self.level = self.level, max(demanded, 0 if left else self.level)
        if self.level != before:
            by_finding = self.level == 3 and seen.age_ms <= 256 and seen.finding
            self.doubted = bool(by_finding) and seen.finding.cause.name in ("CHANNEL_MONITOR", "TWO_SOURCES")  # type: ignore[union-attr]
        return self.level


def cause_of(seen: Seen, level: int) -> CtlCause:
    """Why a level was entered: the strongest demand, the age of the speed before other causes."""
    if seen.overspeed:
        return CtlCause.OVERSPEED
    by_age = sum(seen.age_ms > limit for limit in (20, 64, 256)) + (seen.age_ms > 1000 and not seen.standstill)
    if by_age == level:
        # A bad telegram demands at most TRACTION_CUT, and is named only where the age is not that old.
        return CtlCause.SPEED_AGE
    if seen.finding and seen.finding.level == level:
        return seen.finding.cause
    return CtlCause.SPEED_IMPLAUSIBLE if seen.telegram is IMPLAUSIBLE else CtlCause.BAD_TELEGRAMS


RARELY = st.integers(0, 19).map(lambda x: x == 0)
#: Mostly good telegrams, with runs of silence and of bad ones.
EVENTS = st.lists(
    st.tuples(
        st.sampled_from([GOOD] * 12 + [BAD, IMPLAUSIBLE] + [NONE] * 4),
        st.sampled_from([1, 10, 10, 10, 16, 50, 200, 400]),
        RARELY,
        st.sampled_from([None] * 200 + list(LEVELS.values())),
        st.integers(0, 4).map(lambda x: x == 0),
        st.integers(-1792, 1792),
    ),
    max_size=120,
)


@pytest.mark.slow
@settings(deadline=None, max_examples=250)
@given(EVENTS)
def test_ladder_equals_the_reference(events: list[Any]) -> None:
    state, reference, age_ms = SpeedWatchState(), Reference(), 0
    for telegram, elapsed_ms, overspeed, finding, standstill, law_code in events:
        age_ms = 0 if telegram is GOOD else age_ms + elapsed_ms
        seen = Seen(age_ms, telegram, standstill, overspeed, finding)
        before = state
        state = observe(LADDER, state, *seen)
        assert state.level == reference.look(seen)
        if state.level > before.level and not (seen.finding and seen.telegram >= BAD):
            assert state.cause is cause_of(seen, state.level)
        state, code, emergency = command(LADDER, state, law_code, ramp(elapsed_ms))
        assert state.code == code
        _assert_safe(before, state, code, emergency, law_code, elapsed_ms)


def _assert_safe(
    before: SpeedWatchState, state: SpeedWatchState, code: int, emergency: bool, law_code: int, elapsed_ms: int
) -> None:
    """What each level promises about the notch, whatever came before."""
    last, level = before.code, state.level
    assert -LADDER.full_code <= code <= LADDER.full_code
    assert emergency == (level is WatchLevel.EMERGENCY)
    if before.level is WatchLevel.EMERGENCY and level is not WatchLevel.EMERGENCY:
        assert level <= WatchLevel.SERVICE_BRAKE
    if level is WatchLevel.HOLD:
        assert abs(code) <= abs(last)
        assert code * last >= 0
        assert code <= last
    if level is WatchLevel.TRACTION_CUT:
        assert code <= 0
        if before.level is not WatchLevel.TRACTION_CUT:
            assert code <= min(last, 0)
    if level is WatchLevel.SERVICE_BRAKE:
        assert code <= last
        assert code <= max(-LADDER.service_code, last - LADDER.ramp_code_per_s * elapsed_ms // 1000)
    if level is WatchLevel.EMERGENCY:
        assert code == -LADDER.full_code
    if level is WatchLevel.NORMAL:
        assert code <= law_code
        if not state.returning:
            assert code == law_code
        else:
            assert code <= last + LADDER.ramp_code_per_s * elapsed_ms // 1000


def test_ladder_takes_its_numbers_from_the_scenario() -> None:
    assert LADDER[:4] == (20, 64, 256, 1000)
    assert LADDER.full_code == 7 * 256
    # 1 m/s2 of service braking at 0.2088 m/s2 per notch, in 1/256 notch.
    assert LADDER.service_code == round(256 * 1.0 / (46698.52685303329 / (211_000 * 1.06)))
    assert LADDER.ramp_code_per_s == round(256 * 0.75 / (46698.52685303329 / (211_000 * 1.06)))
    strong = replace(SCENARIO, train=replace(SCENARIO.train, service_braking_mps2=3.0))
    assert Ladder.of(strong).service_code == 7 * 256
    other = replace(SCENARIO, watch=replace(SCENARIO.watch, hold_ms=40, emergency_ms=2000))
    assert Ladder.of(other)[:4] == (40, 64, 256, 2000)


def test_the_watch_begins_with_nothing_seen() -> None:
    assert SpeedWatchState() == (WatchLevel.NORMAL, 0, 0, 0, 0, False, CtlCause.NONE)


def test_a_healthy_channel_costs_no_new_state() -> None:
    """Nearly every tick: the state is the same object, up to the limit of hold."""
    healthy = after(SpeedWatchState(), *goods(10))
    assert healthy == SpeedWatchState(good_run=10)
    for look in (Seen(0, GOOD), Seen(0), Seen(20)):
        assert observe(LADDER, healthy, *look) is healthy
    assert observe(LADDER, healthy, *Seen(21)) is not healthy


@pytest.mark.parametrize("standstill", [False, True])
def test_level_at_every_age(standstill: bool) -> None:
    for age_ms in range(1300):
        expected = (age_ms > 20) + (age_ms > 64) + (age_ms > 256) + (age_ms > 1000 and not standstill)
        assert observe(LADDER, SpeedWatchState(), *Seen(age_ms, standstill=standstill)).level == expected


def test_overspeed_at_every_speed_around_the_margin() -> None:
    limit = 150_000
    margin = round(5 / 3.6 * 1e4)
    for speed in range(limit + margin - 20, limit + margin + 20):
        assert LADDER.is_overspeed(speed, limit) == (speed > limit + margin)


def test_one_bad_telegram_holds_and_one_good_releases() -> None:
    state = after(SpeedWatchState(), *goods(3), Seen(10, BAD))
    assert state.level is WatchLevel.HOLD
    assert after(state, Seen(15)).level is WatchLevel.HOLD
    assert after(state, *goods(1)).level is WatchLevel.NORMAL


@pytest.mark.parametrize("gap", range(12))
def test_three_bad_in_ten_cut_traction(gap: int) -> None:
    """Two bad ones, ``gap`` good ones, a third bad one: within ten telegrams up to seven good ones in between."""
    state = after(SpeedWatchState(), *goods(20), Seen(10, BAD), Seen(20, BAD), *goods(gap), Seen(10, BAD))
    assert state.level == (WatchLevel.TRACTION_CUT if gap <= 7 else WatchLevel.HOLD)


@pytest.mark.parametrize("run", range(8))
def test_traction_cut_ends_with_five_good_in_a_row(run: int) -> None:
    cut = after(SpeedWatchState(), Seen(65))
    state = after(cut, *goods(run))
    assert state.level == (WatchLevel.NORMAL if run >= 5 else WatchLevel.TRACTION_CUT)


@pytest.mark.parametrize("breaker", [Seen(10, BAD), Seen(21)])
def test_a_run_is_broken_by_anything_but_good(breaker: Seen) -> None:
    cut = after(SpeedWatchState(), Seen(65), *goods(4), breaker)
    assert after(cut, *goods(4)).level is WatchLevel.TRACTION_CUT
    assert after(cut, *goods(5)).level is WatchLevel.NORMAL


def test_an_old_burst_does_not_cut_again_after_the_good_run() -> None:
    state = after(SpeedWatchState(), *[Seen(10, BAD)] * 3, *goods(5))
    assert state.level is WatchLevel.NORMAL
    assert after(state, *goods(1)).level is WatchLevel.NORMAL
    assert after(state, Seen(21)).level is WatchLevel.HOLD


@pytest.mark.parametrize("finding", LEVELS.values(), ids=lambda finding: finding.cause.name)
def test_a_finding_lasts_as_long_as_it_is_found(finding: Finding) -> None:
    state = after(SpeedWatchState(), *goods(20), *goods(20, finding=finding))
    assert (state.level, state.cause) == finding
    left = after(state, *goods(10))
    emergency = finding.level is WatchLevel.EMERGENCY
    assert left[0] is (WatchLevel.EMERGENCY if emergency else WatchLevel.NORMAL)
    assert left.cause is (finding.cause if emergency else CtlCause.NONE)


def test_of_several_findings_the_strongest_counts() -> None:
    cut, brake = LEVELS[CtlCause.OVERRUNS], LEVELS[CtlCause.POSITION_LOST]
    assert stronger() is None
    assert stronger(None, cut, brake, None) is brake
    assert stronger(LEVELS[CtlCause.TWO_SOURCES], brake) is brake
    assert stronger(cut, LEVELS[CtlCause.SPEED_LATENCY]).cause is CtlCause.SPEED_LATENCY  # type: ignore[union-attr]
    # Of two equal demands the speed telegrams are named.
    assert after(SpeedWatchState(), Seen(65, finding=cut)).cause is CtlCause.SPEED_AGE
    # Nor does a weaker one hide what the age of the speed demands.
    assert after(SpeedWatchState(), Seen(300, finding=cut))[:1] == (WatchLevel.SERVICE_BRAKE,)


@pytest.mark.parametrize("run", range(13))
def test_service_brake_ends_with_ten_good(run: int) -> None:
    state = after(SpeedWatchState(), Seen(257), *goods(run))
    assert state.level == (WatchLevel.NORMAL if run >= 10 else WatchLevel.SERVICE_BRAKE)


def test_service_brake_ends_at_standstill() -> None:
    assert after(SpeedWatchState(), Seen(257), Seen(0, GOOD, standstill=True)).level is WatchLevel.NORMAL
    assert after(SpeedWatchState(), Seen(257), Seen(300, standstill=True)).level is WatchLevel.SERVICE_BRAKE


@pytest.mark.parametrize("cause", LEVELS, ids=lambda cause: cause.name)
def test_a_standstill_that_doubted_telegrams_tell_ends_no_service_brake(cause: CtlCause) -> None:
    if LEVELS[cause].level is not WatchLevel.SERVICE_BRAKE:
        return
    doubted = cause in (CtlCause.CHANNEL_MONITOR, CtlCause.TWO_SOURCES)
    braked = after(SpeedWatchState(), *goods(20, standstill=True), Seen(0, finding=LEVELS[cause]))
    assert braked[0] is WatchLevel.SERVICE_BRAKE
    for look in (Seen(10, standstill=True), *goods(1, standstill=True), *goods(9, standstill=True)):
        assert after(braked, look)[0] is (WatchLevel.SERVICE_BRAKE if doubted else WatchLevel.NORMAL)
    assert after(braked, *goods(9, standstill=True))[0] is (WatchLevel.SERVICE_BRAKE if doubted else WatchLevel.NORMAL)
    assert after(braked, *goods(10, standstill=True))[0] is WatchLevel.NORMAL


@pytest.mark.parametrize("bad", [2, 3])
def test_a_standstill_ends_the_service_brake_and_not_the_cut_for_bad_telegrams(bad: int) -> None:
    finding = LEVELS[CtlCause.POSITION_LOST]
    braked = after(SpeedWatchState(code=-300), *[Seen(10, BAD, standstill=True, finding=finding)] * bad)
    for count in range(7):
        left = after(braked, *[Seen(10, standstill=True)] * (count == 0), *goods(count, standstill=True))
        cut = bad == 3 and count < 5
        assert (left.level, left.cause) == (
            (WatchLevel.TRACTION_CUT, CtlCause.BAD_TELEGRAMS) if cut else (WatchLevel.NORMAL, CtlCause.NONE)
        )
        if cut:
            assert run_commands(left, 900, 2)[1] == [-300, -300]
    # Good ones of the ride count, too.
    for count in range(3, 6):
        left = after(braked, *goods(count - 1), *goods(1, standstill=True))
        assert left.level is (WatchLevel.TRACTION_CUT if bad == 3 and count < 5 else WatchLevel.NORMAL)


@pytest.mark.parametrize("cause", [Seen(1001), Seen(0, GOOD, overspeed=True)])
def test_emergency_is_latched(cause: Seen) -> None:
    state = after(SpeedWatchState(), cause)
    assert state.level is WatchLevel.EMERGENCY
    assert after(state, *goods(50)).level is WatchLevel.EMERGENCY
    assert after(state, *goods(50, standstill=True)).level is WatchLevel.EMERGENCY


def test_a_run_goes_on_at_the_very_limit_of_hold() -> None:
    cut = after(SpeedWatchState(), Seen(65))
    assert after(cut, *goods(4), Seen(20), *goods(1)).level is WatchLevel.NORMAL
    assert after(cut, *goods(4), Seen(21), *goods(1)).level is WatchLevel.TRACTION_CUT


def test_a_refused_speed_is_named_by_why_it_was_refused() -> None:
    assert after(SpeedWatchState(), Seen(20, BAD)).cause is CtlCause.BAD_TELEGRAMS
    assert after(SpeedWatchState(), Seen(21, BAD)).cause is CtlCause.SPEED_AGE
    assert after(SpeedWatchState(), Seen(10, IMPLAUSIBLE)).cause is CtlCause.SPEED_IMPLAUSIBLE
