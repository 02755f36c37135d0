"""Events of a run: what happened and why, from the record alone."""

from __future__ import annotations

import csv
import json
import lzma
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import railhil
from hil_tests.support.cli import Done
from hil_tests.support.cli import railhil as command
from hil_tests.support.disturbed import Disturbance, damaged, disturbed_run
from hil_tests.support.paths import TEST_DATA
from hil_tests.support.recordings import row_of
from hil_tests.support.short_runs import RUN_72M_TOML
from hil_tests.support.told import told
from railhil.bus.frame import Frame
from railhil.judge.events.event import COLUMNS
from railhil.judge.events.summary import explained, summary, why
from railhil.judge.events.telegrams import events_of
from railhil.judge.judging import judging_of
from railhil.judge.record import Record, checked_record
from railhil.report.page import page
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd, TrnPos, TrnSpeed

#: Events of every run.
USUAL = [("train", "start", "no_command"), *(("plant", "milestone", name) for name in ("departed", "stopped"))]


@pytest.fixture(scope="module")
def short_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    # The law stops this short run 4 m too early.
    path.write_text(RUN_72M_TOML + "stop_error_max_m = 10\n")
    return path


@pytest.fixture(scope="module")
def short(short_file: Path) -> Scenario:
    return load(str(short_file))


# -- the controller reads its mailboxes every 100 ms ----------------------------------------------------------------


@dataclass(frozen=True)
class Slow:
    """A run whose controller has a speed that is too old most of the time."""

    done: Done
    folder: Path
    document: dict


@pytest.fixture(scope="module")
def slow(short_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Slow:
    folder = tmp_path_factory.mktemp("slow") / "run"
    done = command("run", short_file, "--bus", "local", "--task-period-ms", "100", "--out", folder)
    return Slow(done, folder, json.loads((folder / "score.json").read_text()))


#: What the run ends with, wherever it is said.
CUT = "TRACTION CUT from 0.16 s (TRN_SPEED older than 64 ms, for 24.75 s)"


@pytest.mark.slow
def test_the_console_says_why_the_train_has_not_stopped(slow: Slow) -> None:
    assert slow.done.exit_code == 1
    assert f"FAIL: not stopped 0.9 s after the timetable - {CUT}" in slow.done.out.splitlines()


@pytest.mark.slow
def test_the_same_from_the_log_alone(slow: Slow) -> None:
    done = command("score", slow.folder)
    assert f"FAIL: not stopped 0.9 s after the timetable - {CUT}" in done.out.splitlines()
    shown = json.loads(command("score", slow.folder, "--json").out)
    assert (shown["why"], shown["events"]) == (CUT, slow.document["events"])


def test_score_json_has_first_and_worst_reaction_of_each_watch(slow: Slow) -> None:
    assert slow.document["why"] == CUT
    assert slow.document["failures"] == ["not stopped 0.9 s after the timetable"]
    watches = slow.document["events"]["watches"]
    assert watches["train"] is None
    assert watches["controller"]["first"] == {
        "level": "hold", "time_s": 0.12, "cause": "speed_age", "detail": "TRN_SPEED older than 20 ms",
    }  # fmt: skip
    worst = watches["controller"]["worst"]
    assert (worst["level"], worst["time_s"], worst["cause"], worst["times"]) == ("traction_cut", 0.16, "speed_age", 1)
    assert watches["controller"]["seconds"] == {"hold": 0.04, "traction_cut": 24.75}


def test_junit_has_the_reaction_as_property_and_in_the_failure(slow: Slow) -> None:
    suite = ET.parse(slow.folder / "junit.xml").getroot()
    properties = {found.get("name"): found.get("value") for found in suite.findall("properties/property")}
    assert properties["reaction.controller"] == CUT
    assert "reaction.train" not in properties
    assert [found.get("message") for found in suite.findall(".//failure")] == [f"did not stop - {CUT}"]


def test_the_report_has_the_ladder_and_the_table(slow: Slow) -> None:
    html = (slow.folder / "report.html").read_text()
    assert CUT in html
    assert 'id="reactions"' in html
    table = html.partition('id="events"')[2].partition("</table>")[0]
    assert "<td>controller</td><td>TRACTION CUT</td><td>TRN_SPEED older than 64 ms</td>" in table


def test_events_csv_has_a_row_for_each_event(slow: Slow) -> None:
    with (slow.folder / "events.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert tuple(rows[0]) == COLUMNS
    cut = next(row for row in rows if row["level"] == "traction_cut")
    assert {key: cut[key] for key in ("time_s", "until_s", "source", "kind", "cause", "count", "position_m")} == {
        "time_s": "0.16", "until_s": "24.91", "source": "controller", "kind": "level", "cause": "speed_age",
        "count": "1", "position_m": "",
    }  # fmt: skip
    events = railhil.open_run(slow.folder).events
    assert [row["cause"] for row in rows] == [event.cause for event in events]


@pytest.mark.slow
def test_the_threshold_in_the_text_is_that_of_the_scenario(short_file: Path, tmp_path: Path) -> None:
    given = ["--set", "watch.traction_cut_ms=48", "--no-report"]
    done = command("run", short_file, "--bus", "local", "--task-period-ms", "100", *given, "--out", tmp_path / "run")
    assert "(TRN_SPEED older than 48 ms, " in done.out


# -- disturbed buses ------------------------------------------------------------------------------------------------


class Run:
    """A run over a disturbed bus, judged."""

    def __init__(self, scenario: Scenario, folder: Path, disturbance: Disturbance, spec: RunSpec | None = None) -> None:
        self.scenario = scenario
        self.trace = disturbed_run(scenario, folder, disturbance, spec)
        self.events = events_of(scenario, self.trace)
        self.score = judging_of(scenario).score(scenario, self.trace)
        self.line = explained("; ".join(self.score.failures), why(scenario, self.events))
        self.summary = summary(scenario, self.events)


def between(address: int, from_s: float, to_s: float, change: Callable[[Frame], list[Frame]]) -> Disturbance:
    """Changes the frames of one identifier for some time."""
    return lambda frame, now_s: change(frame) if frame.can_id == address and from_s <= now_s < to_s else [frame]


@pytest.fixture(scope="module")
def healthy(short: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return Run(short, tmp_path_factory.mktemp("healthy"), lambda frame, now_s: [frame])


def test_a_healthy_run_has_its_milestones_and_the_normal_start(healthy: Run) -> None:
    found = [(event.source, event.kind, event.cause) for event in healthy.events]
    assert found == [*USUAL, ("plant", "milestone", "ended_complete")]
    # The train brakes until the first command.
    assert (healthy.events[0].level, healthy.events[0].until_s) == ("service_brake", 0.01)
    assert healthy.line == ""
    assert healthy.summary == {
        "watches": {"controller": None, "train": None}, "refused": {}, "lost": {}, "missed_polls": {}, "faults": [],
    }  # fmt: skip


@pytest.fixture(scope="module")
def damaged_speed(short: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Run:
    address = TrnSpeed.port().address
    return Run(short, tmp_path_factory.mktemp("speed"), between(address, 5.0, 5.3, lambda frame: [damaged(frame)]))


def test_thirty_frames_with_a_wrong_check_sequence_leave_a_trace(damaged_speed: Run) -> None:
    first = next(event for event in damaged_speed.events if event.kind == "refused")
    assert (first.source, first.cause, first.count) == ("TRN_SPEED", "wrong_check_sequence", 30)
    # The recorder's time goes on with the polls, although the port that opens the ticks is disturbed.
    assert (first.time_s, first.until_s) == (5.0, 5.28)
    # After that the life sign has gone round nearly twice: as the receiver does, the next two are taken for old ones.
    assert damaged_speed.summary["refused"] == {
        "TRN_SPEED": {"wrong_check_sequence": 30, "out_of_order": 1, "duplicate": 1}
    }
    assert told(damaged_speed.events, "level") == [
        ("controller", "speed_age", level) for level in ("hold", "traction_cut", "service_brake")
    ]
    assert damaged_speed.score.verdict == "PASS"
    assert damaged_speed.line == "SERVICE BRAKE from 5.26 s (TRN_SPEED older than 256 ms, for 0.16 s)"


def test_refused_telegrams_are_not_lost_ones(damaged_speed: Run) -> None:
    assert damaged_speed.summary["lost"] == {}


@pytest.fixture(scope="module")
def silent_controller(short: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Run:
    address = NotchCmd.port().address
    return Run(short, tmp_path_factory.mktemp("silent"), between(address, 8.0, 8.4, lambda frame: [damaged(frame)]))


def test_a_controller_without_good_answers_shows_the_trains_own_watch(silent_controller: Run) -> None:
    levels = [event for event in silent_controller.events if event.kind == "level"]
    assert [(event.source, event.level, event.time_s) for event in levels] == [
        ("train", "hold", 8.02), ("train", "traction_cut", 8.06), ("train", "service_brake", 8.25),
    ]  # fmt: skip
    assert {(event.cause, event.detail) for event in levels} == {
        ("command_age", f"NOTCH_CMD older than {age_ms} ms") for age_ms in (20, 64, 256)
    }
    assert silent_controller.line == "train's SERVICE BRAKE from 8.25 s (NOTCH_CMD older than 256 ms, for 0.34 s)"
    missed = next(event for event in silent_controller.events if event.kind == "missed_poll")
    assert (missed.source, missed.cause, missed.count) == ("NOTCH_CMD", "answer_refused", 20)
    assert silent_controller.summary["missed_polls"] == {"NOTCH_CMD": 20}
    assert silent_controller.trace.missed_polls == 20


def in_report(run: Run, folder: Path) -> Record:
    return row_of(folder, {}, run.scenario, run.trace, run.score, events=run.events)


@pytest.mark.slow
def test_the_report_of_a_disturbed_run_shows_both_and_stays_the_same(silent_controller: Run, tmp_path: Path) -> None:
    run = in_report(silent_controller, tmp_path)
    text = page([run])
    assert text == page([run])
    assert "train&#39;s SERVICE BRAKE from 8.25 s" in text
    assert "<td>NOTCH_CMD</td><td>refused</td><td>wrong check sequence</td>" in text


def test_the_report_of_a_healthy_run_says_that_nothing_happened(healthy: Run, tmp_path: Path) -> None:
    text = page([in_report(healthy, tmp_path)])
    assert "The watches stayed at normal, nothing was refused, lost or missed." in text
    assert 'id="reactions"' not in text


@pytest.mark.slow
def test_a_report_of_several_runs_names_each(
    healthy: Run, damaged_speed: Run, silent_controller: Run, tmp_path: Path
) -> None:
    runs = [
        in_report(run, tmp_path / name)
        for name, run in {"well": healthy, "deaf": damaged_speed, "dumb": silent_controller}.items()
    ]
    text = page(runs)
    assert "well: the watches stayed at normal, nothing was refused, lost or missed." in text
    assert [f"Reactions and events over time: {name}" in text for name in ("well", "deaf", "dumb")] == [
        False,
        True,
        True,
    ]
    assert ('id="reactions-1"' in text, 'id="reactions-2"' in text, 'id="reactions-3"' in text) == (True, True, False)


def test_a_lost_position_is_the_cause_of_the_brake(short: Scenario, tmp_path: Path) -> None:
    spec = RunSpec(law=LawSpec("ipfc_plus"))
    found = Run(short, tmp_path, between(TrnPos.port().address, 6.0, 9.0, lambda frame: []), spec)
    brake = next(event for event in found.events if event.kind == "level")
    assert (brake.source, brake.level, brake.cause, brake.detail) == (
        "controller", "service_brake", "position_lost", "position lost",
    )  # fmt: skip
    assert 7.0 <= brake.time_s <= 7.04
    assert found.summary["refused"]["TRN_POS"]["missing_block"] == 150
    assert "SERVICE BRAKE from 7.0" in found.line


def test_signals_have_target_speed_and_both_levels(silent_controller: Run) -> None:
    scenario, trace = silent_controller.scenario, silent_controller.trace
    outcome = railhil.Outcome(Path(), scenario, trace)
    signals = outcome.signals
    at = np.searchsorted(signals["time_s"], 8.3)
    assert (signals["train_level"][at], signals["controller_level"][at]) == (3, 0)
    assert signals["target_speed_mps"][at] == pytest.approx(0.5 * 8.3, abs=0.02)
    assert signals.units["target_speed_mps"] == "m/s"
    assert {"measured_speed_mps", "true_speed_mps"} <= set(signals)


def test_a_folder_of_version_0_1_0_has_its_events(tmp_path: Path) -> None:
    """Its wire has neither causes nor TRN_WATCH."""
    kept = TEST_DATA / "runs_0.1.0" / "yizhuang01_ipfc_plus"
    (tmp_path / "certificate.json").write_bytes((kept / "certificate.json").read_bytes())
    (tmp_path / "frames.log").write_bytes(lzma.decompress((kept / "frames.log.xz").read_bytes()))
    record = checked_record(str(tmp_path), None)
    events = events_of(record.scenario, record.trace)
    assert [(event.kind, event.cause) for event in events] == [
        ("milestone", name) for name in ("departed", "stopped", "ended_complete")
    ]
    outcome = railhil.open_run(tmp_path)
    assert outcome.events == events
    assert "train_level" not in outcome.signals
    assert set(np.unique(outcome.signals["controller_level"])) == {0}
