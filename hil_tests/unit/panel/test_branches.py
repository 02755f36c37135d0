"""Branches that a page asks for: one at a time, each with a folder of its own, and a line for what cannot be."""

from __future__ import annotations

import contextlib
import json
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.cli import wait_for
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.panel.branches import Branches
from railhil.panel.recorded import RecordedRuns
from railhil.record.documents import read_certificate
from railhil.run.branch import branch
from railhil.run.make import record_run
from railhil.scenarios.run_spec import RunSpec

pytestmark = pytest.mark.slow
_LOSS = {"run": 0, "at_s": 1.5, "fault": "TRN_SPEED loss for 200ms"}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of 2 m."""
    folder = tmp_path_factory.mktemp("branches")
    (folder / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    record_run(RunSpec(str(folder / "short.toml"), bus="local", out=folder / "run"))
    return folder / "run"


def ended(branches: Branches) -> dict[str, Any]:
    """The message when the branch has ended."""
    deadline_s = time.monotonic() + 100
    while time.monotonic() < deadline_s:
        for message in branches.look():
            told = dict(json.loads(message))
            if told["problem"] or all("verdict" in one for one in told["branches"]):
                return told
        time.sleep(0.05)
    raise TimeoutError


def branch_process(recorded: Path) -> Path | None:
    """The process that makes a branch of this run; None: there is none."""
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        # Processes come and go.
        with contextlib.suppress(OSError):
            if b"railhil.cli\0branch\0" + bytes(recorded) in path.read_bytes():
                return path
    return None


@pytest.mark.long
def test_a_branch_is_a_run_of_its_own_with_a_report(
    recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    runs = RecordedRuns([str(recorded)])
    assert runs.execute({"do": "branch", **_LOSS}) == ""
    assert runs.execute({"do": "branch", **_LOSS}) == "another branch is being made"
    (told,) = map(json.loads, runs.look())
    assert [sorted(one) for one in told["branches"]] == [["at_s", "fault", "folder", "run"]]
    (made,) = ended(runs.branches)["branches"]
    certificate = read_certificate(Path(made["folder"]))
    assert certificate is not None
    assert (certificate["verdict"], certificate["line"]) == (made["verdict"], made["line"])
    assert certificate["branched_from"]["instant_s"] == 1.5
    straight = branch(recorded, 1.5, "TRN_SPEED loss for 200ms", out=tmp_path / "again")
    assert certificate["frames_sha256"] == straight.frames_sha256
    assert made["report"]
    assert (runs.branches.report("0") or b"").startswith(b"<!DOCTYPE html>")
    assert [runs.branches.report(one) for one in ("1", "-1", "", "../0", "²")] == [None] * 5
    assert json.loads(runs.branches.describe())["branches"] == [made]


@pytest.mark.parametrize(
    ("asked", "why"),
    [
        ({"fault": "TRN_SPEED lost"}, "did you mean loss?"),
        ({"fault": "--no-return"}, "found"),
        ({"fault": "TRN_SPEED loss @1s"}, "begins at the instant of the branch or later"),
        pytest.param({"at_s": 900}, "a time before the end of the run", marks=pytest.mark.long),
    ],
)
def test_what_cannot_be_is_a_line(
    recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, asked: dict[str, Any], why: str
) -> None:
    monkeypatch.chdir(tmp_path)
    branches = Branches([recorded])
    assert branches.begin({**_LOSS, **asked}) == ""
    told = ended(branches)
    assert why in told["problem"]
    assert "\n" not in told["problem"]
    assert told["branches"] == []
    assert list((tmp_path / "runs").iterdir()) == []


@pytest.mark.parametrize(
    "asked",
    [{"run": 1}, {"run": True}, {"run": -1}, {"at_s": None}, {"at_s": -1.0}, {"at_s": float("nan")}, {"at_s": "1"},
     {"at_s": True}, {"at_s": 10**400}, {"fault": " "}, {"fault": 7}, {"fault": None}, {"fault": "a\0b"},
     {"fault": "\ud800"}],
)  # fmt: skip
def test_a_page_that_asks_for_nonsense_begins_nothing(
    recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, asked: dict[str, Any]
) -> None:
    monkeypatch.chdir(tmp_path)
    branches = Branches([recorded])
    assert branches.begin({**_LOSS, **asked}).startswith("found no branch, allowed")
    assert branches.look() == []
    assert not (tmp_path / "runs").exists()


def test_a_run_that_goes_on_has_no_branches_yet(tmp_path: Path) -> None:
    assert "has not ended" in Branches([tmp_path]).begin(_LOSS)


def test_the_end_of_the_panel_ends_its_branch(recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    branches = Branches([recorded])
    assert branches.begin(_LOSS) == ""
    branches.close()
    assert list((tmp_path / "runs").iterdir()) == []
    branches.close()


@pytest.mark.skipif(shutil.which("setpriv") is None, reason="no setpriv here: a branch ends by itself")
def test_a_panel_that_is_killed_leaves_no_branch_behind(recorded: Path, tmp_path: Path) -> None:
    panel = (
        "import json, sys, time; from railhil.panel.branches import Branches; made = Branches([sys.argv[1]]); "
        "assert not made.begin(json.loads(sys.argv[2])); time.sleep(100)"
    )
    with subprocess.Popen([sys.executable, "-c", panel, str(recorded), json.dumps(_LOSS)], cwd=tmp_path) as process:
        try:
            wait_for(lambda: branch_process(recorded))
        finally:
            process.kill()
    wait_for(lambda: branch_process(recorded) is None)
    assert [path.name for path in (tmp_path / "runs").glob("*/certificate.json")] == []
