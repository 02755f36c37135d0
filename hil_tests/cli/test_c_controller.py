"""A controller in C that the user writes: its folder, as a program, as a library, and its faults."""

from __future__ import annotations

import ctypes
import hashlib
import json
import re
import runpy
import shutil
import subprocess
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import psutil
import pytest

from hil_tests.support.cli import Done, command, railhil, railhil_process
from hil_tests.support.foreign import foreign_run, without_status
from hil_tests.support.paths import ROOT
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.common.errors import InputError
from railhil.controller_node.c_controller.folder import ControllerFolder
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec

pytestmark = [pytest.mark.needs_compiler, pytest.mark.slow, pytest.mark.loop]

#: What the body of a step can do wrong, chosen by its environment: the C is compiled once.
_FAULTS = """
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
static void fail(float time_s, float *command)
{
    const char *fault = getenv("FAULT");
    if (fault == NULL || time_s < 5.0f) {
        return;
    }
    if (strcmp(fault, "nan") == 0) {
        *command = 0.0f / (time_s * 0.0f);
    } else if (strcmp(fault, "infinite") == 0) {
        *command = 1.0f / (time_s * 0.0f);
    } else if (strcmp(fault, "crash") == 0) {
        abort();
    } else if (strcmp(fault, "exit") == 0) {
        exit(7);
    } else if (strcmp(fault, "print") == 0) {
        printf("%g\\n", (double)time_s);
    }
    while (strcmp(fault, "loop") == 0) {
    }
}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With a C controller ``mine``, a short scenario and a record of both."""
    made = tmp_path_factory.mktemp("c")
    (made / "short.toml").write_text(RUN_72M_TOML, encoding="utf-8")
    assert railhil("new", "c-controller", "mine", cwd=made).exit_code == 0
    source = made / "mine/mine.c"
    text = source.read_text().replace('#include "mine.h"', f'#include "mine.h"\n{_FAULTS}')
    source.write_text(text.replace("out->notch = notch;", "out->notch = notch;\n    fail(in->time_s, &out->notch);"))
    done = run(made, "./mine", "record")
    assert done.exit_code in (0, 1), done.err
    return made


@pytest.fixture(scope="module")
def exported(folder: Path) -> str:
    """The export of a law in the folder."""
    assert railhil("export-c", "ipfc", "short.toml", "--out", "ipfc", cwd=folder).exit_code == 0
    return "ipfc/"


def words(controller: str, out: str, *options: str) -> tuple[str, ...]:
    return ("run", "short.toml", "--controller", controller, "--bus", "local", "--quiet", "--no-report", "--out", out,
            *options)  # fmt: skip


def run(folder: Path, controller: str, out: str, *options: str) -> Done:
    return railhil(*words(controller, out, *options), cwd=folder)


def make(folder: Path, *targets: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["make", "-s", *targets], cwd=folder, capture_output=True, text=True, check=False)


def notches(record: Path) -> list[str]:
    return [line.split()[2] for line in (record / "frames.log").read_text().splitlines() if " 110#" in line]


def given(record: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((record / "certificate.json").read_text())["given_controller"]
    return found


@pytest.mark.long
def test_the_how_to_of_the_page_works_from_an_empty_folder(tmp_path: Path) -> None:
    page = (ROOT / "docs/howto/controllers.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"## In C or C\+\+\n\n```sh[^\n]*\n(.*?)```", page, re.DOTALL)
    lines = block.splitlines()
    assert len(lines) <= 15
    for line in lines:
        program, *rest = line.split()
        if program == "make":
            assert make(tmp_path, *rest).returncode == 0, line
        else:
            rest += ["--bus", "local", "--no-report"] if rest[0] == "run" else []
            done = railhil(*rest, cwd=tmp_path)
            assert done.exit_code == 0, done.err
    assert len((tmp_path / "mine/README.md").read_text().splitlines()) <= 40


def test_the_test_of_a_new_folder_fails_when_the_body_is_wrong(tmp_path: Path) -> None:
    assert railhil("new", "c-controller", "mine", cwd=tmp_path).exit_code == 0
    mine = tmp_path / "mine"
    assert make(mine, "check").stdout == "OK\n"
    source = mine / "mine.c"
    source.write_text(source.read_text().replace("+ PROPORTIONAL", "- PROPORTIONAL"))
    done = make(mine, "check")
    assert (done.returncode != 0, "a train that is too slow is accelerated" in done.stdout) == (True, True)


def test_the_example_stays_within_the_notches_of_its_train_whatever_the_period(tmp_path: Path) -> None:
    text = RUN_72M_TOML + "[train]\nnotch_max = 4\n[timing]\ncontrol_period_ms = 1000\n"
    (tmp_path / "weak.toml").write_text(text, encoding="utf-8")
    for name, *options in (("weak",), ("python", "--python")):
        done = railhil("new", "c-controller", name, "--scenario", "weak.toml", *options, cwd=tmp_path)
        assert done.exit_code == 0, done.err
    assert make(tmp_path / "weak", "lib").returncode == 0
    library = ctypes.CDLL(str(tmp_path / "weak/build/weak.so"))
    readings, commands = (_members(tmp_path / "weak/railhil/weak.h", side) for side in ("readings", "commands"))
    given, answer = (ctypes.c_float * len(readings))(), (ctypes.c_float * len(commands))()
    given[readings.index("set_point_mps")] = 10.0
    library.weak_step(given, answer)
    python = runpy.run_path(str(tmp_path / "python/python.py"))["Controller"]()
    python.reset()
    reading = SimpleNamespace(**{**dict.fromkeys(readings, 0.0), "set_point_mps": 10.0})
    assert list(answer) == [python.step(reading)["notch"]] == [4.0]


def _members(header: Path, side: str) -> list[str]:
    """Names of the readings or commands of a controller, in the order of its header."""
    (found,) = re.findall(rf"typedef struct {{\n([^}}]*)}} \w+_{side}_t;", header.read_text())
    return re.findall(r"float (\w+);", found)


def test_the_certificate_has_files_and_compiler_and_a_rerun_gives_the_same_bytes(folder: Path) -> None:
    found = given(folder / "record")
    assert [Path(name).name for name in found["files"]] == ["Makefile", "controller.toml", "mine.c", "test_mine.c"]
    assert re.search(r"\d+\.\d+", found["compiler"])
    (program,) = (folder / "mine/build").glob("host-*/mine_node")
    assert found["program_sha256"] == hashlib.sha256(program.read_bytes()).hexdigest()
    again = railhil("rerun", "record", "--controller", "./mine", "--out", "again", cwd=folder)
    assert (again.exit_code, "same bytes" in again.out) == (0, True), again.err
    shutil.copytree(folder / "mine", folder / "changed", ignore=shutil.ignore_patterns("build"))
    (folder / "changed/mine.c").write_text((folder / "mine/mine.c").read_text() + "\n")
    refused = railhil("rerun", "record", "--controller", "./changed", "--out", "no", cwd=folder)
    assert (refused.exit_code, "changed/mine.c: sha256" in refused.one_line()) == (2, True)
    missing = railhil("rerun", "record", "--out", "no", cwd=folder)
    assert (missing.exit_code, "a controller is code" in missing.one_line()) == (2, True)


def test_a_library_gives_the_same_notches(folder: Path) -> None:
    """And no count of cycles: nothing is known of its code."""
    assert make(folder / "mine", "lib").returncode == 0
    assert run(folder, "mine/build/mine.so", "library").exit_code in (0, 1)
    assert notches(folder / "library") == notches(folder / "record")
    telemetry = json.loads((folder / "library" / "telemetry.json").read_text())
    assert (telemetry["operations"], telemetry["cycles"]["ram"]) == ({}, 0)
    assert len(set(notches(folder / "record"))) > 20
    refused = railhil("run", "hst_short", *words("mine/build/mine.so", "no2")[2:], cwd=folder)
    assert (refused.exit_code, "mine_interface: found" in refused.one_line()) == (2, True)
    refused = run(folder, "mine/build/mine.so:yours", "no3")
    assert (refused.exit_code, "has no yours_step" in refused.one_line()) == (2, True)
    (folder / "text.so").write_text("no library")
    refused = run(folder, "./text.so", "no4")
    assert (refused.exit_code, "cannot be loaded" in refused.one_line()) == (2, True)


@pytest.mark.long
def test_files_in_cpp_and_in_folders_are_compiled(folder: Path) -> None:
    shutil.copytree(folder / "mine", folder / "cpp", ignore=shutil.ignore_patterns("build"))
    cpp = folder / "cpp"
    (cpp / "parts").mkdir()
    (cpp / "mine.c").rename(cpp / "parts/mine.cpp")
    makefile = cpp / "Makefile"
    makefile.write_text(makefile.read_text().replace("SOURCES := mine.c", "SOURCES := parts/mine.cpp"))
    assert run(folder, "./cpp", "cpp_record").exit_code in (0, 1)
    assert notches(folder / "cpp_record") == notches(folder / "record")


def test_a_program_built_without_railhil_is_asked_for_on_the_hub(folder: Path, socket_folder: Path) -> None:
    made = railhil("new", "c-controller", "mine", "--scenario", "short.toml", "--out", "built", cwd=folder)
    assert made.exit_code == 0, made.err
    shutil.copy(folder / "mine/mine.c", folder / "built/mine.c")
    assert make(folder / "built").returncode == 0
    arguments = (str(folder / "short.toml"), "--controller", str(folder / "mine"))
    found = foreign_run(folder / "built/build/mine_node", socket_folder / "h.sock", folder / "hub", *arguments)
    assert (found.exit_code, found.done.exit_code in (0, 1)) == (0, True), found.said
    assert (folder / "hub/frames.log").read_bytes() == (folder / "record/frames.log").read_bytes()


def test_the_folder_of_an_export_runs_as_the_controller(folder: Path, exported: str) -> None:
    assert run(folder, exported, "exported").exit_code in (0, 1)
    assert run(folder, "ipfc", "law").exit_code in (0, 1)
    assert without_status(folder / "exported/frames.log") == without_status(folder / "law/frames.log")
    refused = railhil("run", "yizhuang_05", *words(exported, "no5")[2:], cwd=folder)
    assert (refused.exit_code, "scenario differs" in refused.err) == (2, True)


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ("nan", "mine_step: notch is no finite number"),
        ("infinite", "mine_step: notch is no finite number"),
        ("crash", "ended by SIGABRT"),
        ("exit", "has ended"),
        ("loop", "has not answered for 1 s"),
    ],
)
def test_a_fault_of_the_code_is_one_line_and_exit_code_2(
    folder: Path, fault: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FAULT", fault)
    done = run(folder, "./mine", fault, "--patience", "2")
    lines = [line for line in (done.out + done.err).splitlines() if said in line]
    assert (done.exit_code, len(lines), "Traceback" in done.err) == (2, 1, False), done.out + done.err
    programs = subprocess.run(["pgrep", "-f", str(folder / "mine")], capture_output=True, text=True, check=False)
    assert programs.stdout == ""


def test_what_the_code_prints_disturbs_nothing(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FAULT", "print")
    assert run(folder, "./mine", "printed").exit_code in (0, 1)
    assert notches(folder / "printed") == notches(folder / "record")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("out->notch = notch;", "out->brake = notch;", "error: "),
        ("void mine_step(", "void mine_stop(", "undefined reference to `mine_step'"),
        ("out->notch = notch;", "", "mine_step: notch is no finite number"),
    ],
    ids=["wrong C", "no function", "no command"],
)
def test_wrong_code_is_one_line_and_leaves_nothing_behind(folder: Path, old: str, new: str, said: str) -> None:
    wrong = folder / "wrong"
    shutil.rmtree(wrong, ignore_errors=True)
    shutil.copytree(folder / "mine", wrong, ignore=shutil.ignore_patterns("build"))
    source = wrong / "mine.c"
    source.write_text(source.read_text().replace(old, new).replace("fail(in->time_s, &out->notch);", ""))
    before = sorted(wrong.rglob("*"))
    done = run(folder, "./wrong", "no6")
    assert (done.exit_code, said in done.one_line(), (folder / "no6").exists()) == (2, True, False), done.err
    if "error" in said or "undefined" in said:
        assert sorted(wrong.rglob("*")) == before


def test_a_missing_compiler_is_one_line(folder: Path) -> None:
    done = railhil_process(*words("./mine", "no7"), environment={"PATH": "/nothing"}, cwd=folder, anew=True)
    lines = [line for line in done.stderr.splitlines() if not line.startswith("bus: ")]
    assert (done.returncode, len(lines), "gcc is not installed" in lines[-1]) == (2, 1, True)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("", "does not exist"),
        ('kind = "law"', "kind"),
        ('kind = "c-controller"\nname = "mine"\nsystem = "hst1"', "hst1"),
    ],
)
def test_a_wrong_table_of_a_folder_is_refused(folder: Path, change: str, said: str, tmp_path: Path) -> None:
    if change:
        (tmp_path / "controller.toml").write_text(change + "\n")
    done = run(folder, f"{tmp_path}/", "no8")
    assert (done.exit_code, said in done.one_line()) == (2, True)


@pytest.mark.parametrize("name", ["math", "given", "railhil_x", "Mine", "a-b"])
def test_a_name_with_another_meaning_is_refused(name: str, tmp_path: Path) -> None:
    done = railhil("new", "c-controller", name, cwd=tmp_path)
    assert (done.exit_code, name in done.one_line(), list(tmp_path.iterdir())) == (2, True, [])


def test_a_system_that_exports_no_c_is_refused_with_what_works(tmp_path: Path) -> None:
    done = railhil("new", "c-controller", "mine", "--scenario", "four_stops", cwd=tmp_path)
    said = "found 'four_stops', allowed one of a system whose laws are exported as C, not of line; or with --python"
    assert (done.exit_code, said in done.one_line(), list(tmp_path.iterdir())) == (2, True, [])


@pytest.mark.long
@pytest.mark.parametrize(
    ("scenario", "body"),
    [
        ("hst_short", "0.9f * (in->ref1 - in->speed) + 0.3f"),
        ("yizhuang_stop", "in->sent_u * 0.5f - in->speed1 * 0.03f"),
    ],
)
def test_other_systems_have_their_own_readings(scenario: str, body: str, tmp_path: Path) -> None:
    """The folder and the library give the same frames, but for the name in the handshake."""
    assert railhil("new", "c-controller", "mine", "--scenario", scenario, cwd=tmp_path).exit_code == 0
    source = tmp_path / "mine/mine.c"
    source.write_text(source.read_text().replace("(void)in;", "").replace("out->u = 0.0f", f"out->u = {body}"))
    assert make(tmp_path / "mine", "check", "lib").returncode == 0
    logs = []
    for controller in ("./mine", "mine/build/mine.so"):
        out = f"{Path(controller).name}_run"
        done = railhil("run", scenario, *words(controller, out)[2:], cwd=tmp_path)
        assert done.exit_code in (0, 1), done.err
        lines = (tmp_path / out / "frames.log").read_text().splitlines()
        logs.append([line for line in lines if not re.search(r" 1(6[89C]|7[01489C])#", line)])
    assert logs[0] == logs[1]


def test_a_difference_in_the_handshake_is_named(folder: Path, exported: str) -> None:
    done = run(folder, exported, "distance", "--indexing", "distance")
    assert done.exit_code == 2
    assert "indexing differs" in done.one_line()


def test_c_that_was_saved_after_it_was_named_is_not_built(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder / "mine", tmp_path / "mine")
    named = ControllerFolder(str(tmp_path / "mine"))
    named.hashes()
    source = tmp_path / "mine/mine.c"
    source.write_text(source.read_text() + "\n")
    with pytest.raises(InputError, match="files have changed since it was named"):
        named.sources(load("lvshun_tieshan"), LawSpec.of_given(named))


@pytest.mark.long
def test_a_build_knows_the_variables_that_change_it_and_no_others(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(folder / "mine", tmp_path / "mine", ignore=shutil.ignore_patterns("build"))
    shutil.copy(folder / "short.toml", tmp_path)
    for name in ("BUILD", "RAILHIL", "MAKEFLAGS", "CC"):
        monkeypatch.setenv(name, "" if name == "CC" else "elsewhere")
    for out in ("one", "two"):
        assert run(tmp_path, "./mine", out).exit_code in (0, 1)
        monkeypatch.setenv("CFLAGS", "-O0")
    assert len(list((tmp_path / "mine/build").glob("host-*"))) == 2


@pytest.mark.parametrize(
    "controller",
    ["./mine", "loops.py:step", pytest.param("qemu:./mine", marks=[pytest.mark.needs_qemu, pytest.mark.long])],
)
def test_nothing_is_left_of_a_command_that_is_killed(folder: Path, tmp_path: Path, controller: str) -> None:
    """While the code of the user loops."""
    assert railhil("new", "c-controller", "mine", cwd=tmp_path).exit_code == 0
    shutil.copy(folder / "short.toml", tmp_path)
    source = tmp_path / "mine/mine.c"
    looping = "out->notch = notch;\n    while (in->time_s >= 5.0f) { }"
    source.write_text(source.read_text().replace("out->notch = notch;", looping))
    (tmp_path / "loops.py").write_text("def step(reading):\n    while reading.time_s >= 5: pass\n    return 0\n")
    log, until_s = tmp_path / "out" / "frames.log", time.monotonic() + 60
    with subprocess.Popen(command(*words(controller, "out")), cwd=tmp_path, stderr=subprocess.DEVNULL) as started:
        while not (log.is_file() and log.stat().st_size) and time.monotonic() < until_s:
            time.sleep(0.05)
        children = psutil.Process(started.pid).children(recursive=True)
        started.kill()
    assert children
    _, left = psutil.wait_procs(children, timeout=5)
    assert left == []
