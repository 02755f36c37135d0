"""What a page draws of a sentence: its signals with their limits, its margin over time, and the part that fails."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from railhil.judge.requirements import syntax
from railhil.judge.requirements.arithmetic import in_unit
from railhil.judge.requirements.binding import Binder
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.names import Names, Quantity
from railhil.judge.requirements.parser import parse_definition
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.robustness import LEAST
from railhil.record.trace import FloatArray

#: Kinds of the parts of a sentence: the comparisons that do not hold where they should, and the antecedent.
FAILS, GIVEN = "fails", "given"


@dataclass(frozen=True, slots=True)
class Series:
    """A value of a sentence. ``limits``: of the comparisons with constants, with their texts; ``words``: of a level."""

    text: str
    unit: str
    quantity: Quantity
    limits: dict[float, str] = field(default_factory=dict)

    @property
    def words(self) -> Mapping[float, str]:
        """The words of a level, by value."""
        found: dict[float, str] = {}
        for word, value in self.quantity.words.items():
            found.setdefault(float(value), word)
        return found

    def values(self, grid: Grid) -> FloatArray:
        """At each tick of a record, shape (ticks,)."""
        return self.quantity.values(grid)


class DrawnSentence:
    """A requirement on runs of one scenario.

    :raises InputError: it does not fit the scenario.
    """

    def __init__(self, requirement: Requirement, names: Names) -> None:
        self.says = requirement.says
        self._define = dict(requirement.define)
        self._bound = requirement.bind(names)
        self._body = self._bound.sentence.body
        self._binder = Binder(self.says, names, self._define)
        self._scored = self._binder.with_scores() if isinstance(self._body, syntax.At) else self._binder
        self._wanted = not isinstance(self._body, syntax.Never)

    @property
    def unit(self) -> str:
        """Unit of the margin; empty: each comparison is divided by its scale."""
        unit = self._bound.condition.unit
        return "" if unit is None else unit.name

    def margin(self, grid: Grid) -> FloatArray:
        """Margin of the condition at each tick, shape (ticks,); below 0: it is not as it should be."""
        found = self._bound.condition.on(grid)
        found = found if self._wanted else -found
        return np.where(np.abs(found) <= LEAST, 0.0, found)

    def parts(self, grid: Grid, tick: int) -> list[tuple[str, str]]:
        """The sentence in pieces, each with its kind: :data:`FAILS`, :data:`GIVEN` or empty.

        :param tick: the one that makes the margin of a violated sentence.
        """
        spans = [(node.column, node.after, FAILS) for node in self._failing(grid, tick)]
        if (given := self._given) is not None:
            spans.append((given.column, given.after, GIVEN))
        found, place = [], 0
        for first, after, kind in sorted(spans):
            found += [(self.says[place:first], ""), (self.says[first:after], kind)]
            place = after
        return [part for part in (*found, (self.says[place:], "")) if part[0]]

    @property
    def _given(self) -> syntax.Condition | None:
        """The antecedent."""
        if isinstance(self._body, syntax.Whenever):
            return self._body.given
        is_event = isinstance(self._body, syntax.At) and not isinstance(self._body.event, syntax.Limit)
        return self._body.event if is_event else None  # type: ignore[union-attr, return-value]

    def _failing(self, grid: Grid, tick: int) -> Iterator[syntax.Condition]:
        for leaf, is_plain, shown in _leaves(self._body.condition):
            margin = self._scored.condition(leaf).on(grid)[tick]
            if not np.isnan(margin) and ((margin > 0) == is_plain) != self._wanted:
                yield shown

    def series(self) -> list[Series]:
        """The values of its comparisons, each once, with their limits."""
        found: dict[tuple[str, str], Series] = {}
        conditions = [(self._body.condition, self._scored)]
        if self._given is not None:
            conditions.insert(0, (self._given, self._binder))
        if isinstance(self._body, syntax.Whenever) and not isinstance(self._body.until, syntax.Limit | None):
            conditions.append((self._body.until, self._binder))
        for condition, binder in conditions:
            for one in self._compared(condition, binder):
                kept = found.setdefault((one.text, one.unit), one)
                kept.limits.update(one.limits)
        return list(found.values())

    def _compared(self, condition: syntax.Condition, binder: Binder) -> Iterator[Series]:
        for node, _, _ in _leaves(condition):
            if isinstance(node, syntax.Edge):
                yield from self._compared(node.of, binder)
            elif isinstance(node, syntax.Occurs) and node.name in self._define:
                text = self._define[node.name]
                inner = parse_definition(text)
                if isinstance(inner, syntax.Condition):
                    yield from self._compared(inner, Binder(text, binder.names, self._define))
            elif isinstance(node, syntax.OneOf):
                value = binder.value(node.value)
                limits = {float(value.words[word.name]): word.name for word in node.words}
                yield Series(binder.text_of(node.value), "", value, limits)
            elif isinstance(node, syntax.Compare):
                yield from _sides(node, binder)


def _leaves(
    node: syntax.Condition, is_plain: bool = True, shown: syntax.Condition | None = None
) -> Iterator[tuple[syntax.Condition, bool, syntax.Condition]]:
    """The comparisons and events of a condition; whether each is meant as it stands; its part with its own ``not``."""
    if isinstance(node, syntax.Junction):
        yield from _leaves(node.left, is_plain)
        yield from _leaves(node.right, is_plain)
    elif isinstance(node, syntax.Not):
        yield from _leaves(node.of, not is_plain, shown or node)
    else:
        yield node, is_plain, shown or node


def _sides(node: syntax.Compare, binder: Binder) -> Iterator[Series]:
    left, text = binder.value(node.left), binder.text_of(node.left)
    if left.words:
        word = node.right
        if isinstance(word, syntax.Name) and word.name in left.words:
            yield Series(text, "", left, {float(left.words[word.name]): word.name})
            return
    right, other = binder.value(node.right), binder.text_of(node.right)
    if left.words or right.words:
        yield from (Series(text, "", left), Series(other, "", right))
        return
    unit = right.unit if left.constant is not None else left.unit
    values = [(text, in_unit(left, unit)), (other, in_unit(right, unit))]
    limits = {float(value.constant): said for said, value in values if value.constant is not None}
    for said, value in values:
        if value.constant is None:
            yield Series(said, unit.name, value, dict(limits))
