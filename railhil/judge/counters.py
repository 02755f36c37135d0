"""Rules about telegrams that hold in every run: the record compared with the nodes' own counters.

1. No telegram that failed a check reaches the control law or the actuators: a node does not accept more telegrams than
   the record shows good.
6. The counters reconcile: each telegram in the record was accepted, refused for a cause, or kept from the node by a
   fault.

The numbers follow the specification of the bench. :mod:`railhil.judge.reception` decides which telegrams of the
record are good. A node may refuse more (a speed that is not plausible), and reports it. A node that does not report is
not checked (:func:`unchecked`). Where frames can be lost between node and recorder, and for mailboxes read by a task,
only rule 1 is checked, without the life signs. A telegram that only the recorder has missed is then no breach but a gap
of the record (:mod:`railhil.judge.record_checks`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from railhil.bus.codes import ends_run
from railhil.bus.telegrams import RunEvent
from railhil.common.digits import count_of
from railhil.judge.declared import Received
from railhil.judge.judging import judging_of
from railhil.judge.reception import Stretch, bad_content, is_exact, judged_of, stretches
from railhil.judge.record_checks import UNCLEAR, Unseen
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario

#: Nodes that report.
REPORTING = ("controller", "plant")
#: Causes that the record shows; a node may refuse for others.
_SHOWN = ("duplicate", "out_of_order", "check_variable", "out_of_range")
#: Causes of the traffic store that it finds in the frames of a port alone.
_OF_FRAMES = (
    "wrong_length", "wrong_check_sequence", "wrong_block_count", "missing_block", "assembly_timeout", "no_answer",
)  # fmt: skip


def unreconciled(scenario: AnyScenario, trace: Trace) -> list[str]:
    """One sentence for the first breach of each rule, or for a gap of the record that hides it
    (:mod:`railhil.judge.record_checks`). Empty for a run that keeps the rules, and without reports."""
    told = trace.reported
    if told is None:
        return []
    found: dict[str, str] = {}
    items = {item.port: item for item in judging_of(scenario).received(scenario)}
    unseen = Unseen(scenario, trace)
    for node, counts in told.nodes.items():
        exact = is_exact(scenario, trace, node)
        for port, own in counts["ports"].items():
            item = items.get(port)
            if exact:
                breaches = _port(trace, node, port, own, counts["gaps"], item)
            else:
                breaches = _taken(trace, node, port, own, item, unseen)
            for said in breaches:
                found.setdefault(said[: len("invariant 6")], said)
        if exact:
            for said in _frames(trace, node, counts):
                found.setdefault(said[: len("invariant 6")], said)
    return [found[rule] for rule in sorted(found)]


def unchecked(trace: Trace) -> str:
    """Nodes whose counters are unknown, in words; empty: all are known."""
    nodes = {} if trace.reported is None else trace.reported.nodes
    return " and ".join(node for node in REPORTING if node not in nodes)


def _taken(
    trace: Trace, node: str, port: str, own: Mapping[str, Any], item: Received | None, unseen: Unseen
) -> Iterator[str]:
    """The breach of rule 1 at one port whose other counters cannot be compared."""
    if item is None or "accepted" not in own:
        return
    wrong, outside = bad_content(trace, item)
    bad = int((wrong | outside).sum())
    surplus = own["accepted"] - (trace.count(port) - bad)
    if surplus <= 0:
        return
    bad += sum(one.source == port for one in trace.refused)
    if not unseen.is_whole and (surplus > bad or unseen.count(port)):
        yield f"{UNCLEAR}the {node} took {count_of(surplus, f'{port} telegram')} that the record does not show"
    else:
        yield from _too_many(node, port, surplus)


def _port(
    trace: Trace, node: str, port: str, own: Mapping[str, Any], gaps: list[Mapping[str, Any]], item: Received | None
) -> Iterator[str]:
    """The breaches at one port."""
    heard = stretches(own["committed"], port, gaps)
    if heard is None or not _is_the_rest(trace, port, heard[-1].after):
        kept = sum(gap["ports"][port]["count"] for gap in gaps if port in gap["ports"])
        yield (
            f"invariant 6: {count_of(trace.count(port), f'{port} telegram')} in the record, "
            f"the {node} received {own['committed']}" + (f" and {kept} were kept from it" if kept else "")
        )
        return
    if "accepted" not in own:
        return
    refused = own.get("refused", {})
    accounted = own["accepted"] + sum(refused.values())
    came = count_of(own["committed"], f"{port} telegram")
    if item is None:
        # A safe channel also begins with telegrams that it neither uses nor refuses.
        if accounted > own["committed"]:
            yield f"invariant 6: the {node} received {came} and accounts for {accounted}"
        return
    causes = [cause for _, cause in judged_of(trace, item, heard if gaps or not _is_all(trace, port, heard) else None)]
    good = own["committed"] - len(causes)
    if own["accepted"] > good:
        yield from _too_many(node, port, own["accepted"] - good)
    for cause in _SHOWN:
        told, shown = refused.get(cause, 0), causes.count(cause)
        if told != shown:
            words = cause.replace("_", " ")
            one = f"{port} telegram"
            yield f"invariant 6: the {node} refused {count_of(told, one)} ({words}), the record shows {shown}"
    if accounted != own["committed"]:
        yield f"invariant 6: the {node} received {came} and accounts for {accounted}"


def _too_many(node: str, port: str, surplus: int) -> Iterator[str]:
    yield f"invariant 1: the {node} took {count_of(surplus, f'{port} telegram')} that the record does not show good"


def _is_all(trace: Trace, port: str, heard: list[Stretch]) -> bool:
    return len(heard) == 1 and heard[0].after == trace.count(port)


def _is_the_rest(trace: Trace, port: str, after: int) -> bool:
    """Whether there are no telegrams from a number on, or only after the end, when the node may have left."""
    times_ns = trace.times_ns(port)
    if after >= len(times_ns):
        return after == len(times_ns)
    kinds = trace.raw(RunEvent.PORT, "RunEvent").tolist()
    ends_ns = [time_ns for time_ns, kind in zip(trace.times_ns(RunEvent.PORT), kinds, strict=True) if ends_run(kind)]
    return bool(ends_ns) and times_ns[after] >= min(ends_ns)


def _frames(trace: Trace, node: str, counts: Mapping[str, Any]) -> Iterator[str]:
    """Frames refused by the traffic store; during a gap the node did not get them."""
    own = set(counts["ports"])
    for cause in _OF_FRAMES:
        noted = (*trace.refused, *trace.no_answers)
        shown = sum(one.cause == cause and one.source in own for one in noted)
        told = counts["frames"].get(cause, 0)
        if told > shown or (told < shown and not counts["gaps"]):
            words = cause.replace("_", " ")
            yield f"invariant 6: the {node} refused {count_of(told, 'frame')} ({words}), the record shows {shown}"
