"""``railhil memory show|verify|export``: what is stored, what is wrong with it, one line for bad input."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.support.plug import plug_in
from hil_tests.support.remembering import Learning
from railhil.cli.commands import work
from railhil.common.errors import InputError
from railhil.common.exit_codes import FAIL, PASS
from railhil.scenarios.load import load
from railhil.scenarios.memory import MemoryRecord, read_record
from railhil.scenarios.memory_store import MemoryStore

_KEY = Learning.memory_key(load("lvshun_tieshan"))
FIRST = MemoryRecord("learning", _KEY, 1, 1, {"runs": 1, "offset": 0.5})
SECOND = replace(FIRST, runs=2, last_run=2, values={"runs": 2, "offset": 0.25})


@pytest.fixture
def store(tmp_path: Path) -> Path:
    """A store after two runs."""
    made = MemoryStore(tmp_path / "memory")
    made.write(FIRST, made.read("learning"), "", {})
    made.write(SECOND, made.read(), "A", {})
    return made.path


def test_show_prints_every_record(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert work(["memory", "show", str(store)]) == PASS
    said = capsys.readouterr().out
    assert f"memory of learning, {store}" in said
    assert 'B: {"offset": 0.25, "runs": 2}' in said
    assert said.splitlines()[-1] == "a run would begin with B"
    assert work(["memory", "show", str(store), "--json"]) == PASS
    document = json.loads(capsys.readouterr().out)
    assert [(one["slot"], one["record"]["runs"]) for one in document["stored"]] == [("B", 2), ("A", 1)]
    assert (document["usable"], document["sha256"]) == (True, MemoryStore(store).read().sha256)


def test_verify_says_by_its_exit_code_whether_all_is_well(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert work(["memory", "verify", str(store)]) == PASS
    (store / "b.json").write_text("torn")
    capsys.readouterr()
    assert work(["memory", "verify", str(store)]) == FAIL
    said = capsys.readouterr().out
    assert "B cannot be used (json): cannot be read" in said
    assert "a run would begin with A" in said
    (store / "a.json").unlink()
    assert work(["memory", "verify", str(store), "--json"]) == FAIL
    assert json.loads(capsys.readouterr().out)["usable"] is False


def test_verify_asks_the_law_about_key_and_values(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plug_in(tmp_path, monkeypatch, learning=Learning)
    words = ["memory", "verify", str(store), "--scenario"]
    assert work([*words, "lvshun_tieshan"]) == PASS
    assert work([*words, "yizhuang_05"]) == FAIL
    assert "B cannot be used (key): found " in capsys.readouterr().out
    (store / "b.json").write_text(replace(SECOND, values={"runs": 2, "offset": 99.0}).text)
    assert work([*words, "lvshun_tieshan"]) == FAIL
    assert "B cannot be used (values): ValueError: offset 99.0" in capsys.readouterr().out


def test_export_writes_what_a_store_takes_as_its_default(
    store: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new" / "default.json"
    out.parent.mkdir()
    assert work(["memory", "export", str(store), "--out", str(out)]) == PASS
    assert f"record of 2 runs, sha256 {SECOND.digest}, written to {out}" in capsys.readouterr().out
    assert read_record(out) == SECOND
    assert MemoryStore(out.parent).read("learning").newest == SECOND
    assert work(["memory", "export", str(store), "--slot", "A", "--out", str(out), "--json"]) == PASS
    assert json.loads(capsys.readouterr().out)["sha256"] == FIRST.sha256 == read_record(out).sha256


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("show", "{}/none"), "none: does not exist"),
        (("show", "{}"), "has no record, expected a folder with a.json, b.json, default.json"),
        (("verify", "{}/bad.json"), r"bad\.json: cannot be read"),
        (("show", "{}/certificate.json"), "certificate.json: memory: missing, expected the certificate of a run that"),
        (("export", "{}/memory", "--slot", "default", "--out", "{}/x"), "no record in default"),
        (("export", "{}/memory", "--out", "{}/no/x"), "--out: the file "),
        (("verify", "{}/memory", "--scenario", "nowhere"), "found 'nowhere'"),
        (("verify", "{}/memory", "--scenario", "lvshun_tieshan"), "law: found 'learning', allowed "),
    ],
)
def test_bad_input_is_one_line(words: tuple[str, ...], line: str, store: Path, tmp_path: Path) -> None:
    (tmp_path / "bad.json").write_text("{")
    (tmp_path / "certificate.json").write_text('{"frames_sha256": "00"}')
    with pytest.raises(InputError, match=line) as refused:
        work(["memory", *(word.format(tmp_path) for word in words)])
    assert len(str(refused.value).splitlines()) == 1
