"""What the controller's watch observes at one instant, in the tests."""

from __future__ import annotations

from typing import Any, NamedTuple

from railhil.controller_node.ato.speed_watch import Finding, Ladder, Reception, SpeedWatchState, command, observe
from railhil.scenarios.load import load

SCENARIO = load("lvshun_tieshan")
LADDER = Ladder.of(SCENARIO)
GOOD, BAD, NONE, IMPLAUSIBLE = Reception.GOOD, Reception.BAD, Reception.NONE, Reception.IMPLAUSIBLE


class Seen(NamedTuple):
    """Arguments of :func:`railhil.controller_node.ato.speed_watch.observe`, after ladder and state."""

    age_ms: int
    telegram: Reception = Reception.NONE
    standstill: bool = False
    overspeed: bool = False
    finding: Finding | None = None


def ramp(elapsed_ms: int) -> int:
    """How far the ramp goes in this time from 0."""
    return LADDER.ramp_codes(0, elapsed_ms * 1_000_000)


def after(state: SpeedWatchState, *looks: Seen) -> SpeedWatchState:
    """The state after these looks."""
    for look in looks:
        state = observe(LADDER, state, *look)
    return state


def goods(count: int, **seen: Any) -> list[Seen]:
    """So many good telegrams of age 0."""
    return [Seen(0, GOOD, **seen)] * count


def run_commands(state: SpeedWatchState, law_code: int, count: int) -> tuple[SpeedWatchState, list[int]]:
    """The state after so many polls, and the notches sent."""
    codes = []
    for _ in range(count):
        state, code, _ = command(LADDER, state, law_code, ramp(20))
        codes.append(code)
    return state, codes
