"""A requirement with a tighter bound: a shorter time, or a limit that is nearer to what runs showed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from railhil.common.errors import InputError
from railhil.judge.requirements import syntax
from railhil.judge.requirements.binding import Binder
from railhil.judge.requirements.names import Names
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.units import given_unit

#: Significant digits of a limit.
_DIGITS = 5
_OPPOSITE = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}
_TURNED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}


@dataclass(frozen=True, slots=True)
class Tighter:
    """A requirement with another bound. ``was``, ``bound``: texts of both bounds. ``beyond``: the requirement with the
    next tighter one, which the run that gives the bound violates; None: no sentence can say it."""

    requirement: Requirement
    was: str
    bound: str
    beyond: Requirement | None


def tighter(requirement: Requirement, names: Names, slack_s: float | None, margin: float | None) -> Tighter | None:
    """The requirement with the tightest bound that runs have kept; None: it has no bound of its own that runs leave
    room to.

    :param slack_s: the least time that a reaction left of the allowed time. ``margin``: the nearest of the condition,
        in its own unit. Both of runs that keep the requirement.
    :raises InputError: it does not fit the scenario.
    """
    bound = requirement.bind(names)
    body = bound.sentence.body
    window = _window(body)
    if window is not None:
        if slack_s is None:
            return None
        shortest_ns = max((names.tick_ns, *bound.condition.periods_ns.values()))
        return _with_time(requirement, names, window, slack_s, shortest_ns)
    condition = body.condition
    if margin is None or margin <= 0 or not isinstance(condition, syntax.Compare) or condition.sign not in _OPPOSITE:
        return None
    return _with_limit(requirement, names, body, condition, margin)


def _window(body: syntax.Body) -> syntax.Number | None:
    """The time that a sentence allows."""
    if isinstance(body, syntax.Whenever):
        return body.last
    if isinstance(body, syntax.Eventually):
        return body.within
    return body.longer if isinstance(body, syntax.Never) else None


def _with_time(
    requirement: Requirement, names: Names, window: syntax.Number, slack_s: float, shortest_ns: int
) -> Tighter | None:
    time_ns = Binder(requirement.says, names, {}).time_ns(window)
    used_ns = math.floor(time_ns / names.tick_ns) * names.tick_ns - round(slack_s * 1e9)
    bound_ns = max(used_ns, shortest_ns)
    if bound_ns >= time_ns:
        return None
    text, beyond_ns = f"{bound_ns / 1e6:g} ms", bound_ns - names.tick_ns
    tight = _replaced(requirement, window, text)
    # A window of which a sentence cannot say less was not reached by any run.
    beyond = _replaced(requirement, window, f"{beyond_ns / 1e6:g} ms") if beyond_ns >= shortest_ns else None
    if used_ns < shortest_ns:
        beyond = None
    return _fitting(Tighter(tight, requirement.says[window.column : window.after], text, beyond), names)


def _with_limit(
    requirement: Requirement, names: Names, body: syntax.Body, condition: syntax.Compare, margin: float
) -> Tighter | None:
    binder = Binder(requirement.says, names, dict(requirement.define))
    binder = binder.with_scores() if isinstance(body, syntax.At) else binder
    left = binder.value(condition.left)
    if left.words:
        return None
    right = binder.value(condition.right)
    if right.words or (left.constant is None) == (right.constant is None):
        return None
    is_left = left.constant is not None
    node, value, unit = (condition.left, left, right.unit) if is_left else (condition.right, right, left.unit)
    sign = _TURNED[condition.sign] if is_left else condition.sign
    sign = _OPPOSITE[sign] if isinstance(body, syntax.Never) else sign
    assert value.constant is not None
    # A limit is given in the unit that the sentence has, if it has one.
    shown = given_unit(node.unit) if isinstance(node, syntax.Number) and node.unit else unit
    limit, ratio = float(value.constant * value.unit.factor / shown.factor), float(unit.factor / shown.factor)
    step = (right if is_left else left).step
    texts = list(_limits(limit, margin * ratio, step * ratio, is_upper=sign in ("<", "<=")))
    was = requirement.says[node.column : node.after]
    words = [f"{text} {shown.name}".rstrip() for text in texts]
    tight, beyond = (_replaced(requirement, node, word) for word in words)
    if (float(texts[0]) >= limit) == (sign in ("<", "<=")):
        return None
    return _fitting(Tighter(tight, was, words[0], beyond), names)


def _limits(limit: float, margin: float, step: float, *, is_upper: bool) -> Iterator[str]:
    """The limit that leaves almost nothing of the margin, and one that is too tight, as numbers of a sentence.

    :param step: resolution of the value; both lie farther from it than two sides that count as equal.
    """
    exact = limit - margin if is_upper else limit + margin
    size = max(abs(exact), abs(limit) * 1e-3, 1e-9)
    power = math.floor(math.log10(size)) - _DIGITS + 1
    if step:
        power = max(power, math.floor(math.log10(step)) - 1)
    unit = Fraction(10) ** power
    away = 1 if is_upper else -1
    kept = round(Fraction(exact) / unit) + away
    for units in (kept, kept - 3 * away):
        yield f"{float(units * unit):.{max(0, -power)}f}"


def _replaced(requirement: Requirement, node: syntax.Node, text: str) -> Requirement:
    says = requirement.says
    return replace(requirement, says=says[: node.column] + text + says[node.after :])


def _fitting(found: Tighter, names: Names) -> Tighter | None:
    """The same, without sentences that the language refuses."""
    try:
        found.requirement.bind(names)
    except InputError:
        return None
    return found
