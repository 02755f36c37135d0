"""Injected faults stand in the one list of events: after a run, and again from its folder."""

from __future__ import annotations

import csv
import json
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

import railhil
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.cli import main
from railhil.judge.events.summary import fault_events, faults_said
from railhil.report.tables import event_rows
from railhil.scenarios.run_spec import RunSpec
from railhil.testing.live import Live

pytestmark = pytest.mark.faults

LOSS = "TRN_SPEED loss 100% @1s for 100ms"
DETAIL = "fault 1: TRN_SPEED loss @1s for 100ms: 10 hits, first at 1.00 s"


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> railhil.Outcome:
    folder = tmp_path_factory.mktemp("faults")
    (folder / "short.toml").write_text(RUN_2M_TOML)
    spec = RunSpec(str(folder / "short.toml"), bus="local", faults=(LOSS, "TRN_POS loss @10s"))
    return railhil.run(spec, bus="local", out=folder / "run")


def test_a_fault_is_an_event_from_its_beginning_to_its_end(outcome: railhil.Outcome) -> None:
    (event,) = [event for event in outcome.events if event.kind == "fault"]
    assert (event.source, event.cause, event.time_s, event.until_s, event.count) == ("TRN_SPEED", "loss", 1.0, 1.1, 10)
    assert event.detail == DETAIL
    rows = list(csv.DictReader((outcome.folder / "events.csv").open(newline="")))
    assert [row["detail"] for row in rows if row["kind"] == "fault"] == [DETAIL]
    # It stands before what it led to, also in the report.
    assert [event.kind for event in outcome.events if event.time_s >= 1.0][:2] == ["fault", "lost"]
    assert [row.why for row in event_rows("", outcome.events) if row.is_fault] == [DETAIL]


def test_every_document_of_the_run_names_it(outcome: railhil.Outcome) -> None:
    score = json.loads((outcome.folder / "score.json").read_text())
    assert score["events"]["faults"] == [{"time_s": 1.0, "until_s": 1.1, "hits": 10, "detail": DETAIL}]
    assert score["why"].endswith("; fault TRN_SPEED loss from 1.00 s")
    properties = ET.parse(outcome.folder / "junit.xml").getroot().iter("property")
    assert [one.get("value") for one in properties if one.get("name") == "fault"] == [DETAIL]


def test_the_folder_gives_the_same_list(outcome: railhil.Outcome, capsys: pytest.CaptureFixture[str]) -> None:
    opened = railhil.open_run(outcome.folder)
    assert opened.events == outcome.events
    assert opened.why == outcome.why
    main(["score", "--json", str(outcome.folder)])
    assert json.loads(capsys.readouterr().out)["why"] == outcome.why


def test_a_run_held_by_a_test_has_them_too(outcome: railhil.Outcome, tmp_path: Path) -> None:
    spec = RunSpec(str(outcome.folder.parent / "short.toml"), bus="local", faults=(LOSS,))
    with Live(spec, spec.load(), tmp_path, lambda run: None) as live:
        run = live.finish()
    assert [event.detail for event in run.events if event.kind == "fault"] == [DETAIL]
    assert run.events == railhil.open_run(tmp_path).events


def entry(number: int, **keys: object) -> dict[str, object]:
    usual = {"fault": "speed stuck @60s", "begun_s": 60.0, "effect_s": 60.01, "ended_s": None, "hits": 3}
    return {"number": number, **usual, **keys}


def test_a_fault_without_an_end_lasts_to_the_end_of_the_record() -> None:
    found = [entry(1), entry(2, begun_s=None), entry(3, fault="bus.a open wide @1s", effect_s=None, hits=0)]
    first, unread = fault_events(found, 90.0)
    assert (first.source, first.cause, first.until_s) == ("speed", "stuck", 90.0)
    assert unread.detail == "fault 3: bus.a open wide @1s: changed nothing"
    assert (unread.source, unread.cause) == ("bus.a", "open wide @1s")


def test_the_line_names_three_faults_that_changed_something() -> None:
    found = [entry(1, hits=0), *(entry(number) for number in range(2, 7))]
    assert faults_said(list(fault_events(found, 90.0))) == [*["fault speed stuck from 60.00 s"] * 3, "2 more faults"]


def test_a_train_stronger_than_its_transducer_shows_the_end_of_its_range(tmp_path: Path) -> None:
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    spec = RunSpec(str(tmp_path / "short.toml"), bus="local", faults=("traction scale 10 @1s",))
    run = railhil.run(spec, bus="local", out=tmp_path / "run")
    assert run.verdict != "TOOL ERROR"
    trace = run.trace
    assert trace.values("TRN_POS", "EffortActual").max() == pytest.approx(200.0, abs=0.01)
    # The truth is not cut off.
    assert trace.values("SIM_TRUTH", "TrueAccel").max() > 2.0
