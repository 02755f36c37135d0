"""The injected faults of a run as events, beside the reactions that they led to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from railhil.common.errors import InputError
from railhil.judge.events.event import FAULT, RecordedEvent

#: Largest number of faults named in the line of a verdict; the others are counted.
_SAID_MAX = 3


def fault_events(found: Iterable[Mapping[str, Any]], end_s: float) -> Iterator[RecordedEvent]:
    """One event for each fault that became active, from then until its end; ``count``: the number of its changes.

    :param found: entries of ``injected`` in ``certificate.json``
        (:meth:`railhil.judge.fault_report.FaultOutcome.as_json`).
    :param end_s: end of the record, until which a fault without an end lasts.
    """
    for one in found:
        if one["begun_s"] is None:
            continue
        hits, until_s = one["hits"], one["ended_s"]
        effect = f"{hits} hits, first at {one['effect_s']:.2f} s" if hits else "changed nothing"
        place, cause = _parts(one["fault"])
        detail = f"fault {one['number']}: {one['fault']}: {effect}"
        end_of_it = end_s if until_s is None else until_s
        yield RecordedEvent(one["begun_s"], place, FAULT, cause, count=hits, until_s=end_of_it, detail=detail)


def _parts(text: str) -> tuple[str, str]:
    """Place and effect of a fault, without its time: ``TRN_SPEED`` and ``loss 30%``."""
    # A run without faults does not load their language.
    from railhil.faults.language import fault_text, parse
    from railhil.faults.notation import place_text

    try:
        fault = parse(text, "injected")
    except InputError:
        # Written by another version.
        place, _, rest = text.partition(" ")
        return place, rest
    place = place_text(fault.place)
    return place, fault_text(fault, judging=False).split(" @")[0].removeprefix(place).strip()


def faults_said(events: Sequence[RecordedEvent]) -> list[str]:
    """The faults that changed something, in words for the line of the verdict."""
    own = [event for event in events if event.kind == FAULT and event.count]
    said = [f"fault {event.source} {event.cause} from {event.time_s:.2f} s" for event in own[:_SAID_MAX]]
    return [*said, *([f"{len(own) - _SAID_MAX} more faults"] if len(own) > _SAID_MAX else [])]
