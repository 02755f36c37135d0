"""One event of a run, and the table ``events.csv``."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

#: Name in a run folder.
EVENTS = "events.csv"
#: A watch has left its level NORMAL; the cause may change while it lasts, which is an event of its own.
LEVEL = "level"
#: A node outside its normal work: a watch before the first command, a controller that initialises, has ended, or sends
#: a level that there is not.
START = "start"
#: Telegrams that their receiver refuses.
REFUSED = "refused"
#: Periodic telegrams that are not in the record.
LOST = "lost"
#: Polls without a good answer.
MISSED_POLL = "missed_poll"
#: An interlock or status of the train differs from normal operation.
INTERLOCK = "interlock"
#: An injected fault is active.
FAULT = "fault"
#: RUN_EVENT.
MILESTONE = "milestone"

#: Columns of ``events.csv``.
COLUMNS = ("time_s", "until_s", "source", "kind", "level", "cause", "count", "position_m", "detail")
#: Times are on the wire in 0.1 ms, positions in 0.1 mm.
_DIGITS = 4


@dataclass(frozen=True, slots=True)
class RecordedEvent:
    """An event at an instant of simulation time.

    ``source``: who reports it or, for telegrams, their port; ``kind``: one of this module's; ``cause``: in the words of
    the wire contract or of the receiver's counters. ``level``: of a watch. ``count``: number of telegrams merged into
    the event. ``until_s``: end of a state, or instant of the last merged telegram; None for a single instant.
    ``position_m``: true position, where the record states it. ``detail``: the cause in words. ``rank``: strength of the
    level, its place in the ladder of its watch; 0 for everything else.
    """

    time_s: float
    source: str
    kind: str
    cause: str
    level: str = ""
    count: int = 1
    until_s: float | None = None
    position_m: float | None = None
    detail: str = ""
    rank: int = 0

    @property
    def lasted_s(self) -> float:
        """Time between its first and its last instant, in s."""
        return 0.0 if self.until_s is None else self.until_s - self.time_s


def in_order(*found: Iterable[RecordedEvent]) -> tuple[RecordedEvent, ...]:
    """Events of several sources in the order of their instants; at the same instant the events of the first source come
    first."""
    return tuple(sorted((event for events in found for event in events), key=lambda event: event.time_s))


def write_events(events: Iterable[RecordedEvent], path: Path) -> None:
    """Write ``events.csv``: one row per event in the order given; missing properties are empty."""
    with path.open("w", encoding="utf-8", newline="") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(COLUMNS)
        for event in events:
            rows.writerow(_cell(getattr(event, column)) for column in COLUMNS)


def _cell(value: object) -> object:
    return round(value, _DIGITS) if isinstance(value, float) else "" if value is None else value
