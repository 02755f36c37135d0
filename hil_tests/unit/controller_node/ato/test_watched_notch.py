"""The notch that the controller's watch sends in each of its levels."""

from __future__ import annotations

from itertools import pairwise

import pytest

from hil_tests.support.speed_seen import LADDER, Seen, after, goods, ramp, run_commands
from railhil.controller_node.ato.speed_watch import (
    SpeedWatchState,
    command,
    observe,
)
from railhil.wire.ato import WatchLevel


def test_normal_sends_the_laws_notch() -> None:
    assert run_commands(SpeedWatchState(), 1120, 2)[1] == [1120, 1120]
    assert run_commands(SpeedWatchState(code=-500), 1120, 2)[1] == [1120, 1120]


@pytest.mark.parametrize(
    ("last", "law", "sent"), [(500, 900, 500), (500, 300, 300), (500, -300, 0), (-500, -900, -500), (-500, 200, -500)]
)
def test_hold_does_not_add_effort(last: int, law: int, sent: int) -> None:
    state = after(SpeedWatchState(code=last), Seen(21))
    assert run_commands(state, law, 3)[1] == [sent] * 3


@pytest.mark.parametrize(
    ("last", "law", "sent"),
    [(500, 900, 0), (500, -300, -300), (-500, -900, -900), (-500, 200, -500), (-500, -200, -500)],
)
def test_traction_cut_keeps_braking(last: int, law: int, sent: int) -> None:
    state = after(SpeedWatchState(code=last), Seen(65))
    assert run_commands(state, law, 3)[1] == [sent] * 3


def test_service_brake_comes_and_goes_on_its_ramp() -> None:
    state = after(SpeedWatchState(code=300), Seen(257))
    step = LADDER.ramp_code_per_s * 20 // 1000
    state, codes = run_commands(state, 300, 100)
    # No traction in this level: the ramp begins at coasting.
    assert codes[0] == -step
    assert codes[1] == -2 * step
    assert codes[-1] == -LADDER.service_code
    back = after(state, *goods(10))
    assert back.level is WatchLevel.NORMAL
    back, codes = run_commands(back, 300, 100)
    assert codes[0] == -LADDER.service_code + step
    assert max(b - a for a, b in pairwise(codes)) <= step
    assert codes[-1] == 300
    assert run_commands(back, 1500, 1)[1] == [1500]


def test_a_ramp_goes_by_the_time_between_two_notches() -> None:
    ladder = LADDER._replace(ramp_code_per_s=1000)
    assert ladder.ramp_codes(5_000_000_000, 7_003_999_999) == 2003
    assert ladder.ramp_codes(5_000_999_999, 5_001_000_000) == 1
    assert ladder.ramp_codes(7_000_000_000, 5_000_000_000) == -2000


def test_no_traction_in_service_brake_though_the_ladder_jumped_there() -> None:
    state = observe(LADDER, SpeedWatchState(code=7 * 256), *Seen(age_ms=300))
    assert state.level is WatchLevel.SERVICE_BRAKE
    code = 7 * 256
    for elapsed_ms in (20, 20, 20):
        state, code, _ = command(LADDER, state, 7 * 256, ramp(elapsed_ms))
        assert code < 0, "brakes from the first notch on"


def test_harder_braking_is_not_released_by_the_service_brake() -> None:
    state = after(SpeedWatchState(code=-1700), Seen(257))
    assert run_commands(state, 0, 3)[1] == [-1700] * 3


def test_emergency_brakes_fully_at_once() -> None:
    state = after(SpeedWatchState(code=1000), Seen(1001))
    assert command(LADDER, state, 1000, ramp(20))[1:] == (-LADDER.full_code, True)


def test_a_clock_that_is_set_back_makes_no_notch_beyond_the_greatest() -> None:
    """Elapsed time below 0 turns the ramp round; the train's gate would refuse what lies beyond its range."""
    back = after(SpeedWatchState(code=-LADDER.full_code, returning=True), *goods(1))
    for elapsed_ms in (-1000, -10, 0, 10):
        _, code, _ = command(LADDER, back, 0, ramp(elapsed_ms))
        assert code == -LADDER.full_code + max(0, LADDER.ramp_code_per_s * elapsed_ms // 1000)


def test_after_a_traction_cut_the_notch_returns_on_the_ramp_though_it_was_zero_all_the_time() -> None:
    state, code, _ = command(LADDER, after(SpeedWatchState(), Seen(65)), 0, ramp(20))
    assert code == 0
    assert run_commands(after(state, *goods(5)), 900, 1)[1] == [ramp(20)]


def test_braking_that_a_traction_cut_found_is_the_least_in_it() -> None:
    state, codes = run_commands(after(SpeedWatchState(code=-500), Seen(65)), -900, 1)
    assert (codes, run_commands(after(state, Seen(66)), 200, 1)[1]) == ([-900], [-500])
