"""The evaluation of a run with a fault: each way in which it may differ from its entry is said."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from railhil.faults.model import WATCH_LEVELS
from railhil.judge.events.event import LEVEL, MILESTONE, REFUSED, RecordedEvent
from railhil.judge.reactions.catalogue import CATALOGUE, Entry, catalogue
from railhil.judge.reactions.evaluate import Row, Seen, evaluated
from railhil.systems.high_speed import CATALOGUE as HIGH_SPEED
from railhil.systems.line import CATALOGUE as LINE
from railhil.systems.stop import CATALOGUE as STOPPING

CATALOGUES = (CATALOGUE, HIGH_SPEED, STOPPING, LINE)
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
    stands_s=50.0,
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
        ({"ends": "standstill"}, {"stands_s": None}, "the train does not stand at the end"),
        ({"ends": "standstill"}, {}, None),
        ({"ends": "lost"}, {}, "run ended_complete: , expected the controller lost"),
        ({"ends": "lost"}, {"ended": "ended_controller_lost"}, None),
        ({"verdict": "INVALID", "said": "x"}, {"line": "x"}, "verdict PASS (x), expected INVALID"),
        ({"verdict": "PASS"}, {}, None),
        ({"detected": ("refused:gap",)}, {}, "not detected by refused:gap"),
        ({"within_ms": 9000}, {"events": (level("TRACTION CUT", 19.0, 20.0),)}, None),
    ],
)
def test_what_an_entry_demands_besides(entry: dict[str, Any], changed: dict[str, Any], said: str | None) -> None:
    assert row(entry, **changed).failures == ([said] if said else [])


def test_a_refusal_that_lasts_counts_from_the_effect() -> None:
    refused = RecordedEvent(9.0, "TRN_SPEED", REFUSED, "gap", until_s=12.0)
    found = row({"detected": ("refused:gap",)}, events=(refused, *SEEN.events))
    assert (found.failures, found.detected_s) == ([], 10.01)


SIGNS: dict[str, Any] = {
    "detected": ("DOOR_STAT.LeftState=fault",),
    "reaction": "NORMAL",
    "within_ms": None,
    "ends": "",
    "shows": {"DOOR_STAT.LeftState=fault": 500, "milestone:door_refused": 100},
    "never": {"milestone:departure": 5000},
}
REFUSED_ORDER = RecordedEvent(10.05, "plant", MILESTONE, "door_refused")


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({}, []),
        ({"states": {}}, ["does not show DOOR_STAT.LeftState=fault", "not detected by DOOR_STAT.LeftState=fault"]),
        (
            {"states": {"DOOR_STAT.LeftState=fault": (3.0, 10.61)}},
            ["DOOR_STAT.LeftState=fault after 600 ms, allowed 500 ms"],
        ),
        ({"events": SEEN.events}, ["does not show milestone:door_refused"]),
        (
            {"events": (*SEEN.events, REFUSED_ORDER, replace(REFUSED_ORDER, cause="departure", time_s=12.0))},
            ["shows milestone:departure at 12.00 s"],
        ),
        ({"events": (*SEEN.events, REFUSED_ORDER, replace(REFUSED_ORDER, cause="departure", time_s=16.0))}, []),
    ],
)
def test_milestones_and_states_are_shown_in_their_time_or_not_at_all(changed: dict[str, Any], said: list[str]) -> None:
    usual = {"events": (*SEEN.events, REFUSED_ORDER), "states": {"DOOR_STAT.LeftState=fault": (3.0, 10.2)}}
    assert row(SIGNS, **usual | changed).failures == said


def test_the_sign_with_the_smallest_margin_is_the_bound_of_a_row() -> None:
    found = row(SIGNS, events=(*SEEN.events, REFUSED_ORDER), states={"DOOR_STAT.LeftState=fault": (10.2,)})
    assert found.tightest == (pytest.approx(40.0), 100)
    assert found.as_json()["shown_s"]["milestone:door_refused"] == 10.05


@pytest.mark.parametrize("sign", ["milestone", "DOOR_STAT.LeftState", "door_stat.LeftState=fault", "timer:x"])
def test_a_sign_that_is_none_is_refused(sign: str) -> None:
    with pytest.raises(ValueError, match="shows"):
        Entry(**ENTRY | {"shows": {sign: 100}})


@pytest.mark.parametrize(
    ("steps", "said"),
    [
        ({"HOLD": 30, "TRACTION CUT": 70}, []),
        ({"HOLD": 10}, ["HOLD after 20 ms, allowed 10 ms"]),
        (
            {"HOLD": 10, "TRACTION CUT": 50},
            ["HOLD after 20 ms, allowed 10 ms", "TRACTION CUT after 60 ms, allowed 50 ms"],
        ),
    ],
)
def test_each_step_on_the_way_has_its_own_time(steps: dict[str, int], said: list[str]) -> None:
    events = (*SEEN.events, level("SERVICE BRAKE", 10.2, 11.0))
    found = row({"reaction": "SERVICE BRAKE", "within_ms": 250, "steps": steps}, events=events)
    assert found.failures == said


def test_a_broken_rule_of_every_run_is_a_difference() -> None:
    broken = "invariant 2: the train applies 10.0 kN of traction at TRACTION CUT, at 10.20 s"
    assert row(broken=("stop error +0.4 m", broken)).failures == [broken]


def test_a_run_that_is_not_judged_is_held_against_its_line() -> None:
    entry = {"verdict": "INVALID", "said": "plant lost", "reaction": None, "detected": (), "at_most": None}
    entry |= {"within_ms": None, "ends": ""}
    assert row(entry, verdict="INVALID", line="plant lost at 3 s", effective_s=None).failures == []
    assert row(entry, verdict="INVALID", line="no tick").failures == ["no tick: nothing of 'plant lost'"]
    assert row(entry).failures == ["verdict PASS, expected INVALID"]


def test_what_cannot_happen_in_a_run_is_no_run() -> None:
    assert row(begun_s=None, effective_s=None).refused == "its trigger does not occur in this run"
    idle = row({"idle": "no balises"}, effective_s=None)
    assert (idle.refused, idle.made, idle.failures) == ("no balises", False, [])
    assert row(effective_s=None).failures == ["the fault changed nothing"]


@pytest.mark.parametrize("file", CATALOGUES, ids=lambda file: file.parent.name)
def test_every_entry_has_a_level_a_cause_a_time_and_what_must_not_happen(file: Path) -> None:
    """An entry without one of them is refused: each is taken away from each entry of each catalogue."""
    for entry in catalogue(file):
        if not entry.faults:
            continue
        whole = entry.model_dump(exclude_defaults=True)
        assert Entry(**whole) == entry
        demanded = ["said"] if not entry.is_judged else ["detected", "reaction", "at_most"]
        demanded += ["within_ms"] if entry.within_ms else []
        demanded += ["limit"] if entry.is_undetected else []
        demanded += ["ends"] if entry.at_most == "EMERGENCY" else []
        for key in demanded:
            with pytest.raises(ValueError, match=f"{entry.id}: "):
                Entry(**{name: value for name, value in whole.items() if name != key})


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"within_ms": None}, "within_ms"),
        ({"reaction": "NORMAL"}, "within_ms"),
        ({"reaction": "EMERGENCY"}, "in the order of the ladder"),
        ({"steps": {"EMERGENCY": 10}}, "in the order of the ladder"),
        ({"steps": {"TRACTION CUT": 10}}, "in the order of the ladder"),
        ({"at_most": "EMERGENCY"}, "ends: standstill or lost"),
        ({"detected": ("nothing",)}, "only with reaction NORMAL"),
    ],
)
def test_demands_that_contradict_each_other_are_refused(changed: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Entry(**ENTRY | changed)


def test_entries_have_ids_of_their_own_and_one_kind() -> None:
    ids = [entry.id for entry in catalogue()]
    assert len(set(ids)) == len(ids)
    with pytest.raises(ValueError, match="either faults or seen_in"):
        Entry(id="T1", title="both", faults=("TRN_SPEED stuck @10s",), seen_in="there")
