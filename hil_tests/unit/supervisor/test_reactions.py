"""The evaluation of a run with a fault: each way in which it may differ from its entry is said."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from railhil.faults.model import WATCH_LEVELS
from railhil.supervisor.events.event import LEVEL, REFUSED, RecordedEvent
from railhil.supervisor.reactions.catalogue import Entry, catalogue
from railhil.supervisor.reactions.evaluate import Row, Seen, evaluated

ENTRY: dict[str, Any] = {
    "id": "T9",
    "title": "title",
    "faults": ("TRN_SPEED stuck @10s",),
    "detected": ("speed_age",),
    "reaction": "TRACTION CUT",
    "at_most": "SERVICE BRAKE",
    "within_ms": 100,
    "ends": "resumes",
}


def level(
    name: str, time_s: float, until_s: float, cause: str = "speed_age", source: str = "controller"
) -> RecordedEvent:
    return RecordedEvent(time_s, "controller", LEVEL, cause, name, until_s=until_s, rank=WATCH_LEVELS.index(name))


SEEN = Seen(
    begun_s=10.0,
    effective_s=10.01,
    events=(level("HOLD", 10.03, 10.07), level("TRACTION CUT", 10.07, 11.0)),
    stands=True,
    end_s=60.0,
    ended="ended_complete",
    verdict="PASS",
)


def row(entry: dict[str, Any] | None = None, **changed: Any) -> Row:
    return evaluated(Entry(**ENTRY | (entry or {})), replace(SEEN, **changed))


def test_a_run_as_its_entry_demands() -> None:
    found = row()
    assert found.failures == []
    assert found.after_ms == pytest.approx(60)
    assert found.margin_ms == pytest.approx(40)
    assert (found.detected_by, found.detected_s) == ("speed_age", 10.03)
    assert found.reaction == "TRACTION CUT"


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"effective_s": None}, "the fault changed nothing"),
        ({"events": ()}, "reached NORMAL, expected TRACTION CUT"),
        ({"events": (level("HOLD", 10.03, 10.07),)}, "reached HOLD, expected TRACTION CUT"),
        ({"events": (level("TRACTION CUT", 9.0, 10.0),)}, "reached NORMAL, expected TRACTION CUT"),
        ({"events": (level("TRACTION CUT", 10.12, 11.0),)}, "TRACTION CUT after 110 ms, allowed 100 ms"),
        ({"events": (level("EMERGENCY", 10.05, 11.0),)}, "reached EMERGENCY at 10.05 s, allowed SERVICE BRAKE"),
        ({"events": (level("TRACTION CUT", 10.05, 11.0, "overspeed"),)}, "not detected by speed_age"),
        ({"events": (level("TRACTION CUT", 10.05, 59.5),)}, "controller at TRACTION CUT until the end"),
        ({"ended": "ended_not_stopped"}, "run ended_not_stopped, expected to go on and stop"),
        ({"verdict": "INVALID", "line": "why"}, "verdict INVALID: why"),
    ],
)
def test_each_difference_is_said(changed: dict[str, Any], said: str) -> None:
    assert said in row(**changed).failures


@pytest.mark.parametrize(
    ("entry", "changed", "said"),
    [
        ({"ends": "standstill"}, {"stands": False}, "the train does not stand at the end"),
        ({"ends": "standstill"}, {}, None),
        ({"ends": "lost"}, {}, "run ended_complete: , expected the controller lost"),
        ({"ends": "lost"}, {"ended": "ended_controller_lost"}, None),
        ({"verdict": "INVALID"}, {"line": "x"}, "verdict PASS (x), expected INVALID"),
        ({"verdict": "PASS"}, {}, None),
        ({"detected": ("refused:gap",)}, {}, "not detected by refused:gap"),
        ({"within_ms": None}, {"events": (level("TRACTION CUT", 19.0, 20.0),)}, None),
    ],
)
def test_what_an_entry_demands_besides(entry: dict[str, Any], changed: dict[str, Any], said: str | None) -> None:
    assert row(entry, **changed).failures == ([said] if said else [])


def test_a_refusal_that_lasts_counts_from_the_effect() -> None:
    refused = RecordedEvent(9.0, "TRN_SPEED", REFUSED, "gap", until_s=12.0)
    found = row({"detected": ("refused:gap",)}, events=(refused, *SEEN.events))
    assert (found.failures, found.detected_s) == ([], 10.01)


def test_entries_have_ids_of_their_own_and_one_kind() -> None:
    ids = [entry.id for entry in catalogue()]
    assert len(set(ids)) == len(ids)
    with pytest.raises(ValueError, match="either faults or seen_in"):
        Entry(id="T1", title="both", faults=("TRN_SPEED stuck @10s",), seen_in="there")
