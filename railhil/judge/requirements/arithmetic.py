"""Arithmetic of the values in a sentence: each operation with its unit, its resolution and its values."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from railhil.judge.requirements import syntax
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.names import Quantity, constant
from railhil.judge.requirements.robustness import window_max
from railhil.judge.requirements.units import NUMBER, Unit, given_unit, product
from railhil.record.trace import FloatArray

if TYPE_CHECKING:
    from railhil.judge.requirements.binding import Binder

_DONE = {"+": "added to", "-": "taken from"}


def in_unit(value: Quantity, unit: Unit) -> Quantity:
    """The same value in another unit of its dimensions."""
    ratio = value.unit.factor / unit.factor
    if ratio == 1:
        return replace(value, unit=unit)
    if value.constant is not None:
        return constant(value.constant * ratio, unit)
    factor, values = float(ratio), value.values
    return replace(value, unit=unit, step=value.step * factor, values=lambda grid: values(grid) * factor)


def bind_arithmetic(binder: Binder, node: syntax.Arithmetic, left: Quantity, right: Quantity) -> Quantity:
    """``+ - * /`` of two values.

    :raises SentenceError: the units do not fit, or a value is a level.
    """
    for part, value in ((node.left, left), (node.right, right)):
        if value.words:
            raise binder.refused(part, "is a level, with which nothing can be computed")
    if node.sign in "+-":
        return _sum(binder, node, left, right)
    return _product(binder, node, left, right)


def _sum(binder: Binder, node: syntax.Arithmetic, left: Quantity, right: Quantity) -> Quantity:
    if left.unit.dimensions != right.unit.dimensions:
        one, other = (right, left) if node.sign == "-" else (left, right)
        raise binder.refused(node, f"{one.unit.quantity} is {_DONE[node.sign]} {other.unit.quantity}")
    unit = right.unit if left.constant is not None and right.constant is None else left.unit
    left, right = in_unit(left, unit), in_unit(right, unit)
    turned = 1 if node.sign == "+" else -1
    if left.constant is not None and right.constant is not None:
        return constant(left.constant + turned * right.constant, unit)
    step = min(one.step for one in (left, right) if one.constant is None)

    def values(grid: Grid) -> FloatArray:
        one, other = left.values(grid), right.values(grid)
        return one + other if turned > 0 else one - other

    return Quantity(unit, values, step, {**left.periods_ns, **right.periods_ns})


def _product(binder: Binder, node: syntax.Arithmetic, left: Quantity, right: Quantity) -> Quantity:
    power = 1 if node.sign == "*" else -1
    if power < 0 and right.constant == 0:
        raise binder.refused(node, "is a division by 0")
    # A number of a signal's unit keeps that unit; anything else is in SI units.
    if right.unit.dimensions == ():
        unit = left.unit
    elif left.unit.dimensions == () and power > 0:
        unit = right.unit
    else:
        unit = product(left.unit, right.unit, power)
        left, right = _in_si(left), _in_si(right)
    if left.constant is not None and right.constant is not None:
        return constant(left.constant * right.constant**power, unit)
    step = 0.0
    if right.constant is not None:
        step = left.step * abs(float(right.constant**power))
    elif left.constant is not None and power > 0:
        step = right.step * abs(float(left.constant))

    def values(grid: Grid) -> FloatArray:
        one, other = left.values(grid), right.values(grid)
        if power > 0:
            return one * other
        # Nothing is known of a quotient whose divisor is 0.
        return np.divide(one, other, out=np.full_like(one, np.nan), where=other != 0)

    return Quantity(unit, values, step, {**left.periods_ns, **right.periods_ns})


def _in_si(value: Quantity) -> Quantity:
    return in_unit(value, Unit(value.unit.text, value.unit.dimensions, Fraction(1)))


def bind_call(binder: Binder, node: syntax.Call) -> Quantity:
    """A function of values, of a port or of an event.

    :raises SentenceError: units that do not fit, an unknown name, a window shorter than a period.
    """
    if node.port is not None:
        return _of_port(binder, node)
    if node.event is not None:
        event, tick_s = binder.condition(node.event), binder.names.tick_ns / 1e9
        return Quantity(given_unit("s"), lambda grid: _since(event.on(grid) > 0) * tick_s, tick_s)
    found = [binder.value(value) for value in node.values]
    for part, value in zip(node.values, found, strict=True):
        if value.words:
            raise binder.refused(part, "is a level, with which nothing can be computed")
    if node.time is not None:
        return _over_time(binder, node, found[0])
    return _of_values(binder, node, found)


def _of_port(binder: Binder, node: syntax.Call) -> Quantity:
    assert node.port is not None
    port = binder.port(node.port)
    if node.function == "age":
        return Quantity(given_unit("ms"), lambda grid: grid.age_ms(port), binder.names.tick_ns / 1e6)
    if node.function == "good":
        return Quantity(NUMBER, lambda grid: grid.good(port), 1.0)
    return Quantity(NUMBER, lambda grid: grid.bad(port), 1.0)


def _since(occurs: npt.NDArray[np.bool_]) -> FloatArray:
    """Ticks since the last one that is marked; NaN before the first one."""
    places = np.arange(len(occurs), dtype=np.float64)
    last = np.maximum.accumulate(np.where(occurs, places, -1.0))
    return np.where(last < 0, np.nan, places - last)


def _of_values(binder: Binder, node: syntax.Call, found: list[Quantity]) -> Quantity:
    first = found[0]
    if node.function == "abs":
        if first.constant is not None:
            return constant(abs(first.constant), first.unit)
        return replace(first, values=lambda grid: np.abs(first.values(grid)))
    one, other = found
    if one.unit.dimensions != other.unit.dimensions:
        raise binder.refused(node, f"{one.unit.quantity} stands beside {other.unit.quantity}")
    unit = other.unit if one.constant is not None else one.unit
    one, other = in_unit(one, unit), in_unit(other, unit)
    if one.constant is not None and other.constant is not None:
        pick = min if node.function == "min" else max
        return constant(pick(one.constant, other.constant), unit)
    choose = np.minimum if node.function == "min" else np.maximum
    step = min(value.step for value in (one, other) if value.constant is None)
    return Quantity(
        unit, lambda grid: choose(one.values(grid), other.values(grid)), step, {**one.periods_ns, **other.periods_ns}
    )


def _over_time(binder: Binder, node: syntax.Call, value: Quantity) -> Quantity:
    assert node.time is not None
    if value.constant is not None:
        raise binder.refused(node.values[0], "is a constant, which does not change over time")
    ticks = math.ceil(binder.window(node.time, value.periods_ns))
    if node.function == "before":
        return replace(value, values=lambda grid: _earlier(value.values(grid), ticks))
    if node.function in ("lowest", "highest"):
        sign = 1 if node.function == "highest" else -1
        return replace(value, values=lambda grid: sign * _highest(sign * value.values(grid), ticks))
    if node.function == "mean":
        return replace(value, step=value.step / ticks, values=lambda grid: _mean(value.values(grid), ticks))
    span_s = ticks * Fraction(binder.names.tick_ns, 10**9)
    per_s = product(value.unit, given_unit("s"), -1)
    factor = float(value.unit.factor / span_s)

    def rate(grid: Grid) -> FloatArray:
        values = value.values(grid)
        return (values - _earlier(values, ticks)) * factor

    return Quantity(per_s, rate, value.step * factor, value.periods_ns)


def _earlier(values: FloatArray, ticks: int) -> FloatArray:
    """The values so many ticks before; NaN where the record had not begun."""
    return np.concatenate([np.full(min(ticks, len(values)), np.nan), values[:-ticks]])


def _highest(values: FloatArray, ticks: int) -> FloatArray:
    """The largest value from so many ticks before to each tick; NaN where one of them is not known."""
    unknown = np.where(np.isnan(values), 1.0, 0.0)
    largest, is_unknown = (window_max(one[::-1], 0, ticks, 1.0)[::-1] for one in (values, unknown))
    return np.where(is_unknown > 0, np.nan, largest)


def _mean(values: FloatArray, ticks: int) -> FloatArray:
    """The mean of the last so many ticks; NaN where one of them is not known."""
    known = ~np.isnan(values)
    sums = np.concatenate([[0.0], np.cumsum(np.where(known, values, 0.0))])
    counts = np.concatenate([[0], np.cumsum(known)])
    found = np.full(len(values), np.nan)
    if len(values) >= ticks:
        mean = (sums[ticks:] - sums[:-ticks]) / ticks
        found[ticks - 1 :] = np.where(counts[ticks:] - counts[:-ticks] == ticks, mean, np.nan)
    return found
