"""The telegrams of a record that their receivers have heard, refused and taken."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.lifesign import LifeSign
from railhil.faults import parse_faults
from railhil.judge.declared import Received
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario

BoolArray: TypeAlias = npt.NDArray[np.bool_]
_LIFE_VALUES = 16


class Stretch(NamedTuple):
    """Telegrams of a port by their numbers in the record, from ``first`` up to ``after``; ``anew``: the receiver has
    forgotten earlier ones."""

    first: int
    after: int
    anew: bool = False


def bad_content(trace: Trace, item: Received) -> tuple[BoolArray, BoolArray]:
    """Marks the telegrams of a port with a wrong check variable, and with a value out of range; shape (n,)."""
    check_failed = np.zeros(trace.count(item.port), dtype=bool)
    for name in item.checks:
        check_failed |= trace.raw(item.port, name) != CHECK_CORRECT
    outside = np.zeros_like(check_failed)
    for name, (lowest, highest) in item.ranges.items():
        raw = trace.raw(item.port, name)
        outside |= (raw < lowest) | (raw > highest)
    return check_failed, outside


def judged_of(trace: Trace, item: Received, heard: Sequence[Stretch] | None) -> Iterator[tuple[int, str]]:
    """The telegrams of one port that its receiver refuses: number in the record, and cause.

    :param heard: the telegrams that the receiver has heard; None: all.
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


def judged(scenario: AnyScenario, trace: Trace, item: Received) -> Iterator[tuple[int, str]]:
    """As :func:`judged_of`, of the telegrams that the receiver has heard by its own report."""
    return judged_of(trace, item, _heard(scenario, trace, item.port))


def taken(scenario: AnyScenario, trace: Trace, item: Received) -> BoolArray:
    """Whether the receiver has taken each telegram of a port, shape (n,): it has heard and not refused it."""
    heard = _heard(scenario, trace, item.port)
    found = np.full(trace.count(item.port), heard is None)
    for stretch in heard or ():
        found[stretch.first : stretch.after] = True
    found[[number for number, _ in judged_of(trace, item, heard)]] = False
    return found


def shown(scenario: AnyScenario, trace: Trace, item: Received) -> BoolArray:
    """Whether each telegram of a port shows what its sender is like, shape (n,): its receiver has taken it, or would
    take it if it had heard all. What a fault keeps from the receiver is no less true."""
    good = np.ones(trace.count(item.port), dtype=bool)
    good[[number for number, _ in judged_of(trace, item, None)]] = False
    return good | taken(scenario, trace, item)


def is_exact(scenario: AnyScenario, trace: Trace, node: str) -> bool:
    """Whether the counters that a node reports can be compared with the record one by one."""
    told = trace.reported
    if told is None or not told.exact or node not in told.nodes or told.nodes[node].get("by_task"):
        return False
    # Frames of a node on identifiers that it reads itself: the record has them, the node does not hear them.
    return not any(fault.what == "masquerade" for fault in parse_faults(scenario.faults))


def _heard(scenario: AnyScenario, trace: Trace, port: str) -> list[Stretch] | None:
    """The telegrams of a port that its receiver has heard, by the gaps that it reports; None: all, or not known."""
    for node, counts in trace.reported.nodes.items() if trace.reported is not None else ():
        if port in counts["ports"] and counts["gaps"] and is_exact(scenario, trace, node):
            return stretches(counts["ports"][port]["committed"], port, counts["gaps"])
    return None


def stretches(committed: int, port: str, gaps: Sequence[Mapping[str, Any]]) -> list[Stretch] | None:
    """The telegrams of a port that a node has heard; None if they contradict its gaps.

    :param committed: number of telegrams that it has heard.
    :param gaps: as it reports them (:mod:`railhil.bus.reception`).
    """
    found, begun, anew, left = [], 0, False, committed
    for gap in gaps:
        if port not in gap["ports"]:
            return None
        first, count = gap["ports"][port]["first"], gap["ports"][port]["count"]
        left -= first - begun
        if first < begun or left < 0:
            return None
        found.append(Stretch(begun, first, anew))
        begun, anew = first + count, (anew and first == begun) or gap["restarted"]
    return [*found, Stretch(begun, begun + left, anew)]
