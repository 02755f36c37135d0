"""A controller in Python of the user in a hunt: its files repeat, and it is loaded only where it is named."""

from __future__ import annotations

import json
import shlex
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import pytest

import railhil
from hil_tests.support.cli import railhil as command
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.common.errors import InputError
from railhil.hunt.oracle import CONTROLLER, run_case
from railhil.hunt.plan import Plan, Request, make_plan
from railhil.scenarios.given import given_controller
from railhil.scenarios.run_spec import LawSpec, RunSpec

CODE = """
from pathlib import Path

Path(__file__).with_name("loaded").touch()

def step(reading):
    return 10.8 * (reading.set_point_mps - reading.speed_mps)

def picky(reading):
    if reading.speed_mps > 1.3:
        raise ValueError("too fast")
    return step(reading)

def local():
    return lambda reading: 0
"""
#: The first case of this seed violates the sentence.
SHORT = ("short.toml", "--requirements", "mine.toml", "--runs", "1", "--seed", "3", "--no-shrink")


def write(folder: Path) -> None:
    (folder / "mine.py").write_text(CODE, encoding="utf-8")
    (folder / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    (folder / "mine.toml").write_text(
        '[[requirement]]\nid = "CUT"\nsays = "never controller_level >= traction_cut"\n', encoding="utf-8"
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("given")
    write(made)
    done = command("hunt", *SHORT, "--controller", "mine.py:step", "--jobs", "2", "--out", "made", cwd=made)
    assert done.exit_code == 1, done.err
    (made / "said").write_text(done.out, encoding="utf-8")
    return made


def module_of(folder: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    found = spec_from_file_location("mine_of_a_hunt", folder / "mine.py")
    assert found is not None
    assert found.loader is not None
    module = module_from_spec(found)
    monkeypatch.setitem(sys.modules, found.name, module)
    found.loader.exec_module(module)
    return module


def plan_of(folder: Path) -> Plan:
    text = f"{folder / 'mine.py'}:step"
    controller = given_controller(text)
    assert controller is not None
    return make_plan(Request(str(folder / "short.toml"), controller=text), {text: controller})


@pytest.mark.long
def test_the_printed_command_names_it_and_repeats_the_run(folder: Path) -> None:
    said = (folder / "said").read_text(encoding="utf-8")
    assert said.startswith("short, mine-step@")
    (line,) = [line.strip() for line in said.splitlines() if line.strip().startswith("railhil run ")]
    words = shlex.split(line)[1:]
    assert words[2:] == ["--controller", "mine.py:step"]
    (found,) = json.loads((folder / "made" / "found.json").read_text(encoding="utf-8"))
    assert found["is_repeatable"]
    again = command(*words, "--no-report", "--out", "again", cwd=folder)
    assert again.exit_code == 1, again.err
    assert found["frames_sha256"] in again.out
    assert (folder / "made/found/CUT-1.toml").read_text(encoding="utf-8").count("--controller mine.py:step") == 1


@pytest.mark.long
def test_the_bench_gives_the_same_runs_and_the_file_is_named_again(folder: Path) -> None:
    (folder / "other.py").write_text(CODE.replace("10.8", "10.9"), encoding="utf-8")
    named = ("--controller", "mine.py:step")
    again = command("hunt", "--verify", "made", *named, "--runs", "1", cwd=folder)
    assert (again.exit_code, "1 of 1 runs are the same" in again.out) == (0, True), again.out + again.err
    assert command("hunt", "--resume", "made", *named, "--no-report", cwd=folder).exit_code == 1
    for words, said in (
        (("--verify", "made"), "code, which no file can load"),
        (("--resume", "made"), "code, which no file can load"),
        (("--resume", "made", "--controller", "other.py:step"), "to go on with it"),
        (("--verify", "made", "--controller", "other.py:step"), "what this installation would run"),
        (("--resume", "made", "--controller", "ipfc"), "to go on with it"),
    ):
        refused = command("hunt", *words, cwd=folder)
        assert refused.exit_code == 2, words
        assert said in refused.one_line()


@pytest.mark.long
def test_the_report_loads_no_code(folder: Path) -> None:
    (folder / "loaded").unlink(missing_ok=True)
    written = (folder / "made" / "report.html").read_bytes()
    assert command("report", "made", "--out", "page.html", cwd=folder).exit_code == 0
    assert not (folder / "loaded").exists()
    assert (folder / "page.html").read_bytes() == written
    assert b"mine-step@" in written


@pytest.mark.long
def test_a_function_at_the_top_of_a_file_is_hunted_in_a_call(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = module_of(folder, monkeypatch)
    outcome = railhil.hunt(
        folder / "short.toml", requirements=folder / "mine.toml", controller=module.step, runs=1, seed=3, shrink=False,
        out=folder / "called",
    )  # fmt: skip
    (found,) = json.loads((folder / "made" / "found.json").read_text(encoding="utf-8"))
    assert [case.frames_sha256 for case in outcome.cases] == [found["frames_sha256"]]


def test_code_that_no_process_can_load_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path)
    local = module_of(tmp_path, monkeypatch).local()
    for controller, said in (
        (local, r"railhil.hunt: controller: .*a name, FILE.py:NAME, or a function or class at the top of a file"),
        (3, r"railhil.hunt: controller: found 3, allowed the name of a law, FILE:NAME, or a function or class"),
        (tmp_path / "gone.py:step", r"gone.py: does not exist"),
    ):
        with pytest.raises(InputError, match=said):
            railhil.hunt(tmp_path / "short.toml", controller=controller)


def test_another_arithmetic_is_refused(tmp_path: Path) -> None:
    write(tmp_path)
    refused = command("hunt", *SHORT, "--controller", "mine.py:step", "--arithmetic", "iq", cwd=tmp_path)
    assert (refused.exit_code, "--arithmetic: cannot be given with" in refused.one_line()) == (2, True)


def test_another_text_of_its_file_is_another_hunt_and_another_place_is_not(tmp_path: Path) -> None:
    for name in ("here", "there", "changed"):
        (tmp_path / name).mkdir()
        write(tmp_path / name)
    file = tmp_path / "changed" / "mine.py"
    file.write_text(file.read_text(encoding="utf-8").replace("10.8", "10.9"), encoding="utf-8")
    here, there, changed = (plan_of(tmp_path / name).identity for name in ("here", "there", "changed"))
    assert here == there
    assert {key for key in here if here[key] != changed[key]} == {"label", "files", "law_sha256"}


def test_its_failures_alone_can_be_searched_for(tmp_path: Path) -> None:
    write(tmp_path)
    files = str(tmp_path / "short.toml"), (), (str(tmp_path / "mine.toml"),)
    plan = make_plan(Request(*files, only=(CONTROLLER,)))
    assert plan.requirements == ()
    assert not plan.is_searched("CUT")
    assert not plan.is_searched("INV-4")


def test_a_controller_that_raises_under_a_fault_is_a_finding(tmp_path: Path) -> None:
    write(tmp_path)
    controller = given_controller(f"{tmp_path / 'mine.py'}:picky")
    assert controller is not None
    base = RunSpec(str(tmp_path / "short.toml"), bus="local", law=LawSpec.of_given(controller))
    assert run_case(base, (), (), 0).violated == {}
    found = run_case(base, (), ("traction full @1s for 3s",), 0)
    assert list(found.violated) == [CONTROLLER]
    assert "mine.py:11: step: it raises ValueError: too fast" in found.violated[CONTROLLER]
    assert plan_of(tmp_path).is_searched(CONTROLLER)
