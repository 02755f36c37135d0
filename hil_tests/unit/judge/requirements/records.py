"""Records of some ticks of a train, made of telegrams, and the sentences judged on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from railhil.bus.codes import Event
from railhil.bus.layout import Telegram
from railhil.bus.telegrams import RunEvent
from railhil.dbc import wire_contract
from railhil.judge.record import Record
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.names import Names
from railhil.judge.requirements.outcome import Outcome, judge_one
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.score import Score
from railhil.record.trace import Trace
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd, TrnSpeed, TrnWatch

TICK_NS = 10_000_000
#: A speed of a record that stands for a telegram with a wrong check variable.
REFUSED = -1
#: A telegram with the life sign of the tick before.
REPEATED = -2


@cache
def scenario() -> Scenario:
    return load("lvshun_tieshan")


@cache
def names() -> Names:
    return Names(scenario(), Trace(wire_contract()))


def record_of(
    speeds_mmps: Sequence[int | None],
    commands: Sequence[tuple[int, int] | None] = (),
    levels: Mapping[int, int] | None = None,
    events: Sequence[tuple[float, Event]] = (),
    score: Score | None = None,
    certificate: dict[str, Any] | None = None,
    *,
    turned: bool = False,
) -> Record:
    """A record.

    :param speeds_mmps: of TRN_SPEED in each tick; None: no telegram, :data:`REFUSED`: one that is refused for its
        content, :data:`REPEATED`: one that comes again.
    :param commands: notch (1/256) and mode of NOTCH_CMD in every other tick; None: no telegram.
    :param levels: of the train's watch, by the tick at which TRN_WATCH is sent.
    :param events: instants in s and milestones.
    :param turned: whether the telegrams of a tick come in the opposite order.
    """
    trace = Trace(wire_contract())
    timed: list[tuple[int, Telegram]] = []
    for tick, speed in enumerate(speeds_mmps):
        if speed is not None:
            sent = TrnSpeed(max(speed, 0) * 10, life=tick & 0xF)
            refused = {REFUSED: TrnSpeed(0, check=0, life=tick & 0xF), REPEATED: TrnSpeed(0, life=(tick - 1) & 0xF)}
            timed.append((tick, refused.get(speed, sent)))
    for index, command in enumerate(commands):
        if command is not None:
            timed.append((2 * index, NotchCmd(notch_256th=command[0], mode=command[1], life=index & 0xF)))
    for life, (tick, level) in enumerate((levels or {}).items()):
        timed.append((tick, TrnWatch(level=level, life=life & 0xF)))
    for number, (instant_s, event) in enumerate(events):
        told = RunEvent(event=event, number=number, instant_01ms=round(instant_s * 1e4))
        timed.append((-(-round(instant_s * 1e4) // 100), told))
    for tick, telegram in sorted(reversed(timed) if turned else timed, key=lambda one: one[0]):
        trace.add(telegram.PORT, tick * TICK_NS, telegram.encode())
    trace.end_ns = (len(speeds_mmps) - 1) * TICK_NS
    made = Record(Path("frames.log"), scenario(), trace, certificate=certificate or {})
    return made.copy_with(score=score or Score("PASS", {}, {}, (), "ended_complete"))


def judged(record: Record, says: str, **define: str) -> Outcome:
    """What a record makes of a sentence."""
    requirement = Requirement("T-1", says, define=tuple(define.items()))
    return judge_one(requirement, requirement.bind(names()), Grid(record))
