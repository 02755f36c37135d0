"""Telegrams that were refused, lost or not sent: what receivers would not have taken from the recorded bus."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.lifesign import LifeSign
from railhil.bus.schedule import Schedule
from railhil.supervisor.events.declared import Received
from railhil.supervisor.events.event import LOST, MISSED_POLL, REFUSED, RecordedEvent
from railhil.supervisor.trace import Noted, Trace

BoolArray: TypeAlias = npt.NDArray[np.bool_]
#: Refusals of one port with one cause that are no further apart are one event; longer than any port's period.
BURST_NS = 2_000_000_000
_LIFE_VALUES = 16
#: Telegrams after a gap that show whether any are missing.
_LOOK_AHEAD = 32


def refused(trace: Trace, received: Iterable[Received]) -> Iterator[RecordedEvent]:
    """Telegrams refused by the traffic store, and those refused by their receiver for what they say."""
    judged = (noted for item in received for noted in _judged(trace, item))
    return _bursts(REFUSED, sorted([*trace.refused, *judged]))


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


def _judged(trace: Trace, item: Received) -> Iterator[Noted]:
    """Telegrams of one port that its receiver refuses, by the causes of its counters."""
    times_ns = trace.times_ns(item.port)
    for index, cause in judged(trace, item):
        yield Noted(times_ns[index], item.port, cause)


class Stretch(NamedTuple):
    """Telegrams of a port by their numbers in the record, from ``first`` up to ``after``; ``anew``: the receiver has
    forgotten those before."""

    first: int
    after: int
    anew: bool = False


def bad_content(trace: Trace, item: Received) -> tuple[BoolArray, BoolArray]:
    """Which telegrams of a port have a wrong check variable, and which a value out of range; shape (n,)."""
    check_failed = np.zeros(trace.count(item.port), dtype=bool)
    for name in item.checks:
        check_failed |= trace.raw(item.port, name) != CHECK_CORRECT
    outside = np.zeros_like(check_failed)
    for name, (lowest, highest) in item.ranges.items():
        raw = trace.raw(item.port, name)
        outside |= (raw < lowest) | (raw > highest)
    return check_failed, outside


def judged(trace: Trace, item: Received, heard: Sequence[Stretch] | None = None) -> Iterator[tuple[int, str]]:
    """The telegrams of one port that its receiver refuses: number in the record, and cause.

    :param heard: what the receiver has heard of them; None: all.
    """
    names = [name for name in (item.life, *item.checks, *item.ranges) if name]
    if not all(trace.has(item.port, name) for name in names):
        # A record of another version.
        return
    check_failed, outside = bad_content(trace, item)
    signs = trace.raw(item.port, item.life) if item.life else np.zeros(len(outside), dtype=np.int64)
    steady = not item.life or bool(np.all(np.diff(signs) % _LIFE_VALUES == 1))
    if steady and not heard and not (check_failed.any() or outside.any()):
        return
    life = LifeSign()
    for stretch in heard if heard is not None else [Stretch(0, len(signs))]:
        life = LifeSign() if stretch.anew else life
        for index in range(stretch.first, stretch.after):
            wrong, beyond = check_failed[index], outside[index]
            sign = int(signs[index])
            if item.life:
                verdict = life.judge(sign)
                if not verdict.fresh:
                    yield index, verdict.value
                    continue
                if item.follows_bad or not (wrong or beyond):
                    life.accept(sign)
            if wrong or beyond:
                yield index, "check_variable" if wrong else "out_of_range"


def lost(trace: Trace, schedule: Schedule) -> Iterator[RecordedEvent]:
    """Periodic telegrams of the plant that are neither in the record nor refused: an outage, or frames that were lost.

    One event for each gap; its instant is that of the first missing telegram.
    """
    refusals: dict[str, list[int]] = {}
    for time_ns, source, _ in trace.refused:
        refusals.setdefault(source, []).append(time_ns)
    for port in trace.contract.ports:
        if port.mode != "publish" or port.name not in schedule.periods_ns:
            continue
        times_ns: npt.NDArray[np.int64] = np.array(trace.times_ns(port.name), dtype=np.int64)
        if port.name in refusals:
            times_ns = np.sort(np.concatenate([times_ns, np.array(refusals[port.name], dtype=np.int64)]))
        period_ns = schedule.ticks(port.name) * schedule.base_tick_ns
        missing = _missing(times_ns, period_ns)
        for index in np.flatnonzero(missing).tolist():
            begun_s, until_s = (int(times_ns[index]) + period_ns) / 1e9, int(times_ns[index + 1]) / 1e9
            yield RecordedEvent(begun_s, port.name, LOST, "gap", count=int(missing[index]), until_s=until_s)


def _missing(times_ns: npt.NDArray[np.int64], period_ns: int) -> npt.NDArray[np.int64]:
    """Number of telegrams missing between each two, shape (n - 1,).

    While the clock port itself is disturbed, time stamps are wrong by some ticks for a while. What counts is therefore
    how far the telegrams are behind their number from then on, and more so than ever before.
    """
    if len(times_ns) < 2 or np.diff(times_ns).max() < 1.5 * period_ns:
        return np.zeros(max(len(times_ns) - 1, 0), dtype=np.int64)
    behind = np.rint((times_ns - times_ns[0]) / period_ns).astype(np.int64) - np.arange(len(times_ns))
    later = np.pad(behind, (0, _LOOK_AHEAD - 1), mode="edge")
    lasting = np.lib.stride_tricks.sliding_window_view(later, _LOOK_AHEAD).min(axis=1)
    return np.asarray(np.diff(np.maximum.accumulate(np.maximum(lasting, 0))), dtype=np.int64)
