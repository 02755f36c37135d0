"""Interval analysis of a law's program: bounds of every value for any inputs inside their ranges.

It works on raw integers with the semantics of the fixed-point arithmetic. Intervals ignore correlations between values,
so a bound is safe but not always attained; a wrap that is reported as possible may never occur.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic.base import INT32_MAX, INT32_MIN
from railhil.controller_node.program.model import Kind, LawProgram, Operation, Program, Value

#: Smallest and largest raw integer.
Interval = tuple[int, int]

INT32: Interval = (INT32_MIN, INT32_MAX)

#: A state that still grows after this many periods is considered unbounded.
_PERIODS = 64


@dataclass(slots=True)
class Ranges:
    """Intervals of one program: of its values by number, and the operations that may leave their range.

    ``may_wrap``: the exact result may exceed int32 or, for a ``curve``, the argument may exceed 0..1.
    """

    values: dict[int, Interval] = field(default_factory=dict)
    may_wrap: list[tuple[Operation, Interval]] = field(default_factory=list)

    def of(self, value: Value) -> Interval:
        """Interval of a value or constant."""
        if value.constant is not None:
            return value.constant.raw, value.constant.raw
        return self.values[value.number]


def analyse(program: Program, inputs: Mapping[str, Interval]) -> Ranges:
    """Intervals of all values of a program.

    :param inputs: interval of every number among the program's inputs, raw.
    :raises KeyError: an input without interval.
    """
    ranges = Ranges()
    for name, value in program.inputs:
        ranges.values[value.number] = (0, 0) if value.kind is not Kind.NUMBER else inputs[name]
    for operation in program.operations:
        if operation.result.kind is not Kind.NUMBER:
            continue
        low, high = _interval(operation, ranges)
        if operation.curve is not None:
            argument = ranges.of(operation.arguments[0])
            if argument[0] < 0 or argument[1] > 1 << operation.curve.q_in:
                ranges.may_wrap.append((operation, argument))
                low, high = INT32
        if low < INT32_MIN or high > INT32_MAX:
            ranges.may_wrap.append((operation, (low, high)))
            low, high = INT32
        ranges.values[operation.result.number] = (low, high)
    return ranges


def _corners(of: Callable[[int, int], int], a: Interval, b: Interval) -> Interval:
    results = [of(x, y) for x in a for y in b]
    return min(results), max(results)


def _shifted(exact: int, q: int, rounding: bool) -> int:
    return (exact + (1 << (q - 1)) if rounding else exact) >> q


def _size(a: Interval) -> Interval:
    low, high = sorted((abs(a[0]), abs(a[1])))
    return (0 if a[0] <= 0 <= a[1] else low), high


def _quotient(a: Interval, b: Interval, q: int) -> Interval:
    """Rounded quotients saturate; any value on that side is possible for divisors close to 0."""
    if b[0] <= 0 <= b[1]:
        low = 0 if a[0] >= 0 and b[0] >= 0 else INT32_MIN
        return low, INT32_MAX

    def divided(x: int, y: int) -> int:
        x, y = (x, y) if y > 0 else (-x, -y)
        return min(max(((x << (q + 1)) + y) // (2 * y), INT32_MIN), INT32_MAX)

    return _corners(divided, a, b)


def _interval(operation: Operation, ranges: Ranges) -> Interval:
    """Exact result before it wraps."""
    numbers = [ranges.of(value) for value in operation.arguments if value.kind is Kind.NUMBER]
    parameters = operation.parameters
    match operation.op:
        case "add":
            return numbers[0][0] + numbers[1][0], numbers[0][1] + numbers[1][1]
        case "sub":
            return numbers[0][0] - numbers[1][1], numbers[0][1] - numbers[1][0]
        case "neg":
            return -numbers[0][1], -numbers[0][0]
        case "abs":
            return _size(numbers[0])
        case "mpy" | "rmpy":
            rounding = operation.op == "rmpy"
            return _corners(lambda x, y: _shifted(x * y, parameters[0], rounding), *numbers)
        case "rsmpy":
            low, high = _corners(lambda x, y: _shifted(x * y, parameters[0], True), *numbers)
            return min(max(low, INT32_MIN), INT32_MAX), min(max(high, INT32_MIN), INT32_MAX)
        case "mpy_iqx":
            shift = parameters[0] + parameters[1] - parameters[2]
            return _corners(lambda x, y: (x * y) >> shift if shift >= 0 else (x * y) << -shift, *numbers)
        case "dot":
            half = len(numbers) // 2
            low = high = 0
            for a, b in zip(numbers[:half], numbers[half:], strict=True):
                term = _corners(lambda x, y: _shifted(x * y, parameters[0], True), a, b)
                low, high = low + term[0], high + term[1]
            return low, high
        case "div":
            return _quotient(numbers[0], numbers[1], parameters[0])
        case "sqrt":
            return 0, INT32_MAX
        case "sat" | "clip":
            a, upper, lower = numbers
            # If the limits cross, the lower one wins.
            return max(min(a[0], upper[0]), lower[0]), max(min(a[1], upper[1]), lower[1])
        case "minimum":
            return min(numbers[0][0], numbers[1][0]), min(numbers[0][1], numbers[1][1])
        case "maximum":
            return max(numbers[0][0], numbers[1][0]), max(numbers[0][1], numbers[1][1])
        case "where":
            return min(numbers[0][0], numbers[1][0]), max(numbers[0][1], numbers[1][1])
        case "convert":
            q_from, q_to = parameters
            if q_to >= q_from:
                return numbers[0][0] << (q_to - q_from), numbers[0][1] << (q_to - q_from)
            return numbers[0][0] >> (q_from - q_to), numbers[0][1] >> (q_from - q_to)
        case "quantise":
            shift = parameters[0] - parameters[1]
            return _shifted(numbers[0][0], shift, True), _shifted(numbers[0][1], shift, True)
        case "curve":
            assert operation.curve is not None
            raws = [sample.raw for sample in operation.curve.samples]
            return min(raws), max(raws)
        case "at":
            assert operation.table is not None
            raws = [constant.raw for constant in operation.table.constants]
            return min(raws), max(raws)
    raise KeyError(operation.op)


@dataclass(frozen=True, slots=True)
class LawRanges:
    """Intervals of a whole control period for every input on the wire and after any number of periods."""

    inputs: Ranges
    start: Ranges
    step: Ranges

    @property
    def may_wrap(self) -> list[tuple[Operation, Interval]]:
        """Operations of a control period, or of the first one, that may wrap, with the exact interval of the result."""
        return self.inputs.may_wrap + self.start.may_wrap + self.step.may_wrap


def analyse_law(
    program: LawProgram, state_bounds: Mapping[str, tuple[float, float]], wire: Mapping[str, Interval]
) -> LawRanges:
    """Intervals of a law that runs indefinitely on inputs inside ``wire``.

    :param state_bounds: result of :meth:`~railhil.controller_node.laws.base.Law.state_bounds`; the intervals of all
        other state variables begin with the law's start and are widened period by period until they no longer grow.
    """
    inputs = analyse(program.inputs, wire)
    given = {name: inputs.of(value) for name, value in program.inputs.outputs}
    start = analyse(program.start, given)
    state = {name: start.of(value) for name, value in program.start.outputs}
    known = {f"state.{name}": bounds for name, bounds in state_bounds.items()}
    for name, value in program.step.inputs:
        if name in known:
            low, high = known[name]
            state[name] = (math.floor(math.ldexp(low, value.q or 0)), math.ceil(math.ldexp(high, value.q or 0)))
    # A notch sent instead of the law's also lies inside the notch range.
    for _ in range(_PERIODS):
        step = analyse(program.step, given | state)
        after = {name: step.of(value) for name, value in program.step.outputs}
        wider = {
            name: old if name in known else (min(old[0], after[name][0]), max(old[1], after[name][1]))
            for name, old in state.items()
        }
        if wider == state:
            return LawRanges(inputs, start, step)
        state = wider
    unbounded = {name: INT32 for name in state if name not in known}
    return LawRanges(inputs, start, analyse(program.step, given | state | unbounded))


class Bounded(Protocol):
    """The law declares bounds of its state."""

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        """See :meth:`railhil.controller_node.laws.base.Law.state_bounds`."""


def refuse_wraps(program: LawProgram, law: Bounded, at: str, wire: Mapping[str, Interval]) -> LawRanges:
    """Refuse to start a law in fixed point if one of its operations may wrap: a wrapped notch turns full brake into
    full traction.

    :param law: the law of the program, for its ``state_bounds``.
    :param at: the operating point for the error message: "at 0.5 s and 7 notches".
    :param wire: raw ranges of the values that the law may get.
    :returns: the intervals of its values.
    :raises InputError: the first such operation, identified by the quantity that it contributes to.
    """
    ranges = analyse_law(program, law.state_bounds(), wire)
    found = ranges.may_wrap
    if not found:
        return ranges
    operation, (low, high) = found[0]
    # A curve overflows in its argument, which ends at 1; all other operations in their result.
    q = operation.curve.q_in if operation.curve else operation.result.q or 0
    reached, held = math.ldexp(max(-low, high), -q), 1.0 if operation.curve else math.ldexp(1, 31 - q)
    raise InputError(
        "controller",
        program.law,
        Words(f"{_quantity(program, operation)} that may reach {reached:.6g} in Q{q}, which ends at {held:g}"),
        f"a law whose fixed point cannot wrap {at}",
        f"operations that may wrap: {len(found)}; railhil audit --runs 0 shows all bounds, floats have no such limit",
    )


def _quantity(program: LawProgram, operation: Operation) -> str:
    """The quantity noted next after an operation, as in telemetry."""
    for part in (program.inputs, program.start, program.step):
        if operation in part.operations:
            after = [one.name for one in part.quantities if one.value.number >= operation.result.number]
            return f"{operation.op} before {after[0]}" if after else f"{operation.op} of the law's {part.name}"
    raise KeyError(operation.op)
