"""The record of a controller in Python tells what ran, also where its file changes, and shows when it was edited."""

from __future__ import annotations

import json
import os
import py_compile
import subprocess
import time
from functools import partial
from pathlib import Path
from typing import Any

import pytest

import railhil
from hil_tests.support.cli import railhil as command
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.common.errors import InputError
from railhil.controller_node.given.computing import Quantity, Terms
from railhil.controller_node.given.python import PythonFile
from railhil.record.hash_list import HASH_LIST, write_hash_list

_CODE = """
def steady(reading):
    return 3.6 * (reading.set_point_mps - reading.speed_mps)
"""
_SAVED = """
import pathlib
def steady(reading):
    if 2 <= reading.time_s < 2.5:
        pathlib.Path(__file__).{change}
    return 3.6 * (reading.set_point_mps - reading.speed_mps)
"""
_WRITTEN, _REMOVED, _LOCAL = "write_text('steady = 0')", "unlink()", ("--bus", "local")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("given")
    (made / "mine.py").write_text(_CODE, encoding="utf-8")
    (made / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    return made


def run(folder: Path, file: Path, out: Path, *options: str | Path) -> Any:
    words = ("run", folder / "short.toml", "--controller", f"{file}:steady", "--quiet", "--no-report", "--out", out)
    return command(*words, *options)


@pytest.mark.long_after(2)
@pytest.mark.parametrize(
    ("change", "bus"),
    [(_WRITTEN, _LOCAL), (_REMOVED, ()), (_WRITTEN, ()), (_REMOVED, _LOCAL)],
    ids=["written-local", "removed-bus", "written-bus", "removed-local"],
)
def test_a_file_that_is_saved_or_removed_in_the_run_is_recorded_as_it_was(
    folder: Path, tmp_path: Path, change: str, bus: tuple[str, ...]
) -> None:
    file = tmp_path / "mine.py"
    text = _SAVED.format(change=change)
    file.write_text(text, encoding="utf-8")
    assert run(folder, file, tmp_path / "out", *bus).exit_code in (0, 1)
    assert command("verify", tmp_path / "out").exit_code == 0
    refused = command("rerun", tmp_path / "out", "--controller", f"{file}:steady")
    assert (refused.exit_code, refused.err.count("\n")) == (2, 1)
    file.write_text(text, encoding="utf-8")
    assert command("rerun", tmp_path / "out", "--controller", f"{file}:steady").exit_code == 0


@pytest.mark.parametrize("when", ["before", "while"])
def test_code_that_is_not_the_hashed_one_does_not_run(tmp_path: Path, when: str) -> None:
    """Saved after it was named: before its process has read it, or by itself while it is read."""
    file = tmp_path / "mine.py"
    own = "import pathlib; pathlib.Path(__file__).write_text('other = 1')" if when == "while" else ""
    file.write_text(f"{own}\n{_CODE}", encoding="utf-8")
    given = PythonFile(f"{file}:steady")
    given.hashes()
    if when == "before":
        file.write_text(_CODE.replace("3.6", "3.7"), encoding="utf-8")
    with pytest.raises(InputError, match="as when it was named"):
        given.start(Terms((Quantity("speed_mps", "m/s"),), (Quantity("notch", "notch"),), 0.5), 20.0)


def test_cached_bytecode_of_another_text_does_not_run(folder: Path, tmp_path: Path) -> None:
    """Python takes a file of the same size and second for unchanged."""
    file = tmp_path / "mine.py"
    file.write_text(_CODE, encoding="utf-8")
    py_compile.compile(str(file))
    then = file.stat()
    file.write_text(_CODE.replace("3.6", "0.0"), encoding="utf-8")
    os.utime(file, ns=(then.st_atime_ns, then.st_mtime_ns))
    assert run(folder, file, tmp_path / "out", "--bus", "local").exit_code in (1, 3)
    lines = (tmp_path / "out" / "frames.log").read_text(encoding="ascii").splitlines()
    notches = {line.split("#")[1][:4] for line in lines if " 110#" in line}
    assert "0000" in notches
    assert not any(0 < int(notch, 16) < 0x8000 for notch in notches), "0.0 gives no traction"


@pytest.fixture(scope="module")
def made(folder: Path) -> Path:
    assert run(folder, folder / "mine.py", folder / "made", "--bus", "local").exit_code in (0, 1)
    return folder / "made"


@pytest.mark.parametrize(
    "changes",
    [
        {"sha256": "0" * 64},
        {"label": "mine-steady@00000000"},
        {"files": {"mine.py": "0" * 64}},
        {"files": {}},
        {"files": [1]},
    ],
)
def test_an_edited_identity_is_noticed(made: Path, tmp_path: Path, changes: dict[str, Any]) -> None:
    out = tmp_path / "out"
    out.mkdir()
    for file in made.iterdir():
        (out / file.name).write_bytes(file.read_bytes())
    certificate = json.loads((out / "certificate.json").read_text(encoding="utf-8"))
    certificate["given_controller"] |= changes
    (out / "certificate.json").write_text(json.dumps(certificate), encoding="utf-8")
    (out / HASH_LIST).unlink()
    write_hash_list(out, {})
    found = command("verify", out)
    assert found.exit_code != 0
    assert "given_controller" in found.out + found.err


def test_functions_are_told_apart_by_file_and_name(folder: Path, tmp_path: Path) -> None:
    def law(gain: float, reading: Any) -> float:
        return gain * (reading.set_point_mps - reading.speed_mps)

    def ipfc(reading: Any) -> float:
        return 1.0

    class Held:
        def step(self, reading: Any) -> float:
            return 1.0

    names = {}
    for name, code in {"partial": partial(law, 3.6), "ipfc": ipfc, "method": Held().step, "object": Held()}.items():
        outcome = railhil.run(folder / "short.toml", controller=code, out=tmp_path / name)
        names[name] = outcome.certificate["controller"]
        assert list(outcome.certificate["given_controller"]["files"]) == [__file__]
    called = {"partial": "law", "ipfc": "ipfc", "method": "step", "object": "Held"}
    assert names == {name: f"{Path(__file__).stem}-{one}" for name, one in called.items()}


def test_a_function_runs_in_this_process_only_and_again_by_its_call(folder: Path, tmp_path: Path) -> None:
    def ipfc(reading: Any) -> float:
        return 1.0

    with pytest.raises(InputError, match="allowed local with a function"):
        railhil.run(folder / "short.toml", controller=ipfc, bus="auto", out=tmp_path / "auto")
    assert not (tmp_path / "auto").exists()
    once = railhil.run(folder / "short.toml", controller=ipfc, out=tmp_path / "once")
    with pytest.raises(InputError, match="controller= in a call"):
        railhil.run(once.spec, out=tmp_path / "without")
    again = railhil.run(once.spec, controller=ipfc, out=tmp_path / "again")
    assert again.frames_sha256 == once.frames_sha256


def test_it_is_not_the_controller_where_another_program_is(folder: Path, tmp_path: Path) -> None:
    found = run(folder, folder / "mine.py", tmp_path / "out", "--no-controller", "-i", "railhil", "-c", "nobody.sock")
    assert (found.exit_code, "cannot be given with --no-controller" in found.err) == (2, True)
    assert not (tmp_path / "out").exists()


def test_settings_of_laws_are_refused_wherever_they_stand(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "run.toml").write_text('arithmetic = "iq"\n', encoding="utf-8")
    found = command("run", "--spec", tmp_path / "run.toml", "--controller", f"{folder / 'mine.py'}:steady")
    assert found.exit_code == 2
    assert "run.toml: arithmetic: cannot be given with --controller" in found.err


def test_wrong_syntax_is_named_where_it_is(folder: Path, tmp_path: Path) -> None:
    file = tmp_path / "syntax.py"
    file.write_text("x = 1\ndef steady(reading:\n", encoding="utf-8")
    found = run(folder, file, tmp_path / "out", "--bus", "local")
    assert found.exit_code == 2
    assert f"{file}:2: import: it raises SyntaxError" in found.err


def test_programs_that_the_code_has_started_end_with_it(folder: Path, tmp_path: Path) -> None:
    file, seconds = tmp_path / "starts.py", f"93.{tmp_path.stat().st_ino}"
    file.write_text(f'import subprocess\nsubprocess.Popen(["sleep", "{seconds}"])\n{_CODE}', encoding="utf-8")
    assert run(folder, file, tmp_path / "out", "--bus", "local").exit_code in (0, 1)
    time.sleep(0.2)
    listed = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout
    assert f"sleep {seconds}" not in listed
