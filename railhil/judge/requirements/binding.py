"""Sentences bound to the names of a scenario: units checked, and each part able to give its margins on a grid."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from railhil.common.errors import did_you_mean
from railhil.judge.requirements import syntax
from railhil.judge.requirements.arithmetic import bind_arithmetic, bind_call, in_unit
from railhil.judge.requirements.bound import Bound, Leaf, alone, pulses
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.names import Names, Quantity, constant
from railhil.judge.requirements.parser import parse_definition
from railhil.judge.requirements.robustness import LEAST, all_of, any_of, begins, ceases, compared
from railhil.judge.requirements.units import NUMBER, STEPS, Unit, given_unit
from railhil.judge.requirements.words import SentenceError
from railhil.record.trace import FloatArray

#: Two sides that differ by less than this share of the finest step on the wire are equal.
_EQUAL_STEPS = 1e-3
#: The same for values without a step, as a share of their size.
_EQUAL_SHARE = 1e-12


class Binder:
    """Binds the parts of one sentence.

    :param text: of the sentence. ``define``: further names.
    :param scores: whether the scores are known, as at a stop.
    """

    def __init__(self, text: str, names: Names, define: Mapping[str, str], scores: bool = False) -> None:
        self.names = names
        self._text, self._define, self._scores = text, define, scores
        self._inside: tuple[str, ...] = ()

    def with_scores(self) -> Binder:
        """The same, where scores are known."""
        return Binder(self._text, self.names, self._define, scores=True)

    def is_stop(self, event: syntax.Condition | syntax.Limit) -> bool:
        """Whether the scores are known at an event: a stop, or the end."""
        if isinstance(event, syntax.Occurs):
            return self._define.get(event.name, event.name).strip() in self.names.judging.stop_events
        return isinstance(event, syntax.Limit) and event.word == "end"

    def text_of(self, node: syntax.Node) -> str:
        """The text of a part."""
        return self._text[node.column : node.after]

    def refused(self, node: syntax.Node, problem: str) -> SentenceError:
        """The error for a part."""
        return SentenceError(self.text_of(node), problem, node.column)

    # Values

    def value(self, node: syntax.Value) -> Quantity:
        """A value.

        :raises SentenceError: an unknown name, or units that do not fit.
        """
        if isinstance(node, syntax.Number):
            return constant(node.value, self._unit(node))
        if isinstance(node, syntax.Name):
            return self._named(node)
        if isinstance(node, syntax.PortSignal):
            return self._signal(node)
        if isinstance(node, syntax.Arithmetic):
            left, right = self.value(node.left), self.value(node.right)
            return bind_arithmetic(self, node, left, right)
        return bind_call(self, node)

    def _unit(self, node: syntax.Number) -> Unit:
        try:
            return given_unit(node.unit) if node.unit else NUMBER
        except ValueError as error:
            raise self.refused(node, str(error)) from None

    def _named(self, node: syntax.Name) -> Quantity:
        name = node.name
        if name in self._define:
            found = self._defined(node)
            if isinstance(found, Bound):
                raise self.refused(node, "is a condition, and a value is needed")
            return found
        if name in self.names.values:
            return self.names.values[name]
        if name in self.names.scores:
            if self._scores:
                return self.names.scores[name]
            events = " ".join(f"at {event}," for event in self.names.judging.stop_events)
            raise self.refused(node, f"is a score, which is known only after: {events} or: at end")
        if name in self.names.levels:
            raise self.refused(node, "is a level: it stands only at the right of a comparison with a level")
        if name in self.names.events:
            raise self.refused(node, "is an event, and a value is needed")
        known = [*self._define, *self.names.values, *(self.names.scores if self._scores else ())]
        raise self._unknown(node, name, known, "is no signal and no name")

    def _unknown(self, node: syntax.Node, name: str, known: list[str], problem: str) -> SentenceError:
        hint = did_you_mean(name, known)
        return self.refused(node, problem + (f", {hint}" if hint else ""))

    def _defined(self, node: syntax.Name | syntax.Occurs) -> Quantity | Bound:
        name = node.name
        if name in self._inside:
            raise self.refused(node, "is defined by itself")
        text = self._define[name]
        binder = Binder(text, self.names, self._define, self._scores)
        binder._inside = (*self._inside, name)
        try:
            found = parse_definition(text)
            if isinstance(found, syntax.Name) and found.name in self.names.events | self.names.levels.keys():
                return binder.condition(syntax.Occurs(found.column, found.after, found.name))
            if isinstance(found, syntax.Number | syntax.Name | syntax.PortSignal | syntax.Arithmetic | syntax.Call):
                return binder.value(found)
            return binder.condition(found)
        except SentenceError as error:
            told = f'stands for "{text}", in which "{error.text}" {error.problem} (column {error.column + 1} there)'
            raise self.refused(node, told) from None

    def port(self, node: syntax.Name) -> str:
        """The name of a port.

        :raises SentenceError: there is none of this name.
        """
        known = [port.name for port in self.names.contract.ports]
        if node.name not in known:
            raise self._unknown(node, node.name, known, "is no port")
        return node.name

    def _signal(self, node: syntax.PortSignal) -> Quantity:
        port = self.port(syntax.Name(node.column, node.column + len(node.port), node.port))
        known = [signal.name for signal in self.names.contract.port(port).signals]
        if node.signal not in known:
            raise self._unknown(node, node.signal, known, f"is no signal of {port}")
        return self.names.signal(port, node.signal)

    # Times

    def time_ns(self, node: syntax.Number) -> Fraction:
        """A time in ns.

        :raises SentenceError: it is none.
        """
        unit = self._unit(node)
        if unit.dimensions != (("s", 1),):
            raise self.refused(node, f"is {unit.quantity}, and a time such as 20 ms is needed")
        return node.value * unit.factor * 10**9

    def window(self, node: syntax.Number, periods_ns: Mapping[str, int]) -> Fraction:
        """A time in ticks, for a window in which signals with these periods are looked at.

        :raises SentenceError: it is no time, or shorter than one of the periods.
        """
        ticks = self.time_ns(node) / self.names.tick_ns
        for port, period_ns in sorted(periods_ns.items(), key=lambda item: -item[1]):
            if ticks * self.names.tick_ns < period_ns:
                raise self.refused(node, f"is shorter than the period of {port}, {period_ns / 1e6:g} ms")
        if ticks < 1:
            raise self.refused(node, f"is shorter than a tick, {self.names.tick_ns / 1e6:g} ms")
        return ticks

    # Conditions

    def condition(self, node: syntax.Condition) -> Bound:
        """A condition.

        :raises SentenceError: as :meth:`value`; a comparison of constants.
        """
        if isinstance(node, syntax.Junction):
            left, right = self.condition(node.left), self.condition(node.right)
            join = all_of if node.word == "and" else any_of
            return Bound(
                (*left.leaves, *right.leaves),
                lambda grid, margins: join(left.joined(grid, margins), right.joined(grid, margins)),
            )
        if isinstance(node, syntax.Not):
            inner = self.condition(node.of)
            return Bound(inner.leaves, lambda grid, margins: -inner.joined(grid, margins))
        if isinstance(node, syntax.Edge):
            return alone(self._edge(node))
        if isinstance(node, syntax.Occurs):
            return self._event(node)
        if isinstance(node, syntax.OneOf):
            return alone(self._one_of(node))
        return alone(self._compare(node))

    def _edge(self, node: syntax.Edge) -> Leaf:
        inner = self.condition(node.of)
        find = begins if node.word == "begin" else ceases
        return Leaf(self.text_of(node), STEPS, lambda grid: pulses(find(inner.on(grid))), 1.0)

    def _event(self, node: syntax.Occurs) -> Bound:
        name = node.name
        if name in self._define:
            found = self._defined(syntax.Name(node.column, node.after, name))
            if isinstance(found, Bound):
                return found
        elif (levels := self.names.levels.get(name)) is not None:
            return alone(Leaf(name, STEPS, lambda grid: pulses(_enters(grid, levels, name))))
        elif name in self.names.events:
            return alone(Leaf(name, STEPS, lambda grid: pulses(grid.occurs(name))))
        elif name not in self.names.values and name not in self.names.scores:
            known = [*self._define, *self.names.events, *self.names.levels, *self.names.values]
            raise self._unknown(node, name, known, "is no event, no condition and no signal")
        raise self.refused(node, "is a value, and a condition is needed: compare it")

    def _one_of(self, node: syntax.OneOf) -> Leaf:
        value = self.value(node.value)
        if not value.words:
            raise self.refused(node.value, "is no level: only levels can be one of several words")
        ranks = [self._word(value, word) for word in node.words]

        def margins(grid: Grid) -> FloatArray:
            values = value.values(grid)
            away = np.min([_away(values, rank, value.ordered) for rank in ranks], axis=0)
            return np.where(away == 0, LEAST, -away)

        return Leaf(self.text_of(node), STEPS, margins, 1.0, value.periods_ns)

    def _word(self, value: Quantity, node: syntax.Name) -> int:
        if node.name not in value.words:
            hint = did_you_mean(node.name, value.words)
            allowed = ", ".join(value.words)
            raise self.refused(node, f"is no word of this level, allowed {allowed}" + (f" ({hint})" if hint else ""))
        return value.words[node.name]

    def _compare(self, node: syntax.Compare) -> Leaf:
        left = self.value(node.left)
        if left.words:
            return self._compare_levels(node, left)
        right = self.value(node.right)
        if right.words:
            raise self.refused(node.right, f"is a level, and {left.unit.quantity} is compared with it")
        if left.unit.dimensions != right.unit.dimensions:
            told = f"{left.unit.quantity} is compared with {right.unit.quantity}"
            raise SentenceError(self.text_of(node), told, node.right.column)
        if left.constant is not None and right.constant is not None:
            raise self.refused(node, "compares two constants: nothing of the run decides")
        unit = right.unit if left.constant is not None else left.unit
        left, right = in_unit(left, unit), in_unit(right, unit)
        step = min((one.step for one in (left, right) if one.constant is None), default=0.0)
        limit = left.constant if left.constant is not None else right.constant
        sign = node.sign

        def margins(grid: Grid) -> FloatArray:
            one, other = left.values(grid), right.values(grid)
            size = _EQUAL_STEPS * step or _EQUAL_SHARE * np.nanmax(np.abs(other), initial=0.0)
            return compared(sign, one, other, size)

        scale = abs(float(limit)) if limit else None
        return Leaf(self.text_of(node), unit, margins, scale, {**left.periods_ns, **right.periods_ns})

    def _compare_levels(self, node: syntax.Compare, left: Quantity) -> Leaf:
        word = node.right
        if not isinstance(word, syntax.Name) or (word.name not in left.words and word.name in self.names.values):
            other = self.value(word)
            if not (other.words and other.ordered and left.ordered):
                allowed = ", ".join(left.words)
                raise self.refused(word, f"stands beside a level, which is compared with its words: {allowed}")
            right = other
        else:
            right = constant(Fraction(self._word(left, word)), STEPS)
        if node.sign not in ("=", "!=") and not left.ordered:
            raise self.refused(node, "asks for an order, and these words have none: use = or !=")

        def margins(grid: Grid) -> FloatArray:
            found = compared(node.sign, left.values(grid), right.values(grid), 0.0)
            return found if left.ordered else np.clip(found, -1.0, 1.0)

        return Leaf(self.text_of(node), STEPS, margins, 1.0, {**left.periods_ns, **right.periods_ns})


def _away(values: FloatArray, rank: int, ordered: bool) -> FloatArray:
    away = np.abs(values - rank)
    return away if ordered else np.minimum(away, 1.0)


def _enters(grid: Grid, levels: list[Quantity], word: str) -> npt.NDArray[np.bool_]:
    found = np.zeros(grid.count, dtype=bool)
    for level in levels:
        found |= begins(compared("=", level.values(grid), np.full(grid.count, float(level.words[word])), 0.0))
    return found
