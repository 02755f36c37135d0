"""The levels that a watch reports over a run."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from railhil.judge.events.declared import Watch
from railhil.judge.events.event import LEVEL, START, RecordedEvent
from railhil.record.trace import FloatArray, Trace

#: Word of a cause that is none.
_NO_CAUSE = "none"


def reports(trace: Trace, watch: Watch) -> bool:
    """Whether the record can have the watch's levels; that of an earlier version may not."""
    return trace.has(watch.port, watch.level)


def ranks(trace: Trace, watch: Watch) -> FloatArray:
    """Place in the ladder (0 = normal) in each telegram of the watch's port, NaN for other states; shape (n,)."""
    rank_of = {value: float(rank) for rank, value in enumerate(watch.ladder)}
    return np.array([rank_of.get(raw, np.nan) for raw in trace.raw(watch.port, watch.level).tolist()], dtype=np.float64)


def watch_events(scenario: Any, trace: Trace, watch: Watch, end_s: float) -> Iterator[RecordedEvent]:
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
        if level == watch.ladder[0]:
            continue
        word = trace.word(watch.port, watch.level, level)
        cause = trace.word(watch.port, watch.cause, int(causes[first])) if has_cause else ""
        # A level that was taken without a cause of the watch, as by an open safety loop.
        cause = "" if cause == _NO_CAUSE else cause
        if level not in watch.ladder:
            yield RecordedEvent(begun_s, watch.name, START, word, until_s=until_s)
        elif first == 0 and cause in watch.start and after < len(levels):
            detail = watch.said(scenario, word, cause)
            yield RecordedEvent(begun_s, watch.name, START, cause, word, until_s=until_s, detail=detail)
        else:
            detail = watch.said(scenario, word, cause) if cause else ""
            rank = watch.ladder.index(level)
            yield RecordedEvent(begun_s, watch.name, LEVEL, cause, word, until_s=until_s, detail=detail, rank=rank)
