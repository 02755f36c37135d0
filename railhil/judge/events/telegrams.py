"""The events of a record: a pure function of the scenario and the recorded frames.

Most are telegrams that were refused, lost or not sent: their receivers did not take them from the recorded bus.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.bus.codes import Event
from railhil.bus.ident import PltIdent
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent
from railhil.dbc import Port
from railhil.judge.declared import Interlocks, Received, Watch, reports
from railhil.judge.events.event import (
    INTERLOCK,
    LEVEL,
    LOST,
    MILESTONE,
    MISSED_POLL,
    REFUSED,
    START,
    RecordedEvent,
    in_order,
)
from railhil.judge.judging import judging_of
from railhil.judge.reception import judged
from railhil.record.trace import Noted, Trace
from railhil.scenarios.model import AnyScenario

Times: TypeAlias = npt.NDArray[np.int64]
#: Refusals of one port with one cause that are no further apart are one event; longer than any port's period.
BURST_NS = 2_000_000_000
#: Word for no cause.
_NO_CAUSE = "none"


def refused(scenario: AnyScenario, trace: Trace, received: Iterable[Received]) -> Iterator[RecordedEvent]:
    """Telegrams refused by the traffic store, and telegrams refused by their receiver for their content."""
    noted = list(trace.refused)
    for item in received:
        times_ns = trace.times_ns(item.port)
        noted += [Noted(times_ns[index], item.port, cause) for index, cause in judged(scenario, trace, item)]
    return _bursts(REFUSED, sorted(noted))


def missed_polls(trace: Trace) -> Iterator[RecordedEvent]:
    """Polls without a good answer."""
    return _bursts(MISSED_POLL, sorted(trace.missed))


def _bursts(kind: str, found: Iterable[Noted]) -> Iterator[RecordedEvent]:
    """One event for all that are close together.

    :param found: in the order of time.
    """
    bursts: dict[tuple[str, str], list[int]] = {}
    for time_ns, source, cause in found:
        burst = bursts.get((source, cause))
        if burst is not None and time_ns - burst[1] <= BURST_NS:
            burst[1], burst[2] = time_ns, burst[2] + 1
            continue
        if burst is not None:
            yield _burst(kind, source, cause, *burst)
        bursts[source, cause] = [time_ns, time_ns, 1]
    for (source, cause), burst in bursts.items():
        yield _burst(kind, source, cause, *burst)


def _burst(kind: str, source: str, cause: str, first_ns: int, last_ns: int, count: int) -> RecordedEvent:
    until_s = last_ns / 1e9 if count > 1 else None
    return RecordedEvent(first_ns / 1e9, source, kind, cause, count=count, until_s=until_s)


class Gap(NamedTuple):
    """Telegrams of a port that the record does not show: their number, the time at which the first was due, and the
    time of the next one or of the end of the record (ns)."""

    missing: int
    begun_ns: int
    until_ns: int


def lost(trace: Trace, schedule: Schedule) -> Iterator[RecordedEvent]:
    """Periodic telegrams of the plant that are neither in the record nor refused: an outage, or frames that were lost.

    One event for each gap; its instant is that of the first missing telegram. An outage may last from the start of the
    run, or to its end.
    """
    for port in trace.contract.ports:
        if port.mode != "poll" and port.name in schedule.periods_ns:
            for count, begun_ns, until_ns in [*gaps(trace, port, schedule), *outages(trace, port, schedule)]:
                yield RecordedEvent(
                    begun_ns / 1e9, port.name, LOST, "gap", count=count, until_s=until_ns / 1e9
                )  # fmt: skip


def _arrivals(trace: Trace, port: str) -> tuple[Times, Times]:
    """Times of the telegrams of a port, and of the refused ones, shape (n,) and (m,)."""
    refused = [time_ns for time_ns, source, _ in trace.refused if source == port]
    return np.array(trace.times_ns(port), dtype=np.int64), np.array(refused, dtype=np.int64)


def gaps(trace: Trace, port: Port, schedule: Schedule) -> list[Gap]:
    """Gaps of a periodic port between two of its telegrams.

    The life sign numbers the telegrams, and the time gives the number of its turns. Numbers that never came are missing
    if there was time for them: a stuck counter leaves none out, and copies and late telegrams fill no gap. While the
    clock port itself is disturbed, time stamps are wrong by some ticks; the numbers are not.
    """
    times_ns, refused_ns = _arrivals(trace, port.name)
    if len(times_ns) < 2:
        return []
    period_ns = schedule.ticks(port.name) * schedule.base_tick_ns
    periods = np.diff(times_ns) / period_ns
    if port.life is None:
        # The usual case: each telegram is the next one, by its time.
        steps = np.maximum(1, np.ceil(periods - 0.5)).astype(np.int64)
    else:
        values = 1 << port.life.length
        steps = np.diff(trace.raw(port.name, port.life.name)) % values
        steps += values * np.rint((periods - steps) / values).astype(np.int64)
    if np.all(steps == 1):
        return []
    numbers = np.concatenate([[0], np.cumsum(steps)])
    shown, first = np.unique(numbers, return_index=True)
    last = len(numbers) - 1 - np.unique(numbers[::-1], return_index=True)[1]
    found = []
    for index in np.flatnonzero(np.diff(shown) > 1).tolist():
        after_ns, until_ns = int(times_ns[last[index]]), int(times_ns[first[index + 1]])
        refused = int(((refused_ns >= after_ns) & (refused_ns <= until_ns)).sum())
        count = int(shown[index + 1] - shown[index]) - 1 - refused
        if port.mode != "event":
            # Other telegrams in between had a wrong life sign.
            between = int(((times_ns > after_ns) & (times_ns < until_ns)).sum())
            count = min(count, round((until_ns - after_ns) / period_ns) - 1 - between - refused)
        if count > 0:
            found.append(Gap(count, after_ns + period_ns, until_ns))
    return found


def outages(trace: Trace, port: Port, schedule: Schedule) -> Iterator[Gap]:
    """Gaps of a periodic port before its first telegram and after its last one.

    The gap before the first one counts only in a record from the start of a run. Telegrams that a scenario or a train
    need not send may begin at any time.
    """
    period_ns = schedule.ticks(port.name) * schedule.base_tick_ns
    seen_ns = np.sort(np.concatenate(_arrivals(trace, port.name)))
    opened_ns = trace.times_ns(PltIdent.PORT)
    if len(opened_ns) and port.mode != "event" and (len(seen_ns) or not port.optional):
        # The last tick of a record may be incomplete.
        first_ns = int(seen_ns[0]) if len(seen_ns) else trace.end_ns
        if (count := round((first_ns - opened_ns[0]) / period_ns + (0 if len(seen_ns) else 0.5))) > 0:
            yield Gap(count, opened_ns[0], first_ns)
    if len(seen_ns) and (behind := (trace.end_ns - int(seen_ns[-1])) / period_ns) > 1.5:
        yield Gap(math.ceil(behind) - 1, int(seen_ns[-1]) + period_ns, trace.end_ns)


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
        lost(trace, schedule),
        missed_polls(trace),
        refused(scenario, trace, judging.received(scenario)),
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


def watch_events(scenario: AnyScenario, trace: Trace, watch: Watch, end_s: float) -> Iterator[RecordedEvent]:
    """Each time for which the watch reported one level above normal, or another state, with one cause.

    :param end_s: end of the record, until which the last one lasts.
    """
    if not reports(trace, watch):
        return
    time_s = trace.times_s(watch.port)
    levels = trace.raw(watch.port, watch.level)
    has_cause = trace.has(watch.port, watch.cause)
    causes = trace.raw(watch.port, watch.cause) if has_cause else np.zeros_like(levels)
    changed = (np.diff(levels, prepend=-1) != 0) | (np.diff(causes, prepend=-1) != 0)
    firsts = np.flatnonzero(changed).tolist()
    for first, after in pairwise([*firsts, len(levels)]):
        level, begun_s = int(levels[first]), float(time_s[first])
        until_s = float(time_s[after]) if after < len(levels) else end_s
        if watch.is_normal(level):
            continue
        word = trace.word(watch.port, watch.level, level)
        cause = trace.word(watch.port, watch.cause, int(causes[first])) if has_cause else ""
        # A level that was taken without a cause of the watch, as by an open safety loop.
        cause = "" if cause == _NO_CAUSE else cause
        if level not in watch.ladder:
            detail = f"{watch.level} {level} is no value of {watch.port}" if word == str(level) else ""
            yield RecordedEvent(begun_s, watch.name, START, word, until_s=until_s, detail=detail)
        elif first == 0 and cause in watch.start and after < len(levels):
            detail = watch.said(scenario, word, cause)
            yield RecordedEvent(begun_s, watch.name, START, cause, word, until_s=until_s, detail=detail)
        else:
            detail = watch.said(scenario, word, cause) if cause else (watch.uncaused if has_cause else "")
            rank = watch.ladder.index(level)
            yield RecordedEvent(begun_s, watch.name, LEVEL, cause, word, until_s=until_s, detail=detail, rank=rank)
