"""The learning curve of a recorded sequence, as the page gets it."""

from __future__ import annotations

import json
import shutil
from contextlib import nullcontext
from pathlib import Path

import pytest

from railhil.common.errors import InputError
from railhil.panel.recorded import RecordedRuns, find_run_folders, make_learning_charts
from railhil.scenarios.load import load_any
from railhil.sequences.sequence_command import _page, main

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def sequence(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two runs of the stopping train."""
    folder = tmp_path_factory.mktemp("learning") / "night"
    words = ["yizhuang_stop", "--controller", "ilc_stop", "--runs", "2", "--bus", "local", "--no-report"]
    assert main(["run", *words, "--out", str(folder)]) == 0
    return folder


def test_a_sequence_is_its_first_and_last_run_and_what_it_learned(sequence: Path) -> None:
    header = RecordedRuns([str(sequence)]).describe()
    assert [run["name"] for run in header["runs"]] == ["run001", "run002"]
    charts = {chart["title"]: chart for chart in header["learning"]}
    numbers, errors, upper, lower = charts["stop error by run"]["data"]
    assert numbers == [1, 2]
    signed = [json.loads((sequence / f"run00{one}" / "score.json").read_text())["signed"] for one in numbers]
    assert errors == [one["stop_error_m"] for one in signed]
    assert (upper, lower) == ([0.3, 0.3], [-0.3, -0.3])
    kept = [json.loads((sequence / f"run00{one}" / "memory.json").read_text())["values"] for one in numbers]
    for name in ("gamma", "offset_m"):
        assert charts[f"memory: records {name}"]["data"] == [[1, 2], [one["records"][0][name] for one in kept]]


def test_a_page_of_a_sequence_that_is_being_recorded_gets_each_run_as_it_ends(
    sequence: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    night = tmp_path / "night"
    shutil.copytree(sequence, night, ignore=shutil.ignore_patterns("run002"))
    now_s = [100.0]
    monkeypatch.setattr("railhil.panel.recorded.time.monotonic", lambda: now_s[0])
    source = RecordedRuns([str(night)])
    assert source.describe()["learning"] == []

    def after(seconds: float) -> list[str | bytes]:
        now_s[0] += seconds
        return source.look()

    # The folder of a run alone says nothing: it may still be written.
    shutil.copytree(sequence / "run002", night / "run002")
    assert after(1.0) == []
    (night / "sequence.json").write_text("{}")
    assert after(0.01) == []
    (message,) = after(1.0)
    charts = json.loads(message)["learning"]
    assert charts[0]["data"][0] == [1, 2]
    assert source.describe()["learning"] == charts == RecordedRuns([str(sequence)]).describe()["learning"]
    assert after(1.0) == []


def test_the_page_of_a_sequence_is_served_as_soon_as_a_run_has_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    served: list[list[str]] = []
    monkeypatch.setattr(
        "railhil.sequences.sequence_command.panel_process", lambda words: nullcontext(served.append(words))
    )
    monkeypatch.setattr("railhil.sequences.sequence_command._SHOWN_S", 0.0)
    with _page(0, tmp_path, False) as shown:
        assert served == []
        shown()
        shown()
    with _page(8770, tmp_path, True):
        assert [words[:3] for words in served] == [[str(tmp_path), "--port", "0"], [str(tmp_path), "--port", "8770"]]
    with _page(None, tmp_path, True) as shown:
        shown()
    assert len(served) == 2


@pytest.mark.long
def test_runs_beside_each_other_learn_only_if_they_are_of_one_sequence(sequence: Path) -> None:
    scenario = load_any("yizhuang_stop")
    first, second = (str(sequence / name) for name in ("run001", "run002"))
    assert len(make_learning_charts(scenario, [second, first])) > 1
    assert make_learning_charts(scenario, [first]) == []
    assert make_learning_charts(scenario, [first, first]) == []


def test_a_sequence_without_a_finished_run_is_refused(tmp_path: Path) -> None:
    (tmp_path / "sequence.json").write_text("{}")
    (tmp_path / "run001").mkdir()
    with pytest.raises(InputError, match="without a finished run"):
        find_run_folders([str(tmp_path)])
