"""The ladder of the train's own watch: levels by age, rules for leaving, and a reference model with the whole
history."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from railhil.plant_sim.ato.command_watch import (
    INITIAL,
    CommandWatchState,
    WatchTicks,
    watch_step,
    watch_ticks,
)
from railhil.systems.ato.scenario.model import WatchLimits
from railhil.wire.ato import WatchLevel

TICK_NS = 10_000_000
LIMITS = WatchLimits()
TICKS = watch_ticks(LIMITS, TICK_NS)
GOOD = CommandWatchState(WatchLevel.NORMAL, 0, 10)


def after(
    state: CommandWatchState,
    pattern: str,
    *,
    limits: WatchTicks = TICKS,
    moving: bool = True,
    below_limit: bool = True,
    emergency: bool = False,
    suspicion: int = 0,
) -> CommandWatchState:
    """State after one tick per character: ``c`` an accepted command, ``.`` none."""
    for mark in pattern:
        state = watch_step(
            limits,
            state,
            accepted=mark in "cs",
            suspicion=suspicion if mark == "s" else 0,
            moving=moving,
            below_limit=below_limit,
            emergency=emergency,
        )
    return state


def at_level(level: WatchLevel) -> CommandWatchState:
    return CommandWatchState(level, 0, 0)


@pytest.mark.parametrize(
    ("silent_ticks", "level"),
    [
        (1, WatchLevel.NORMAL),
        (2, WatchLevel.NORMAL),
        (3, WatchLevel.HOLD),
        (6, WatchLevel.HOLD),
        (7, WatchLevel.TRACTION_CUT),
        (25, WatchLevel.TRACTION_CUT),
        (26, WatchLevel.SERVICE_BRAKE),
        (100, WatchLevel.SERVICE_BRAKE),
        (101, WatchLevel.EMERGENCY),
        (5000, WatchLevel.EMERGENCY),
    ],
)
def test_level_by_silence(silent_ticks: int, level: WatchLevel) -> None:
    # 20, 64, 256 and 1000 ms: traction cut within 70 ms, service brake within 270 ms, emergency within 1.02 s.
    assert after(GOOD, "." * silent_ticks).level is level


@pytest.mark.parametrize("base_tick_ns", [1_000_000, 7_000_000, 16_000_000, 20_000_000])
@pytest.mark.parametrize("name", ["hold", "traction_cut", "service_brake", "emergency"])
def test_limits_are_times_whatever_the_tick(base_tick_ns: int, name: str) -> None:
    ticks = getattr(watch_ticks(LIMITS, base_tick_ns), name)
    limit_ns = getattr(LIMITS, f"{name}_ms") * 1_000_000
    assert ticks * base_tick_ns <= limit_ns < (ticks + 1) * base_tick_ns


def test_limits_are_scenario_data() -> None:
    ticks = watch_ticks(WatchLimits(hold_ms=50, traction_cut_ms=60, service_brake_ms=70, emergency_ms=80), TICK_NS)
    levels = [after(GOOD, "." * silent, limits=ticks).level for silent in range(4, 10)]
    assert levels == [0, 0, 1, 2, 3, 4]


def test_a_standing_train_needs_no_emergency() -> None:
    assert after(GOOD, "." * 5000, moving=False).level is WatchLevel.SERVICE_BRAKE


@pytest.mark.parametrize("pattern", ["c." * 200, "c" * 50])
def test_polled_commands_keep_it_normal(pattern: str) -> None:
    state = GOOD
    for mark in pattern:
        state = after(state, mark)
        assert state.level is WatchLevel.NORMAL


@pytest.mark.parametrize(
    ("level", "pattern", "moving", "below_limit", "expected"),
    [
        (WatchLevel.HOLD, "c", True, False, WatchLevel.NORMAL),
        (WatchLevel.TRACTION_CUT, "c.c.c.c.", True, True, WatchLevel.TRACTION_CUT),
        (WatchLevel.TRACTION_CUT, "c.c.c.c.c", True, False, WatchLevel.NORMAL),
        # A gap of 30 ms starts the count again.
        (WatchLevel.TRACTION_CUT, "c.c.c.c..c", True, True, WatchLevel.TRACTION_CUT),
        (WatchLevel.TRACTION_CUT, "c.c.c.c..c.c.c.c", True, True, WatchLevel.TRACTION_CUT),
        (WatchLevel.TRACTION_CUT, "c.c.c.c..c.c.c.c.c", True, True, WatchLevel.NORMAL),
        (WatchLevel.SERVICE_BRAKE, "c." * 9, True, True, WatchLevel.SERVICE_BRAKE),
        (WatchLevel.SERVICE_BRAKE, "c." * 9 + "c", True, True, WatchLevel.NORMAL),
        (WatchLevel.SERVICE_BRAKE, "c." * 50, True, False, WatchLevel.SERVICE_BRAKE),
        (WatchLevel.SERVICE_BRAKE, "c", False, False, WatchLevel.NORMAL),
        (WatchLevel.SERVICE_BRAKE, "." * 50, False, True, WatchLevel.SERVICE_BRAKE),
        (WatchLevel.EMERGENCY, "c." * 50, True, True, WatchLevel.EMERGENCY),
        (WatchLevel.EMERGENCY, "c." * 50, False, True, WatchLevel.EMERGENCY),
    ],
)
def test_leave_rules(level: WatchLevel, pattern: str, moving: bool, below_limit: bool, expected: WatchLevel) -> None:
    assert after(at_level(level), pattern, moving=moving, below_limit=below_limit).level is expected


@pytest.mark.parametrize("level", list(WatchLevel))
def test_an_emergency_demand_wins_over_every_level(level: WatchLevel) -> None:
    assert after(at_level(level), "c", emergency=True).level is WatchLevel.EMERGENCY


@pytest.mark.parametrize("level", [WatchLevel.TRACTION_CUT, WatchLevel.SERVICE_BRAKE])
def test_a_suspicion_demands_its_level_and_breaks_the_row(level: WatchLevel) -> None:
    state = after(GOOD, "s", suspicion=level)
    assert state == (level, 0, 0)
    needed = 5 if level is WatchLevel.TRACTION_CUT else 10
    assert after(state, "c" * (needed - 1)).level is level
    assert after(state, "c" * needed).level is WatchLevel.NORMAL
    assert after(at_level(WatchLevel.EMERGENCY), "s", suspicion=level).level is WatchLevel.EMERGENCY
    assert after(GOOD, "." * 30 + "s", suspicion=2).level is WatchLevel.SERVICE_BRAKE


class LadderAgainstHistory(RuleBasedStateMachine):
    """The ladder against a reference that keeps the whole history of accepted commands instead of counters."""

    @initialize()
    def start(self) -> None:
        self.state = INITIAL
        self.now_ms = 0
        #: Since the last suspicion.
        self.accepted_ms: list[int] = []
        self.last_ms = 0
        self.level = 3
        self.moving = False

    @rule(
        pattern=st.sampled_from([".", "c", "c.", ".c", "c." * 4, "c." * 10, "." * 4, "." * 7, "." * 26, "." * 101]),
        moving=st.booleans(),
        below_limit=st.booleans(),
    )
    def pass_time(self, pattern: str, moving: bool, below_limit: bool) -> None:
        self.moving = moving
        for mark in pattern:
            self.state = after(self.state, mark, moving=moving, below_limit=below_limit)
            self.now_ms += 10
            if mark == "c":
                self.accepted_ms.append(self.now_ms)
            self._reference(moving, below_limit, demanded=False)
            assert self.state.level == self.level

    @rule()
    def emergency(self) -> None:
        self.state = after(self.state, ".", moving=self.moving, emergency=True)
        self.now_ms += 10
        self._reference(self.moving, True, demanded=True)

    @rule(level=st.sampled_from([2, 3]), accepted=st.booleans())
    def suspicion(self, level: int, accepted: bool) -> None:
        self.state = watch_step(TICKS, self.state, accepted, level, self.moving, True, False)
        self.now_ms += 10
        self.accepted_ms = []
        if accepted:
            self.last_ms = self.now_ms
        self._reference(self.moving, True, demanded=False)
        self.level = max(self.level, level)

    def _in_a_row(self) -> int:
        row, later = 0, self.now_ms
        for when in reversed(self.accepted_ms):
            if later - when > 20:
                break
            row, later = row + 1, when
        return row

    def _reference(self, moving: bool, below_limit: bool, demanded: bool) -> None:
        row = self._in_a_row()
        self.last_ms = max([self.last_ms, *self.accepted_ms[-1:]])
        age_ms = self.now_ms - self.last_ms
        left = {
            0: True,
            1: row >= 1,
            2: row >= 5,
            3: (row >= 1 and not moving) or (row >= 10 and below_limit),
            4: False,
        }[self.level]
        by_age = sum(age_ms > limit for limit in (20, 64, 256)) + (age_ms > 1000 and moving)
        self.level = 4 if demanded else max(by_age, 0 if left else self.level)

    @invariant()
    def same_level(self) -> None:
        assert self.state.level == self.level


TestLadderAgainstHistory = LadderAgainstHistory.TestCase
TestLadderAgainstHistory.settings = settings(
    max_examples=80, stateful_step_count=25, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
