"""The train's ladder at every combination of what it looks at, against its table."""

from __future__ import annotations

from itertools import product

import pytest

from railhil.plant_sim.ato import command_watch
from railhil.plant_sim.ato.command_watch import (
    INITIAL,
    SUSPICIONS,
    CommandWatchState,
    WatchTicks,
    watch_brake_mps2,
    watch_step,
    watch_ticks,
)
from railhil.systems.ato.scenario.model import WatchLimits
from railhil.wire.ato import WatchCause, WatchLevel

LIMITS = WatchTicks(2, 4, 7, 11)
BOTH = (False, True)


@pytest.mark.parametrize("moving", BOTH)
def test_level_by_silence(moving: bool) -> None:
    """20, 64, 256 and 1000 ms: traction cut within 70 ms, service brake within 270 ms, emergency within 1.02 s. A
    standing train needs no emergency brake."""
    limits, state = watch_ticks(WatchLimits(), 10_000_000), CommandWatchState(WatchLevel.NORMAL, 0, 10)
    for silent_ticks in range(1, 200):
        state = watch_step(limits, state, False, 0, moving, True, False)
        assert state.level == sum(silent_ticks > limit for limit in (2, 6, 25)) + (silent_ticks > 100 and moving)


def test_every_step_of_the_ladder() -> None:
    for level, age, good, accepted, suspicion, moving, below, emergency in product(
        range(5), range(13), (0, 1, 4, 5, 9, 10), BOTH, (0, 1, 2, 3), BOTH, BOTH, BOTH
    ):
        now = 0 if accepted else age + 1
        row = 0 if age + 1 > 2 else good
        row = min(row + 1, 10) if accepted else row
        row = 0 if suspicion else row
        rest_or_run = (row > 0 and not moving) or (row > 9 and below)
        leaves = (True, row > 0, row > 4, rest_or_run, False)[level]
        by_age = (now > 2) + (now > 4) + (now > 7)
        if now > 11 and moving:
            by_age = 4
        wanted = 4 if emergency else max(by_age, suspicion, 0 if leaves else level)
        state = CommandWatchState(WatchLevel(level), age, good)
        found = watch_step(LIMITS, state, accepted, suspicion, moving, below, emergency)
        assert found == (wanted, now, row), (state, accepted, suspicion, moving, below, emergency)


def test_numbers() -> None:
    assert list(WatchLevel) == [0, 1, 2, 3, 4]
    assert INITIAL == (3, 0, 0)
    assert SUSPICIONS == {
        WatchCause.NONE: 0, WatchCause.BAD_COMMANDS: 2, WatchCause.NOTCH_RANGE: 2, WatchCause.NOTCH_STEP: 2,
        WatchCause.TWO_SOURCES: 3,
    }  # fmt: skip
    assert command_watch.SERVICE_BRAKE_JERK_MPS3 == 0.75
    limits = WatchLimits(hold_ms=20, traction_cut_ms=64, service_brake_ms=256, emergency_ms=1000)
    assert watch_ticks(limits, 10_000_000) == (2, 6, 25, 100)
    assert watch_ticks(limits, 999_999) == (20, 64, 256, 1000)
    # A million s, at which one ns in a ms counts.
    long = WatchLimits(hold_ms=10**9, traction_cut_ms=10**9, service_brake_ms=10**9, emergency_ms=10**9)
    assert watch_ticks(long, 1_000_000) == (10**9,) * 4


def test_the_brake_of_each_level() -> None:
    for level, moving in product(WatchLevel, BOTH):
        brakes = [watch_brake_mps2(level, last, now, moving, 0.5, 1.0) for last, now in ((0.5, 0.25), (0.25, 0.5))]
        low = watch_brake_mps2(level, 0.0, 0.0, moving, 0.5, 1.0)
        if level is WatchLevel.EMERGENCY:
            assert (*brakes, low) == (float("inf"),) * 3
        elif level is WatchLevel.SERVICE_BRAKE:
            assert (*brakes, low) == ((0.875, 0.875, 0.375) if moving else (1.0,) * 3)
            assert watch_brake_mps2(level, 0.7, 0.0, moving, 0.5, 1.0) == 1.0
        else:
            assert (*brakes, low) == ((0.125, 0.0, 0.0) if moving else (0.0,) * 3)
