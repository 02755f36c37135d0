"""The table of events of the report, and whether there is something unusual in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from railhil.judge.events.event import FAULT, LEVEL, MILESTONE, START, RecordedEvent
from railhil.judge.events.summary import level_shown

#: Kinds of events of every run.
_USUAL = (START, MILESTONE)


def has_unusual(events: Sequence[RecordedEvent]) -> bool:
    """Whether anything happened that does not happen in every run."""
    return any(event.kind not in _USUAL for event in events)


@dataclass(frozen=True, slots=True)
class EventRow:
    """Events of a run that differ only in their instants: the first and the last, their number, and what they are."""

    label: str
    first_s: float
    until_s: float
    count: int
    source: str
    what: str
    why: str
    is_fault: bool = False


def event_rows(label: str, events: Sequence[RecordedEvent]) -> list[EventRow]:
    """The table of events: those that differ only in their instants are one row, at the place of the first."""
    alike: dict[tuple[str, str, str, str, str], list[RecordedEvent]] = {}
    for event in events:
        alike.setdefault((event.source, event.kind, event.level, event.cause, event.detail), []).append(event)
    rows = []
    for (source, kind, level, cause, detail), own in alike.items():
        what = level_shown(level) if kind == LEVEL else kind.replace("_", " ")
        why = detail or cause.replace("_", " ")
        place = next((f"at {event.position_m:.4f} m" for event in own if event.position_m is not None), "")
        until_s = max(event.time_s + event.lasted_s for event in own)
        count = sum(event.count for event in own)
        said = f"{why} {place}".strip()
        rows.append(EventRow(label, own[0].time_s, until_s, count, source, what, said, kind == FAULT))
    return rows
