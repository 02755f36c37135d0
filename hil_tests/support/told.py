"""Events of a run in short."""

from __future__ import annotations

from collections.abc import Iterable

from railhil.judge.events.event import RecordedEvent


def told(events: Iterable[RecordedEvent], *kinds: str) -> list[tuple[str, str, str]]:
    """Source, cause and level of the events, all or those of some kinds."""
    return [(event.source, event.cause, event.level) for event in events if not kinds or event.kind in kinds]
