"""Sentences as formulas of signal temporal logic, with the margins that rtamt gives to them.

Nickovic, Yamaguchi: RTAMT: Online robustness monitors from STL (2020). rtamt knows no value that is not known, and no
truth at a margin of 0: there the record's own margins stand, after all the others have been found equal.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import rtamt

from railhil.judge.requirements import syntax
from railhil.judge.requirements.arithmetic import in_unit
from railhil.judge.requirements.binding import Binder
from railhil.judge.requirements.bound import Bound, Leaf
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.names import Names
from railhil.judge.requirements.parser import parse_sentence
from railhil.record.trace import FloatArray

#: Margins that differ by less are equal: sides are scaled before rtamt takes their difference, and not after it.
EQUAL_BELOW = 1e-9
_SIGNS = {"=": "==", "!=": "!=="}


def margins(formula: str, series: Mapping[str, FloatArray]) -> FloatArray:
    """Margins of a formula at each sample, shape (n,), by rtamt."""
    specification = rtamt.StlDiscreteTimeSpecification()
    for name in ("out", *series):
        specification.declare_var(name, "float")
    specification.spec = f"out = {formula}"
    specification.parse()
    count = len(next(iter(series.values())))
    told = specification.evaluate({"time": [*range(count)], **{name: one.tolist() for name, one in series.items()}})
    return np.array([value for _, value in told], dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Case:
    """What a sentence finds from each tick of a record on, shape (n,): bounds of the margin of the case that begins
    there, and whether one does."""

    least: FloatArray
    most: FloatArray
    begins: npt.NDArray[np.bool_]


class Oracle:
    """Margins of a sentence's conditions and cases on a record, by rtamt.

    :raises AssertionError: the record's own margins of a condition differ at a tick at which its values are known.
    """

    def __init__(self, says: str, names: Names, grid: Grid) -> None:
        self._body = parse_sentence(says).body
        self._binder = Binder(says, names, {})
        self._tick_ns, self._grid = names.tick_ns, grid
        #: Ticks compared so far.
        self.compared = 0

    def condition(self, node: syntax.Condition) -> FloatArray:
        """Margins at each tick; NaN: not known."""
        bound = self._binder.condition(node)
        formula, series, known = _Formula(self._binder, bound, self._grid, self._tick_ns).of(node)
        theirs, own = margins(formula, series), bound.on(self._grid)
        np.testing.assert_allclose(own[known], theirs[known], rtol=EQUAL_BELOW, atol=EQUAL_BELOW, err_msg=formula)
        self.compared += int(known.sum())
        return np.where(known & (np.abs(theirs) > EQUAL_BELOW), theirs, own)

    def cases(self) -> Case:
        """The cases that begin at each tick."""
        body, count = self._body, self._grid.count
        if isinstance(body, syntax.At) and self._binder.is_stop(body.event):
            self._binder = self._binder.with_scores()
        holds = self.condition(body.condition)
        always = np.ones(count, dtype=bool)
        if isinstance(body, syntax.Always):
            return Case(holds, holds, ~np.isnan(holds))
        if isinstance(body, syntax.At):
            assert not isinstance(body.event, syntax.Limit)
            return Case(holds, holds, (self.condition(body.event) > 0) & ~np.isnan(holds))
        if isinstance(body, syntax.Never):
            last = 0 if body.longer is None else math.floor(self._ticks(body.longer))
            inside = np.where(np.isnan(holds), -np.inf, holds)
            bounds = [_windowed(f"not(always[0:{last}](c))", inside, last, beyond) for beyond in (np.inf, -np.inf)]
            return Case(bounds[0], bounds[1], ~np.isnan(holds))
        if isinstance(body, syntax.Eventually):
            if body.within is None:
                # It has to begin within the record.
                bounds = [margins("eventually(c)", {"c": one}) for one in self._reactions(holds, body.hold, None)]
                return Case(bounds[0], bounds[1], always)
            return Case(*self._delayed(self._reactions(holds, body.hold, None), 0, self._ticks(body.within)), always)
        begins = self.condition(body.given) > 0
        first, last = (0 if one is None else self._ticks(one) for one in (body.first, body.last))
        return Case(*self._delayed(self._reactions(holds, body.hold, body.until), first, last), begins)

    def _ticks(self, time: syntax.Number) -> float:
        return float(self._binder.time_ns(time)) / self._tick_ns

    def _reactions(
        self, holds: FloatArray, hold: syntax.Number | None, until: syntax.Condition | syntax.Limit | None
    ) -> tuple[FloatArray, FloatArray]:
        """Bounds of the reaction that begins at each tick."""
        ticks = 1 if hold is None else math.ceil(self._ticks(hold))
        gate = self._released(until)
        found = []
        for beyond in (-np.inf, np.inf):
            reaction = np.where(np.isnan(holds), -np.inf, holds)
            if until is not None:
                # The weak until: nothing has to come.
                inside = np.where(np.isnan(holds), np.inf, holds)
                reaction = margins("((c) until (r)) or always(c)", {"c": inside, "r": gate})
                reaction = np.where(np.isposinf(reaction) & (gate < 0), -np.inf, reaction)
            elif ticks > 1:
                inside = np.where(np.isnan(holds), np.inf, holds)
                reaction = _windowed(f"always[0:{ticks - 1}](c)", inside, ticks, beyond)
                told = _windowed(
                    f"eventually[0:{ticks - 1}](c)", np.where(np.isnan(holds), -np.inf, 1.0), ticks, np.inf
                )
                reaction = np.where(told < 0, -np.inf, reaction)
            found.append(reaction)
        return found[0], found[1]

    def _delayed(
        self, bounds: tuple[FloatArray, FloatArray], first: float, last: float
    ) -> tuple[FloatArray, FloatArray]:
        """Bounds of the best reaction that begins ``first`` to ``last`` ticks later, also behind the end."""
        formula, more = f"eventually[{math.ceil(first)}:{math.floor(last)}](c)", math.floor(last)
        least, most = bounds
        return _windowed(formula, least, more, -np.inf), _windowed(formula, most, more, np.inf)

    def _released(self, until: syntax.Condition | syntax.Limit | None) -> FloatArray:
        if until is None or isinstance(until, syntax.Limit):
            return np.full(self._grid.count, -np.inf)
        return np.where(self.condition(until) > 0, np.inf, -np.inf)

    def outcomes(self) -> list[tuple[str, float | None]]:
        """Verdict and margin of the sentence with the scope from each tick to the end."""
        cases, found = self.cases(), list[tuple[str, float | None]]()
        counts = cases.begins & (cases.most > -np.inf)
        violated, kept = counts & (cases.most < 0), counts & (cases.least > 0)
        values = np.where(violated, cases.most, np.where(kept, cases.least, np.inf))
        if isinstance(self._body, syntax.Eventually):
            # One case for each scope.
            worst, rows = values, [slice(tick, tick + 1) for tick in range(len(values))]
        else:
            worst, rows = margins("always(c)", {"c": values}), [slice(tick, None) for tick in range(len(values))]
        for tick, row in enumerate(rows):
            is_open = (counts & ~violated & ~kept)[row].any()
            verdict = "violated" if violated[row].any() else "open" if is_open else "kept"
            verdict = verdict if counts[row].any() else "says nothing"
            found.append((verdict, float(worst[tick]) if np.isfinite(worst[tick]) else None))
        return found


def _windowed(formula: str, values: FloatArray, more: int, beyond: float) -> FloatArray:
    """Margins of a formula of ``c``, with so many further samples behind the end."""
    longer = np.concatenate([values, np.full(more + 1, beyond)])
    return margins(formula, {"c": longer})[: len(values)]


class _Formula:
    """A condition as a formula over the values of a record, and the ticks at which all of these are known."""

    def __init__(self, binder: Binder, bound: Bound, grid: Grid, tick_ns: int) -> None:
        self._binder, self._bound, self._grid, self._tick_ns = binder, bound, grid, tick_ns
        self._leaves = iter(bound.leaves)
        self._series: dict[str, FloatArray] = {}
        self._known = np.ones(grid.count, dtype=bool)

    def of(self, node: syntax.Condition) -> tuple[str, dict[str, FloatArray], npt.NDArray[np.bool_]]:
        """Formula, series and known ticks of the condition."""
        formula = self._part(node)
        return formula, {name: np.nan_to_num(one) for name, one in self._series.items()}, self._known

    def _part(self, node: syntax.Condition) -> str:
        if isinstance(node, syntax.Junction):
            left = self._part(node.left)
            return f"({left} {node.word} {self._part(node.right)})"
        if isinstance(node, syntax.Not):
            return f"not({self._part(node.of)})"
        leaf = next(self._leaves)
        ratio = self._ratio(leaf)
        self._known &= ~np.isnan(leaf.on(self._grid))
        if not isinstance(node, syntax.Compare) or self._is_unordered(node):
            return f"({self._named(leaf.on(self._grid) * ratio)})"
        return self._compared(node, ratio)

    def _ratio(self, leaf: Leaf) -> float:
        unit = self._bound.unit
        return 1.0 / leaf.scale_on(self._grid) if unit is None else float(leaf.unit.factor / unit.factor)

    def _is_unordered(self, node: syntax.Compare) -> bool:
        left = self._binder.value(node.left)
        return bool(left.words) and not left.ordered

    def _compared(self, node: syntax.Compare, ratio: float) -> str:
        sign, right, call = node.sign, node.right, node.left
        over = isinstance(call, syntax.Call) and call.function in ("lowest", "highest") and sign not in _SIGNS
        inner = call.values[0] if over and isinstance(call, syntax.Call) else node.left
        left = self._binder.value(inner)
        if isinstance(right, syntax.Name) and right.name in left.words:
            limits = np.full(self._grid.count, float(left.words[right.name]))
            return f"({self._named(left.values(self._grid))} {_SIGNS.get(sign, sign)} {self._named(limits)})"
        other = self._binder.value(right)
        unit = other.unit if left.constant is not None else left.unit
        sides = [self._named(in_unit(one, unit).values(self._grid) * ratio) for one in (left, other)]
        compared = f"({sides[0]} {_SIGNS.get(sign, sign)} {sides[1]})"
        if not over:
            return compared
        assert isinstance(call, syntax.Call)
        assert call.time is not None
        # The lowest of the last values lies above a limit if each of them does.
        past = "historically" if (call.function == "lowest") == (">" in sign) else "once"
        ticks = math.ceil(float(self._binder.time_ns(call.time)) / self._tick_ns)
        return f"{past}[0:{ticks}]{compared}"

    def _named(self, values: FloatArray) -> str:
        name = f"x{len(self._series)}"
        self._series[name] = np.broadcast_to(values, (self._grid.count,))
        return name
