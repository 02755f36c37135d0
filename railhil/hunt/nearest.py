"""The nearest case that keeps a requirement: what changed the verdict."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import zip_longest

from railhil.faults.language import parse
from railhil.faults.model import Fault

#: A fault without an end, or that another condition than an instant begins, differs by so much, in s.
_FAR_S = 1e4
#: A telegram more or less counts as so much, in s.
_EACH_S = 0.01


def nearest_case(least: Sequence[str], others: Iterable[tuple[str, ...]]) -> tuple[str, ...] | None:
    """The one of other cases that differs least from a case: first in the number of faults that are others, then in
    their times, counts and values; of several the first. None: there is none.

    :param least: texts of the faults of the case; ``others``: likewise.
    """
    return min(others, key=lambda other: _distance(least, other), default=None)


def _distance(least: Sequence[str], other: Sequence[str]) -> tuple[int, float]:
    differing, amount = 0, 0.0
    for one, two in zip_longest(least, other):
        if one == two:
            continue
        differing += 1
        amount += _FAR_S**2 if one is None or two is None else _difference(parse(one), parse(two))
    return differing, amount


def _difference(one: Fault, other: Fault) -> float:
    if (one.place, one.what) != (other.place, other.what):
        return _FAR_S**2
    values = (
        abs(value - theirs) / max(abs(value), abs(theirs))
        for name, value in one.values.items()
        if isinstance(value, int | float) and isinstance(theirs := other.values.get(name), int | float)
        if value != theirs
    )
    return (
        abs(_begin_s(one) - _begin_s(other))
        + abs(_length_s(one) - _length_s(other))
        + _EACH_S * abs((one.count or 0) - (other.count or 0))
        + sum(values)
    )


def _begin_s(fault: Fault) -> float:
    return float(fault.trigger.value) if fault.trigger.kind == "time" else _FAR_S


def _length_s(fault: Fault) -> float:
    return _FAR_S if fault.duration_s is None and fault.count is None else fault.duration_s or 0.0
