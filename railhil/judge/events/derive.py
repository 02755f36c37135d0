"""The events of a record: a pure function of the scenario and the recorded frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise

import numpy as np

from railhil.bus.codes import Event
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent
from railhil.judge.events import telegrams
from railhil.judge.events.declared import Interlocks, watch_events
from railhil.judge.events.event import INTERLOCK, MILESTONE, RecordedEvent, in_order
from railhil.judge.judging import judging_of
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario


def events_of(scenario: AnyScenario, trace: Trace, beside: Iterable[RecordedEvent] = ()) -> tuple[RecordedEvent, ...]:
    """All events of a record, in the order of their instants.

    :param beside: events known from another source than the record; at the same instant they come first.
    """
    judging = judging_of(scenario)
    timing = scenario.timing
    schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, trace.contract)
    end_s = trace.end_s
    return in_order(
        beside,
        milestones(trace, scenario.installed_system.events),
        telegrams.lost(trace, schedule),
        telegrams.missed_polls(trace),
        telegrams.refused(trace, judging.received(scenario)),
        (event for item in judging.interlocks for event in interlocks(trace, item, end_s)),
        (event for watch in judging.watches for event in watch_events(scenario, trace, watch, end_s)),
    )


def milestones(trace: Trace, own: Mapping[str, int]) -> Iterator[RecordedEvent]:
    """RUN_EVENT without its repetitions.

    :param own: milestones of the system by name.
    """
    names = {number: name for name, number in own.items()} | {kind.value: kind.name.lower() for kind in Event}
    columns = (
        trace.raw(RunEvent.PORT, "RunEvent"),
        trace.values(RunEvent.PORT, "EventTime"),
        trace.values(RunEvent.PORT, "EventPos"),
    )
    for number, time_s, position_m in dict.fromkeys(zip(*(column.tolist() for column in columns), strict=True)):
        if number in names:
            yield RecordedEvent(time_s, "plant", MILESTONE, names[number], position_m=position_m)


def interlocks(trace: Trace, item: Interlocks, end_s: float) -> Iterator[RecordedEvent]:
    """Each time for which a signal had another value than in normal operation."""
    time_s = trace.times_s(item.port)
    for name, normal in item.normal.items():
        if not trace.has(item.port, name):
            continue
        raw = trace.raw(item.port, name)
        firsts = np.flatnonzero(np.diff(raw, prepend=normal)).tolist()
        for first, after in pairwise([*firsts, len(raw)]):
            if raw[first] != normal:
                until_s = float(time_s[after]) if after < len(raw) else end_s
                detail = f"{name} {trace.word(item.port, name, int(raw[first]))}"
                yield RecordedEvent(float(time_s[first]), item.port, INTERLOCK, name, until_s=until_s, detail=detail)
