"""Whether frames were lost, refused or reordered in a run."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

from railhil.judge.events.event import LOST, REFUSED, RecordedEvent

#: Counters of a node that do not indicate a fault.
_HEALTHY = ("sent", "received", "accepted", "polls", "unknown_id", "no_mailbox", "send_retries")


def disturbed(counters: Mapping[str, int]) -> dict[str, int]:
    """The counters that must be 0 on a healthy bus but are not."""
    return {cause: count for cause, count in counters.items() if count and cause not in _HEALTHY}


def disturbed_events(events: Iterable[RecordedEvent]) -> dict[str, int]:
    """Telegrams that the record shows as lost or refused, by what, port and cause; empty for a healthy bus.

    No counter of a node shows what was changed before all of them, or what another node of the bus should have taken.
    """
    found: Counter[str] = Counter()
    for event in events:
        if event.kind in (LOST, REFUSED):
            found[f"{event.kind} {event.source} ({event.cause})"] += event.count
    return dict(found)


def disturbed_run(folder: Path) -> dict[str, int]:
    """Counters of lost, refused or reordered frames of a run, from ``score.json`` of its folder.

    In real time a poll may be missed because the machine is busy; the verdict on the timing covers that.
    """
    run = json.loads((folder / "score.json").read_text(encoding="utf-8"))["run"]
    counters = dict(run["counters"])
    if run["pace"] == "lockstep" and run["timing"] is not None:
        counters["missed_polls"] = run["timing"]["missed_polls"]
    return disturbed(counters)
