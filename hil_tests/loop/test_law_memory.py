"""A law that learns from run to run: its memory over the hub and in one process, kept, refused, and made again."""

from __future__ import annotations

import json
import os
import signal
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import railhil as library
from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import Done, Started, railhil, wait_for
from hil_tests.support.paths import ROOT
from hil_tests.support.plug import plug_in
from hil_tests.support.remembering import Learning
from railhil.common.exit_codes import FAIL, INVALID, PASS, TOOL_ERROR, USAGE
from railhil.judge.result import Result
from railhil.run import make
from railhil.run.memory import learned
from railhil.scenarios.load import load
from railhil.scenarios.memory import MemoryRecord, load_memory, read_record
from railhil.scenarios.memory_store import MemoryStore
from railhil.scenarios.run_spec import RunSpec

pytestmark = [pytest.mark.loop, pytest.mark.slow]


class Forgetful(Learning):
    """One that raises when it is asked what to keep."""

    def memory(self, state: Any) -> dict[str, Any]:
        raise ZeroDivisionError("nothing comes to mind")


@pytest.fixture
def short(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A short scenario; the laws are known to every process that is started."""
    plug_in(tmp_path, monkeypatch, learning=Learning, forgetful=Forgetful)
    # The laws are in a module of the tests, which the nodes do not find by themselves.
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join((str(tmp_path / "plug"), str(ROOT))))
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    return path


def run(short: Path, out: Path, *words: str | Path) -> Done:
    given = ("--bus", "local") if "-i" not in words else ()
    return railhil("run", short, "--controller", "learning", *given, *words, "--out", out, "--quiet", "--no-report")


def certificate(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "certificate.json").read_text())
    return found


def stored(path: Path) -> MemoryRecord:
    """The newest record of a store."""
    newest = MemoryStore(path).read("learning").newest
    assert newest is not None
    return newest


def content(path: Path) -> dict[str, bytes]:
    """Every file of a store."""
    return {entry.name: entry.read_bytes() for entry in path.iterdir() if entry.is_file()}


def put(path: Path, slot: str, record: MemoryRecord) -> None:
    path.mkdir(exist_ok=True)
    MemoryStore(path).file(slot).write_text(record.text)


@pytest.mark.long
def test_three_runs_learn_the_same_over_the_hub_and_in_one_process(short: Path, tmp_path: Path) -> None:
    files: dict[str, list[dict[str, bytes]]] = {}
    hashes: dict[str, list[str]] = {}
    for bus, runs, words in (("hub", 2, ("-i", "railhil")), ("local", 3, ())):
        memory = tmp_path / bus
        for number in range(1, runs + 1):
            folder, slot = tmp_path / f"{bus}{number}", "AB"[(number - 1) % 2]
            done = run(short, folder, "--memory", memory, *words)
            assert done.exit_code in (PASS, FAIL), done.err
            document, found = certificate(folder), stored(memory)
            assert (found.law, found.runs, found.last_run, found.values["runs"]) == ("learning", number, number, number)
            assert document["memory_used"] == ("" if number == 1 else "BA"[(number - 1) % 2])
            assert document["memory"]["sha256"] == load_memory(folder / "memory_before.json").sha256
            assert document["memory_after_sha256"] == read_record(folder / "memory.json").sha256 == found.sha256
            assert (folder / "memory.json").read_bytes() == MemoryStore(memory).file(slot).read_bytes()
            if number > 1:
                before = read_record(tmp_path / f"{bus}{number - 1}" / "memory.json")
                assert load_memory(folder / "memory_before.json").newest == before
            files.setdefault(bus, []).append(content(memory))
            hashes.setdefault(bus, []).append(document["frames_sha256"])
    assert files["hub"] == files["local"][:2]
    assert hashes["hub"] == hashes["local"][:2]
    assert len({*hashes["local"]}) == 3, "what is learned changes the run"


def test_a_run_is_made_again_from_its_folder_alone_and_learns_nothing_twice(short: Path, tmp_path: Path) -> None:
    memory = tmp_path / "memory"
    for number in (1, 2):
        assert run(short, tmp_path / str(number), "--memory", memory).exit_code in (PASS, FAIL)
    kept = content(memory)
    document = certificate(tmp_path / "2")
    memory.rename(tmp_path / "elsewhere")
    words = document["command"].split()[1:]
    assert str(tmp_path / "2" / "memory_before.json") in words
    for way, given in (("command", words), ("spec", ["run", "--spec", tmp_path / "2" / "certificate.json"])):
        done = railhil(*given, "--out", tmp_path / way, "--quiet", "--no-report")
        assert done.exit_code in (PASS, FAIL), done.err
        assert certificate(tmp_path / way)["frames_sha256"] == document["frames_sha256"]
        assert certificate(tmp_path / way)["memory_after_sha256"] == document["memory_after_sha256"]
    assert not memory.exists()
    assert content(tmp_path / "elsewhere") == kept


def test_score_and_report_say_that_a_run_had_a_memory(short: Path, tmp_path: Path) -> None:
    memory = tmp_path / "memory"
    put(memory, "A", MemoryRecord("learning", Learning.memory_key(load(str(short))), 1, 1, {"runs": 1, "offset": 0.25}))
    done = run(short, tmp_path / "2", "--memory", memory)
    document = certificate(tmp_path / "2")
    digest, left = document["memory"]["sha256"][:8], document["memory_after_sha256"][:8]
    assert f"memory: began with that of 1 run (slot A); kept that of 2 runs ({left}) in {memory}" in done.out
    said = railhil("score", tmp_path / "2")
    assert f"memory: began with that of 1 run, key {stored(memory).key}, sha256 {digest}" in said.out
    assert railhil("score", tmp_path / "2", "--json").json["memory"] == document["memory"]
    assert railhil("report", tmp_path / "2").exit_code in (PASS, FAIL)
    assert f"learning@{digest}" in (tmp_path / "2" / "report.html").read_text().replace("<wbr>", "")
    score = json.loads((tmp_path / "2" / "score.json").read_text())
    assert score["run"]["memory"] == digest


def test_a_law_with_memory_that_is_given_none_keeps_it_in_its_folder(short: Path, tmp_path: Path) -> None:
    assert run(short, tmp_path / "run").exit_code in (PASS, FAIL)
    document = certificate(tmp_path / "run")
    assert document["memory"] is None
    assert document["memory_after_sha256"] == read_record(tmp_path / "run" / "memory.json").sha256
    assert not (tmp_path / "run" / "memory_before.json").exists()
    # It can be begun with.
    done = run(short, tmp_path / "next", "--memory-from", tmp_path / "run" / "memory.json")
    assert done.exit_code in (PASS, FAIL), done.err
    assert read_record(tmp_path / "next" / "memory.json").runs == 2
    assert read_record(tmp_path / "run" / "memory.json").runs == 1


@pytest.mark.long_after(1)
@pytest.mark.parametrize("words", [(), ("-i", "railhil")], ids=["one process", "hub"])
def test_a_memory_of_something_else_is_refused(short: Path, tmp_path: Path, words: tuple[str, ...]) -> None:
    """A named file is used or refused, and a store belongs to one law."""
    run(short, tmp_path / "first", "--memory", tmp_path / "memory")
    own, path = stored(tmp_path / "memory"), tmp_path / "memory.json"
    path.write_text(replace(own, key="another line").text)
    before = path.read_bytes()
    done = run(short, tmp_path / "second", "--memory-from", path, *words)
    assert done.exit_code == USAGE
    assert "key: found 'another line', allowed " in done.err
    done = run(short, tmp_path / "second", "--memory", path, *words)
    assert (done.exit_code, path.read_bytes()) == (USAGE, before)
    assert "memory.json: is a file, expected a folder in which railhil keeps the memory of a law" in done.err
    put(tmp_path / "memory", "A", replace(own, law="ipfc"))
    done = run(short, tmp_path / "second", "--memory", tmp_path / "memory", *words)
    assert done.exit_code == USAGE
    assert "a.json: law: found 'ipfc', allowed learning, the law of this store" in done.err
    assert not (tmp_path / "second").exists()


#: Damage of the newest record before a run, in slot B: what is in its file, by name of the fault, and words for people.
#: Every fault: hil_tests/unit/controller_node/test_law_memory.py.
_DAMAGE = {
    "crc": (lambda record: record.text.replace('"runs": 2', '"runs": 7', 1), "values that nobody changed"),
    "key": (lambda record: replace(record, key="another line").text, "found 'another line'"),
}


@pytest.mark.long_after(1)
@pytest.mark.parametrize("fault", _DAMAGE)
def test_a_damaged_slot_is_passed_over_said_and_kept_aside(fault: str, short: Path, tmp_path: Path) -> None:
    damage, said = _DAMAGE[fault]
    memory, folder = tmp_path / "memory", tmp_path / "third"
    first = MemoryRecord("learning", Learning.memory_key(load(str(short))), 1, 1, {"runs": 1, "offset": 0.25})
    put(memory, "A", first)
    bad = damage(replace(first, runs=2, last_run=2))
    (memory / "b.json").write_text(bad)
    done = run(short, folder, "--memory", memory)
    assert done.exit_code in (PASS, FAIL), done.err
    assert "memory: slot B cannot be used: " in done.out
    assert said in done.out
    assert "memory: began with that of 1 run (slot A); kept that of 2 runs" in done.out
    document = certificate(folder)
    assert (document["memory_used"], document["memory_refused"]["B"][0]) == ("A", fault)
    assert "B could not be used: " in railhil("score", folder).out
    assert (stored(memory).runs, stored(memory).values["runs"]) == (2, 2)
    (aside,) = (memory / "refused").iterdir()
    assert aside.read_text() == bad
    # The run is made again from its folder, with the same fault.
    again = railhil("run", "--spec", folder / "certificate.json", "--out", tmp_path / "again", "--quiet", "--no-report")
    assert again.exit_code in (PASS, FAIL), again.err
    assert certificate(tmp_path / "again")["frames_sha256"] == document["frames_sha256"]
    assert certificate(tmp_path / "again")["memory_refused"] == document["memory_refused"]


def test_a_law_without_memory_is_not_given_one(short: Path, tmp_path: Path) -> None:
    path = tmp_path / "memory"
    done = railhil("run", short, "--bus", "local", "--memory", path, "--out", tmp_path / "run")
    assert done.exit_code == USAGE
    assert "law: found 'ipfc', allowed a law that keeps a memory from run to run" in done.one_line()
    assert not path.exists()
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--attach",), "--attach: used only without a memory"),
        (("--no-controller",), "--no-controller: used only without a memory"),
        (("--memory-from", "m.json"), "--memory-from: cannot be given with --memory"),
        (
            ("--memory-from", "m.json", "--memory", "n.json"),
            "--memory-from: cannot be given with --memory",
        ),
        (("--memory", "/proc/folder"), "--memory: the folder "),
    ],
)
def test_what_cannot_be_together_is_refused(short: Path, tmp_path: Path, words: tuple[str, ...], line: str) -> None:
    given = words if "--memory" in words else ("--memory", tmp_path / "m.json", *words)
    bus = () if {"--attach", "--no-controller"} & {*words} else ("--bus", "local")
    done = railhil("run", short, "--controller", "learning", *bus, *given, "--out", tmp_path / "run")
    assert done.exit_code == USAGE
    assert line in done.one_line()
    assert not (tmp_path / "run").exists()


# The signal comes at any instruction of the process in which all nodes are: a telegram may be half delivered.
@pytest.mark.long
@pytest.mark.faults
def test_a_run_that_is_broken_off_keeps_nothing(short: Path, tmp_path: Path) -> None:
    path, folder = tmp_path / "memory", tmp_path / "broken"
    words = ("--controller", "learning", "--bus", "local", "--memory", path, "--out", folder, "--quiet", "--no-report")
    started = Started("run", "lvshun_tieshan", *words)
    wait_for(lambda: (folder / "frames.log").exists() and (folder / "frames.log").stat().st_size > 400_000)
    started.process.send_signal(signal.SIGINT)
    done, _ = started.finish()
    assert done.exit_code == 128 + signal.SIGINT, done.err
    document = certificate(folder)
    assert (document["verdict"], document["memory_after_sha256"]) == ("INVALID", None)
    assert not (folder / "memory.json").exists()
    assert (folder / "memory_before.json").is_file()
    assert not path.exists()
    assert "nothing kept: the run is INVALID" in done.out


@pytest.mark.faults
def test_a_run_whose_controller_is_killed_keeps_nothing(short: Path, tmp_path: Path) -> None:
    path, folder = tmp_path / "memory", tmp_path / "killed"
    words = ("--controller", "learning", "-i", "railhil", "--memory", path, "--out", folder, "--quiet", "--no-report")
    started = Started("run", "lvshun_tieshan", *words)
    wait_for(lambda: (folder / "frames.log").stat().st_size > 100_000)
    started.child("controller").kill()
    done, _ = started.finish()
    assert done.exit_code == INVALID, done.err
    assert not path.exists()
    assert not (folder / "memory.json").exists()
    assert "began with none; nothing kept: the run is INVALID" in done.out


def test_a_law_that_fails_to_say_its_memory_keeps_the_old_one(short: Path, tmp_path: Path) -> None:
    path = tmp_path / "memory"
    words = ("--controller", "forgetful", "--bus", "local", "--memory", path, "--out", tmp_path / "run")
    done = railhil("run", short, *words, "--quiet", "--no-report")
    assert done.exit_code in (PASS, FAIL)
    assert "controller: memory is lost: " in done.err
    assert "law forgetful, memory: values that cannot be kept, expected a dict that JSON can hold" in done.err
    assert "nothing kept: the law supplied no memory" in done.out
    assert not path.exists()


def test_a_memory_that_changed_meanwhile_stays(short: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two runs at once with one file: the second to end must not undo what the first has learned."""
    path = tmp_path / "memory"
    spec = RunSpec.from_file(_toml(tmp_path, 'controller = "learning"\nbus = "local"\nmemory_store = "memory"\n'))
    assert spec.memory_store == str(path)

    def late(result: Result) -> Any:
        put(path, "A", MemoryRecord("learning", "x", 1, 1, {}))
        return learned(result)

    monkeypatch.setattr(make, "learned", late)
    with pytest.raises(Exception, match=r"memory was changed during the run") as failed:
        library.run(spec, out=tmp_path / "run")
    assert failed.value.exit_code == TOOL_ERROR  # type: ignore[attr-defined]
    assert stored(path).key == "x"
    assert read_record(tmp_path / "run" / "memory.json").runs == 1
    assert (tmp_path / "run" / "certificate.json").is_file()


def _toml(folder: Path, text: str) -> Path:
    path = folder / "run.toml"
    path.write_text('scenario = "short.toml"\n' + text)
    return path


def test_the_library_keeps_a_memory_too(short: Path, tmp_path: Path) -> None:
    path = tmp_path / "memory"
    outcomes = [
        library.run(short, controller="learning", memory=path, out=tmp_path / str(number)) for number in range(2)
    ]
    assert stored(path).runs == 2
    spec = outcomes[1].spec
    assert spec.law.memory is not None
    assert spec.law.memory.newest is not None
    assert (spec.law.memory.newest.runs, spec.memory_store) == (1, None)
    again = library.run(spec, out=tmp_path / "again")
    assert again.frames_sha256 == outcomes[1].frames_sha256
    assert stored(path).runs == 2
