"""Comparison of a fault's expectation (``expect``) with the run: an unmet expectation is a FAIL."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from railhil.judge.events.event import LEVEL, RecordedEvent
from railhil.judge.record_checks import UNCLEAR, Unseen
from railhil.judge.score import Score

if TYPE_CHECKING:
    from railhil.faults.model import Expect
    from railhil.record.trace import Trace

#: Tolerance of the bound: instants are on the wire in 0.1 ms.
_SLACK_S = 1e-4


def with_expectations(
    found: Score, injected: Iterable[Mapping[str, Any]], events: Sequence[RecordedEvent], scenario: Any, trace: Trace
) -> Score:
    """The score of a run, with the unmet expectations of its faults among the failures.

    If the record may lack reports of the train's watch from the fault on, it is INVALID: the reaction may have come.

    :param injected: entries of ``injected`` in ``certificate.json``.
    """
    if found.verdict not in ("PASS", "FAIL"):
        return found
    unmet: list[str] = []
    for one in injected:
        if said := list(_unmet(one, found.verdict, events)):
            if unseen := _unseen(float(one["effect_s"]), scenario, trace):
                return replace(found, verdict="INVALID", failures=(f"{unseen}: {'; '.join(said)}",))
            unmet += said
    return replace(found, verdict="FAIL", failures=(*found.failures, *unmet)) if unmet else found


def _unseen(effect_s: float, scenario: Any, trace: Trace) -> str:
    """The reports of a watch that the record may lack from an instant on, in words; empty: none.

    No node has seen reports that a fault of the run keeps from the bus. The polls of a polled watch are recorded.
    """
    from railhil.faults import parse_faults
    from railhil.judge.judging import judging_of

    unseen = Unseen(scenario, trace)
    disturbed = {fault.place.name for fault in parse_faults(scenario.faults)}
    for port in dict.fromkeys(watch.port for watch in judging_of(scenario).watches):
        published = trace.count(port) and trace.contract.port(port).mode != "poll"
        if published and port not in disturbed and (count := unseen.count(port, effect_s)):
            return f"{UNCLEAR}{count} {port} are missing"
    return ""


def _unmet(one: Mapping[str, Any], verdict: str, events: Sequence[RecordedEvent]) -> Iterator[str]:
    # A run without faults does not load their language.
    from railhil.faults.language import parse

    expect, effect_s = parse(str(one["fault"]), "injected").expect, one["effect_s"]
    if expect is None or effect_s is None:
        return
    for text in _differences(expect, float(effect_s), verdict, events):
        yield f"fault {one['number']}: {text}"


def _differences(expect: Expect, effect_s: float, verdict: str, events: Sequence[RecordedEvent]) -> Iterator[str]:
    from railhil.faults.model import WATCH_LEVELS

    levels = [event for event in events if event.kind == LEVEL and event.time_s >= effect_s - _SLACK_S]
    if expect.level:
        wanted = WATCH_LEVELS.index(expect.level)
        reached = next((event for event in levels if event.rank >= wanted), None)
        after_s = None if reached is None else reached.time_s - effect_s
        if after_s is None:
            strongest = max((event.rank for event in levels), default=0)
            yield f"expected {expect.level}, reached {WATCH_LEVELS[strongest]}"
        elif expect.within_s is not None and after_s > expect.within_s + _SLACK_S:
            yield f"expected {expect.level} within {expect.within_s * 1e3:.0f} ms, came after {after_s * 1e3:.0f} ms"
    if expect.detected_by and expect.detected_by not in {event.cause for event in levels}:
        causes = ", ".join(dict.fromkeys(event.cause for event in levels)) or "nothing"
        yield f"expected to be detected by {expect.detected_by}, was by {causes}"
    if expect.verdict and expect.verdict != verdict:
        yield f"expected the verdict {expect.verdict}, is {verdict}"
