"""The table of events of report.html."""

from __future__ import annotations

from railhil.judge.events.event import MILESTONE, RecordedEvent
from railhil.report.tables import event_rows


def test_events_that_differ_only_in_instant_and_place_are_one_row_with_first_and_last() -> None:
    places_m = (0.0, 700.0, 1400.0)
    alike = [
        RecordedEvent(10.0 * place, "plant", MILESTONE, "doors_open", position_m=m) for place, m in enumerate(places_m)
    ]
    other = RecordedEvent(5.0, "plant", MILESTONE, "turn_back", position_m=1400.0)
    rows = event_rows("", [*alike, other])
    assert [(row.first_s, row.until_s, row.count, row.why) for row in rows] == [
        (0.0, 20.0, 3, "doors open from 0.0000 m to 1400.0000 m"),
        (5.0, 5.0, 1, "turn back at 1400.0000 m"),
    ]
