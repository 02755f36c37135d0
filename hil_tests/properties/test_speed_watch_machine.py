"""The controller's ladder as a state machine beside a reference model, written from the table in its docstring.

The reference keeps times and whole histories; the watch keeps counters. Level, cause, notch and emergency flag are
compared at every step.
"""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, rule

from hil_tests.support.speed_seen import Seen
from railhil.controller_node.ato.speed_watch import Ladder, Reception, SpeedWatchState, command, observe
from railhil.scenarios.load import load
from railhil.wire.ato import CtlCause

LADDER = Ladder.of(load("lvshun_tieshan"))
FULL, SERVICE, RAMP_PER_S = 7 * 256, LADDER.service_code, LADDER.ramp_code_per_s


class Reference:
    """The rows of the table."""

    def __init__(self) -> None:
        self.level, self.cause = 0, CtlCause.NONE
        #: One entry for each telegram: good or not; the good ones since the last trouble.
        self.telegrams: list[bool] = []
        self.in_a_row = 0
        self.sent = [0]
        self.kept, self.on_ramp = 0, False

    def see(self, age_ms: int, good: bool | None, standstill: bool, overspeed: bool) -> None:
        if good is not None:
            self.telegrams.append(good)
        self.in_a_row = 0 if good is False or age_ms > 20 else self.in_a_row + (good is True)
        bad_now = good is False
        rows = [
            (4, overspeed, CtlCause.OVERSPEED),
            (4, age_ms > 1000 and not standstill, CtlCause.SPEED_AGE),
            (3, age_ms > 256, CtlCause.SPEED_AGE),
            (2, age_ms > 64, CtlCause.SPEED_AGE),
            (2, bad_now and self.telegrams[-10:].count(False) >= 3, CtlCause.BAD_TELEGRAMS),
            (1, age_ms > 20, CtlCause.SPEED_AGE),
            (1, bad_now, CtlCause.BAD_TELEGRAMS),
        ]
        entered, why = next(((level, cause) for level, holds, cause in rows if holds), (0, CtlCause.NONE))
        needed = {0: 0, 1: 1, 2: 5, 3: 0 if standstill else 10, 4: 1 << 60}[self.level]
        stays = 0 if self.in_a_row >= needed else self.level
        before, self.level = self.level, max(entered, stays)
        if self.level != before:
            self.cause = why
            if self.level == 2:
                self.kept = min(self.sent[-1], 0)

    def notch(self, law: int, elapsed_ms: int) -> int:
        last, ramp = self.sent[-1], RAMP_PER_S * elapsed_ms // 1000
        self.on_ramp = self.on_ramp or self.level >= 2
        if self.level == 0:
            code = min(law, last + ramp) if self.on_ramp else law
            self.on_ramp = self.on_ramp and code < law
        elif self.level == 1:
            code = last if last <= 0 else min(last, max(law, 0))
        elif self.level == 2:
            code = min(law, self.kept)
        elif self.level == 3:
            code = min(law, last, max(-SERVICE, min(last, 0) - ramp))
        else:
            code = -FULL
        self.sent.append(max(code, -FULL))
        return self.sent[-1]


class SpeedWatchBesideReference(RuleBasedStateMachine):
    """Time passes by 10 ms; the age of the last good telegram follows from what was received."""

    @initialize(speed=st.booleans())
    def start(self, speed: bool) -> None:
        self.state, self.reference = SpeedWatchState(), Reference()
        self.age_ms, self.standstill = 0, not speed

    def _look(self, elapsed_ms: int, reception: Reception, overspeed: bool = False) -> None:
        self.age_ms = 0 if reception is Reception.GOOD else self.age_ms + elapsed_ms
        self.state = observe(LADDER, self.state, self.age_ms, reception, self.standstill, overspeed, None)
        good = {Reception.GOOD: True, Reception.BAD: False, Reception.NONE: None}[reception]
        self.reference.see(self.age_ms, good, self.standstill, overspeed)
        assert (self.state.level, self.state.cause) == (self.reference.level, self.reference.cause)

    @rule(
        pattern=st.sampled_from(["g", "g" * 4, "g" * 5, "g" * 9, "g" * 10, "b", "bgb", "gb" * 3, ".", "..", "b."]),
        standstill=st.sampled_from([False, False, True]),
    )  # fmt: skip
    def telegrams(self, pattern: str, standstill: bool) -> None:
        for mark in pattern:
            self.standstill = standstill if mark == "g" else self.standstill
            self._look(10, {"g": Reception.GOOD, "b": Reception.BAD, ".": Reception.NONE}[mark])

    @rule(age_ms=st.sampled_from([20, 21, 64, 65, 256, 257, 1000, 1001]))
    def silence(self, age_ms: int) -> None:
        """Nothing more until this age; the thresholds themselves are inside their level."""
        if self.age_ms < age_ms:
            self._look(age_ms - self.age_ms, Reception.NONE)

    @rule(good=st.booleans())
    def overspeed(self, good: bool) -> None:
        # Rarely: this level is never left.
        if self.reference.level >= 3:
            self._look(10, Reception.GOOD if good else Reception.NONE, overspeed=True)

    @rule(
        law=st.sampled_from([-FULL, -300, -1, 0, 1, 300, 900, FULL]),
        elapsed_ms=st.sampled_from([0, 10, 20, 999, 1000]),
        times=st.sampled_from([1, 1, 3, 30]),
    )
    def notches(self, law: int, elapsed_ms: int, times: int) -> None:
        for _ in range(times):
            self.state, code, emergency = command(LADDER, self.state, law, RAMP_PER_S * elapsed_ms // 1000)
            assert code == self.reference.notch(law, elapsed_ms)
            assert emergency == (self.reference.level == 4)


TestSpeedWatchBesideReference = pytest.mark.slow(SpeedWatchBesideReference.TestCase)
TestSpeedWatchBesideReference.settings = settings(
    max_examples=150, stateful_step_count=30, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)


def seen(state: SpeedWatchState, *looks: Seen) -> SpeedWatchState:
    for look in looks:
        state = observe(LADDER, state, *look)
    return state


GOODS = [Seen(0, Reception.GOOD)]


def test_a_run_goes_on_at_the_very_limit_of_hold() -> None:
    cut = seen(SpeedWatchState(), Seen(65))
    assert seen(cut, *GOODS * 4, Seen(20), *GOODS).level == 0
    assert seen(cut, *GOODS * 4, Seen(21), *GOODS).level == 2


def test_after_a_traction_cut_the_notch_returns_on_the_ramp_though_it_was_zero_all_the_time() -> None:
    state, code, _ = command(LADDER, seen(SpeedWatchState(), Seen(65)), 0, RAMP_PER_S * 20 // 1000)
    assert code == 0
    _, code, _ = command(LADDER, seen(state, *GOODS * 5), 900, RAMP_PER_S * 20 // 1000)
    assert code == RAMP_PER_S * 20 // 1000 < 900
