"""A sentence bound to a scenario, and the finding that it gives on the grid of a record."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.judge.requirements import syntax
from railhil.judge.requirements.binding import Binder
from railhil.judge.requirements.bound import Bound
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.names import Names
from railhil.judge.requirements.parser import parse_sentence
from railhil.judge.requirements.robustness import unless, window_max, window_min
from railhil.record.trace import FloatArray

#: First and last ticks of a part of the record that is judged.
Spans: TypeAlias = list[tuple[int, int]]
KEPT, VIOLATED, OPEN, SILENT = "kept", "violated", "open", "says nothing"


@dataclass(frozen=True, slots=True)
class Finding:
    """What a sentence finds on a record; ticks are -1 where there is none.

    ``margin``: of the worst case, in the unit of the condition. ``tick``: the one that makes it, ``trigger``: the one
    at which that case began. ``met``: how often the antecedent, the event or the scope came. ``spare``, ``allowed``:
    ticks of the window that the slowest case left over, and of the window. ``opened``: the first case that the end of
    the record leaves open.
    """

    verdict: str
    margin: float = math.inf
    tick: int = -1
    trigger: int = -1
    met: int = 0
    spare: int | None = None
    allowed: int | None = None
    opened: int = -1


@dataclass(frozen=True, slots=True)
class _Cases:
    """Cases of a sentence: the tick at which each begins, and bounds of its margin, shape (n,). The bounds differ where
    the case ends behind the end of the record. ``decides``: the tick that makes the margin of a case."""

    ticks: npt.NDArray[np.int64]
    least: FloatArray
    most: FloatArray
    decides: Callable[[int], int] = int

    def finding(self, met: int) -> Finding:
        """The verdict over all cases."""
        known = self.most > -np.inf
        ticks, least, most = self.ticks[known], self.least[known], self.most[known]
        if not len(ticks):
            return Finding(SILENT, met=met)
        violated, kept = most < 0, least > 0
        is_open = ~(violated | kept)
        opened = int(ticks[is_open][0]) if is_open.any() else -1
        margins = np.where(violated, most, np.where(kept, least, np.inf))
        worst = int(np.argmin(margins))
        verdict = VIOLATED if violated.any() else OPEN if is_open.any() else KEPT
        if not np.isfinite(margins[worst]):
            return Finding(verdict, met=met, opened=opened)
        trigger = int(ticks[worst])
        return Finding(verdict, float(margins[worst]), self.decides(trigger), trigger, met, opened=opened)


class BoundSentence:
    """A sentence whose names and units fit a scenario.

    :param define: the names of ``[define]`` with their texts.
    :raises SentenceError: they do not fit.
    """

    def __init__(self, text: str, names: Names, define: Mapping[str, str]) -> None:
        self.sentence = parse_sentence(text)
        self._names = names
        self._binder = Binder(text, names, define)
        scope = self.sentence.scope
        self._scope = [self._instant(one) for one in (scope.first, scope.last) if one is not None] if scope else []
        self._bind(self.sentence.body)

    def _bind(self, body: syntax.Body) -> None:
        binder = self._binder
        self.given: Bound | None = None
        if isinstance(body, syntax.At):
            self.given = None if isinstance(body.event, syntax.Limit) else binder.condition(body.event)
            if binder.is_stop(body.event):
                binder = binder.with_scores()
        self.condition = binder.condition(body.condition)
        periods_ns = self.condition.periods_ns
        self._first = self._last = 0
        self._hold = 1
        self._until: Bound | None = None
        self._ends = False
        if isinstance(body, syntax.Never):
            self._bind_longest(body, periods_ns)
        elif isinstance(body, syntax.Whenever):
            self.given = binder.condition(body.given)
            self._bind_reaction(body, periods_ns)
        elif isinstance(body, syntax.Eventually):
            self._last = -1 if body.within is None else math.floor(binder.window(body.within, periods_ns))
            self._hold = 1 if body.hold is None else math.ceil(binder.window(body.hold, periods_ns))

    def _bind_longest(self, body: syntax.Never, periods_ns: Mapping[str, int]) -> None:
        self._hold = 1
        if body.longer is not None:
            # A value that has begun to hold at a tick holds until the next one: one more tick is longer.
            self._hold = math.floor(self._binder.window(body.longer, periods_ns)) + 1

    def _bind_reaction(self, body: syntax.Whenever, periods_ns: Mapping[str, int]) -> None:
        binder = self._binder
        if body.last is not None:
            self._last = math.floor(binder.window(body.last, periods_ns))
        if body.first is not None:
            assert body.last is not None
            self._first = math.ceil(binder.time_ns(body.first) / self._names.tick_ns)
            if self._first > self._last:
                raise binder.refused(body.last, "ends a window in which no tick lies")
        if body.hold is not None:
            self._hold = math.ceil(binder.window(body.hold, periods_ns))
        if body.until is not None:
            self._ends = True
            self._until = None if isinstance(body.until, syntax.Limit) else binder.condition(body.until)

    def _instant(self, node: syntax.Number | syntax.Limit | syntax.Condition) -> Fraction | str | Bound:
        if isinstance(node, syntax.Number):
            return self._binder.time_ns(node) / self._names.tick_ns
        return node.word if isinstance(node, syntax.Limit) else self._binder.condition(node)

    # Judging

    def on(self, grid: Grid) -> Finding:
        """What it finds on a record."""
        body = self.sentence.body
        spans = list(self._spans(grid))
        scope = np.zeros(grid.count, dtype=bool)
        for first, last in spans:
            scope[first : last + 1] = True
        if isinstance(body, syntax.Eventually):
            return self._eventually(grid, spans)
        if isinstance(body, syntax.At):
            found = self._at(grid, scope)
        elif isinstance(body, syntax.Whenever):
            found = self._whenever(grid, scope)
        else:
            found = self._throughout(grid, scope, spans, isinstance(body, syntax.Never))
        first, last = spans[0] if spans else (0, 0)
        # What the scope still has behind the end of the record is not seen.
        return replace(found, verdict=OPEN, opened=first) if found.verdict == KEPT and last >= grid.count else found

    def _spans(self, grid: Grid) -> Iterator[tuple[int, int]]:
        """The judged parts of the record. The scope ``from`` ends behind the record if its end has not come."""
        scope, end = self.sentence.scope, grid.count - 1
        if scope is None:
            yield 0, end
            return
        if scope.word == "between":
            opens, closes = (self._ticks(grid, one) for one in self._scope)
            last = -1
            while (opens := opens[opens > last]).size:
                first, closes = int(opens[0]), closes[closes > opens[0]]
                last = int(closes[0]) if closes.size else end
                yield first, last
            return
        begins = self._ticks(grid, self._scope[0])
        finishes = self._ticks(grid, self._scope[1], last=True) if scope.word == "from" else np.array([end])
        if begins.size and begins[0] <= end:
            first = int(begins[0])
            if not isinstance(self._scope[-1], Fraction):
                finishes = finishes[finishes >= first]
            last = min(int(finishes[0]), grid.count) if finishes.size else grid.count
            if first <= last:
                yield first, last

    def _ticks(self, grid: Grid, instant: Fraction | str | Bound, last: bool = False) -> npt.NDArray[np.int64]:
        """Ticks of an instant; a time is rounded to the tick inside the scope."""
        if isinstance(instant, Bound):
            return np.flatnonzero(instant.on(grid) > 0)
        if isinstance(instant, Fraction):
            return np.array([math.floor(instant) if last else math.ceil(instant)], dtype=np.int64)
        return np.array([0 if instant == "start" else grid.count - 1], dtype=np.int64)

    def _at(self, grid: Grid, scope: npt.NDArray[np.bool_]) -> Finding:
        occurs = scope.copy()
        if self.given is None:
            occurs[:-1] = False
        else:
            occurs &= self.given.on(grid) > 0
        ticks = np.flatnonzero(occurs)
        margins = self.condition.on(grid)[ticks]
        known = ~np.isnan(margins)
        return _Cases(ticks[known], margins[known], margins[known]).finding(len(ticks))

    def _throughout(self, grid: Grid, scope: npt.NDArray[np.bool_], spans: Spans, never: bool) -> Finding:
        margins = self.condition.on(grid)
        scoped = scope & ~np.isnan(margins)
        ticks = np.flatnonzero(scoped)
        met = sum(bool(scoped[first : last + 1].any()) for first, last in spans)
        if not never:
            return _Cases(ticks, margins[ticks], margins[ticks]).finding(met)
        if self._hold == 1:
            return _Cases(ticks, -margins[ticks], -margins[ticks]).finding(met)
        inside = np.where(scoped, margins, -np.inf)
        last = self._hold - 1
        # Behind the end of the record the condition may go on or not.
        least, most = (-window_min(inside, 0, last, beyond) for beyond in (np.inf, -np.inf))

        def decides(tick: int) -> int:
            return tick + int(np.argmin(margins[tick : tick + self._hold]))

        found = _Cases(ticks, least[ticks], most[ticks], decides).finding(met)
        longest = _longest_run(inside > 0)
        return replace(found, spare=last - longest, allowed=last)

    def _whenever(self, grid: Grid, scope: npt.NDArray[np.bool_]) -> Finding:
        assert self.given is not None
        holds = self.given.on(grid) > 0
        triggers = holds & scope
        ticks = np.flatnonzero(triggers)
        met = int(np.count_nonzero(triggers & ~np.concatenate([[False], triggers[:-1]])))
        if not met:
            return Finding(SILENT)
        margins = self.condition.on(grid)
        released = np.zeros(grid.count, dtype=bool)
        if self._until is not None:
            released = self._until.on(grid) > 0
        bounds = [self._reaction(margins, released, beyond) for beyond in (-np.inf, np.inf)]
        first, last = self._first, self._last
        least, most = (
            window_max(found, first, last, beyond)[ticks]
            for found, beyond in zip(bounds, (-np.inf, np.inf), strict=True)
        )

        def decides(tick: int) -> int:
            window = _or_least(bounds[0][tick + first : tick + last + 1])
            if not len(window):
                return tick
            begun = tick + first + int(np.argmax(window))
            return begun + self._weakest(margins, released, begun)

        found = _Cases(ticks, least, most, decides).finding(met)
        if last == first:
            return found
        reacted = ticks[least > 0]
        slowest = int(_delays(bounds[0] > 0, reacted + first).max(initial=0)) + first if len(reacted) else None
        return replace(found, spare=None if slowest is None else last - slowest, allowed=last)

    def _reaction(self, margins: FloatArray, released: npt.NDArray[np.bool_], beyond: float) -> FloatArray:
        """Margin of the reaction that begins at each tick."""
        if self._ends:
            return unless(margins, released)
        if self._hold == 1:
            return margins
        found = window_min(margins, 0, self._hold - 1, beyond)
        # A window of which nothing is known shows nothing.
        return np.where(np.isposinf(window_min(margins, 0, self._hold - 1, -np.inf)), np.nan, found)

    def _weakest(self, margins: FloatArray, released: npt.NDArray[np.bool_], begun: int) -> int:
        """Ticks from the beginning of a reaction to the one with the least margin."""
        until = begun + self._hold
        if self._ends:
            freed = np.flatnonzero(released[begun:])
            until = begun + int(freed[0]) if len(freed) else len(margins)
        part = margins[begun:until]
        return int(np.nanargmin(part)) if len(part) and not np.isnan(part).all() else 0

    def _eventually(self, grid: Grid, spans: Spans) -> Finding:
        margins = self.condition.on(grid)
        released = np.zeros(grid.count, dtype=bool)
        least, most = (self._reaction(margins, released, beyond) for beyond in (-np.inf, np.inf))
        ticks, bounds, spare = [], [], None
        for first, last in spans:
            end = last if self._last < 0 else first + self._last
            one, other = (_or_least(found[first : end + 1]) for found in (least, most))
            is_cut = end >= grid.count
            ticks.append(first)
            bounds.append((one.max(), np.inf if is_cut else other.max()))
            if self._last >= 0 and one.max() > 0:
                left = self._last - int(np.argmax(one > 0))
                spare = left if spare is None else min(spare, left)

        def decides(tick: int) -> int:
            end = self._last + 1 if self._last >= 0 else grid.count
            begun = tick + int(np.argmax(_or_least(least[tick : tick + end])))
            return begun + self._weakest(margins, released, begun)

        pairs = np.array(bounds).reshape(-1, 2)
        cases = _Cases(np.array(ticks, dtype=np.int64), pairs[:, 0], pairs[:, 1], decides)
        allowed = self._last if self._last >= 0 else None
        return replace(cases.finding(len(ticks)), spare=spare, allowed=allowed)


def _or_least(margins: FloatArray) -> FloatArray:
    """Margins with the least one for ticks of which nothing is known."""
    return np.where(np.isnan(margins), -np.inf, margins)


def _longest_run(holds: npt.NDArray[np.bool_]) -> int:
    """Ticks of the longest row of ticks that hold."""
    edges = np.flatnonzero(np.diff(holds.astype(np.int8), prepend=0, append=0))
    return int((edges[1::2] - edges[::2]).max(initial=0))


def _delays(holds: npt.NDArray[np.bool_], ticks: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Ticks from each of some ticks to the next one that holds; there is one."""
    holding = np.flatnonzero(holds)
    found: npt.NDArray[np.int64] = holding[np.searchsorted(holding, ticks)] - ticks
    return found
