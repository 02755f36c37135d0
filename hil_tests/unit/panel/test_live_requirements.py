"""The requirements of a run on the bus: rows as of its record, however its frames come; none where some are missing."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.panel import Recorded, ScriptedLink
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bus.frame import Frame
from railhil.bus.ident import Role
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame
from railhil.cli.run_identity import RunIdentity
from railhil.common.errors import InputError
from railhil.judge.record import Record
from railhil.judge.requirements.outcome import judge_requirements
from railhil.judge.requirements.requirement import Requirement
from railhil.panel import requirements as module
from railhil.panel.__main__ import main
from railhil.panel.live import LiveRun
from railhil.panel.receiver import Receiver
from railhil.panel.requirements import LiveRequirements, describe_outcomes
from railhil.run.make import record_run
from railhil.run.report import as_recorded
from railhil.scenarios.run_spec import RunSpec

_SENTENCES = (
    "never true_speed > 0.1 km/h",
    "whenever true_speed > 0.05 km/h, within 20 ms notch_command > -100 notch",
    "at end true_speed >= 0 km/h",
    "whenever age(TRN_SPEED) > 64 ms, within 20 ms notch_command <= 0 notch",
)
_REQUIREMENTS = [Requirement(f"T-{number}", says) for number, says in enumerate(_SENTENCES)]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    return Recorded(tmp_path_factory.mktemp("run"))


def rows(message: str) -> list[dict[str, Any]]:
    return list(json.loads(message)["requirements"]["rows"])


def judged(run: Recorded, *parts: Sequence[Frame], lacking: int = -1) -> dict[str, Any]:
    """What the page is told after frames in these parts; before part ``lacking`` some were lost."""
    live = LiveRequirements(_REQUIREMENTS)
    for number, frames in enumerate(parts):
        live.take(frames, number == lacking)
        if number == 0:
            # The scenario is known when the plant has told its hash.
            live.show(run.scenario, None)
    return dict(json.loads(live.describe())["requirements"])


@pytest.mark.slow
@given(st.data())
@settings(max_examples=10, deadline=None)
def test_the_rows_are_those_of_the_record_however_the_frames_come(run: Recorded, data: st.DataObject) -> None:
    cuts = sorted(data.draw(st.lists(st.integers(0, len(run.frames)), max_size=6)))
    parts = [run.frames[a:b] for a, b in zip([0, *cuts], [*cuts, len(run.frames)], strict=True)]
    told = judged(run, *parts)
    record = Record(Path("frames.log"), run.scenario, run.trace)
    expected = json.loads(describe_outcomes([("", judge_requirements(record, _REQUIREMENTS))]))["requirements"]
    assert told == expected
    assert [row["verdict"] for row in told["rows"]] == ["violated", "kept", "kept", "says nothing"]
    assert told["rows"][0]["margin"].endswith(" m/s")


@pytest.mark.slow
def test_faults_of_the_bus_and_of_its_clock_move_no_instant(tmp_path: Path) -> None:
    faults = ("TIME_SYNC loss @1s for 1s", "TRN_SPEED loss @2s for 300ms", "NOTCH_CMD duplicate @3s for 500ms")
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML, encoding="utf-8")
    required = tuple(one.as_json() for one in _REQUIREMENTS)
    spec = RunSpec(str(path), bus="local", faults=faults, requirements=required, out=tmp_path / "run")
    record = as_recorded(record_run(spec))
    live = LiveRequirements(_REQUIREMENTS)
    live.show(record.scenario, None)
    live.take([frame for _, frame in record.frames()])
    assert rows(live.describe()) == rows(describe_outcomes([("", record.score.requirements)]))
    assert record.score.requirements[3].antecedent_met


def test_a_violated_sentence_is_told_while_the_run_goes_on(run: Recorded) -> None:
    told = judged(run, run.frames[: len(run.frames) // 2])
    assert (told["so_far"], told["said"]) == (True, "")
    assert [row["verdict"] for row in told["rows"]] == ["violated", "kept", "open", "says nothing"]


def test_frames_that_are_missing_leave_the_judgement_to_the_record(run: Recorded) -> None:
    middle = len(run.frames) // 2
    lost = judged(run, run.frames[:middle], run.frames[middle + 30 :], lacking=1)
    late = judged(run, run.frames[middle:])
    assert "lost" in lost["said"]
    assert "beginning" in late["said"]
    assert {row["verdict"] for told in (lost, late) for row in told["rows"]} == {"not judged"}


def test_before_a_run_begins_nothing_is_decided(run: Recorded) -> None:
    live = LiveRequirements(_REQUIREMENTS)
    for scenario in (None, run.scenario):
        live.show(scenario, None)
        live.take([master_frame(F_DEVICE_STATUS, Role.CONTROLLER.value)] * 5000)
        told = json.loads(live.look())["requirements"]
        assert (told["said"], {row["verdict"] for row in told["rows"]}) == ("", {"open"})
        live._due_s = 0.0
    assert live.look() == ""
    live.take(run.frames[:1000])
    assert [row["verdict"] for row in rows(live.look())][:1] == ["kept"]
    live._due_s = 0.0
    live.take(run.frames[1100:1200], is_lacking=True)
    assert "lost" in json.loads(live.look())["requirements"]["said"]


def test_another_run_on_the_bus_is_judged_anew(run: Recorded) -> None:
    """Also after frames of the one before were lost; nodes are searched between two runs."""
    search = [master_frame(F_DEVICE_STATUS, Role.CONTROLLER.value)] * 2
    early = len(run.frames) // 10
    told = judged(run, run.frames[:-500], [*search, *run.frames[:early]], lacking=0)
    assert told == judged(run, run.frames[:early])
    assert [row["verdict"] for row in told["rows"]][:1] == ["kept"]


def test_sentences_that_do_not_fit_the_run_are_said_in_a_line(run: Recorded) -> None:
    live = LiveRequirements([Requirement("T-1", "never true_sped > 2 km/h")])
    live.show(run.scenario, None)
    live.take(run.frames[:1000])
    told = json.loads(live.describe())["requirements"]
    assert "true_sped" in told["said"]
    assert "\n" not in told["said"]
    assert [row["verdict"] for row in told["rows"]] == ["not judged"]


def test_it_is_judged_twice_a_second_and_at_the_end_at_once(run: Recorded, monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now_s[0])
    parts = [run.frames[at : at + 100] for at in range(0, len(run.frames), 100)]
    link = ScriptedLink(*[part for one in parts for part in (one, [])], [])
    watched = RunIdentity(run.scenario)
    live = LiveRun(watched, Receiver({}, lambda config, name: link), requirements=LiveRequirements(_REQUIREMENTS))
    told = []
    for _ in parts:
        told += [message for message in live.look() if isinstance(message, str) and '"requirements"' in message]
        now_s[0] += 0.1
    assert len(parts) / 5 - 1 <= len(told) <= len(parts) / 5 + 3
    assert json.loads(told[-1])["requirements"]["so_far"] is False
    assert rows(told[-1]) == rows(next(one for one in live.read_past() if isinstance(one, str) and '"rows"' in one))


@pytest.mark.parametrize(
    ("words", "found"),
    [
        (["lvshun_tieshan", "--requirements", "hst1"], "HST-1"),
        (["--requirements", "atoo"], "did you mean ato?"),
    ],
)
def test_a_sentence_that_cannot_judge_the_named_run_is_refused_before_a_page_is_served(
    words: list[str], found: str
) -> None:
    pytest.importorskip("websockets", reason="MISSING CAPABILITY websockets")
    with pytest.raises(InputError) as refused:
        main([*words, "--port", "0"])
    assert found in str(refused.value)
    assert "\n" not in str(refused.value)
