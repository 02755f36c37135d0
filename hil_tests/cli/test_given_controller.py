"""A controller in Python that the user names instead of a law: by call, and by its file on every bus."""

from __future__ import annotations

import json
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest

import railhil
from hil_tests.support.cli import railhil as command
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.common.errors import InputError

#: A P controller, and the faults that code of a user can have.
CODE = """
import os, signal

class Proportional:
    def reset(self):
        self.steps = 0
    def step(self, reading):
        self.steps += 1
        return {"notch": 3.6 * (reading.set_point_mps - reading.speed_mps)}

def proportional(reading):
    return 3.6 * (reading.set_point_mps - reading.speed_mps)

def not_finite(reading):
    return float("nan") if reading.time_s >= 2 else 0

def raises(reading):
    if reading.time_s >= 2:
        raise ValueError("no more")
    return 0

def crashes(reading):
    os.kill(os.getpid(), signal.SIGSEGV)

def leaves(reading):
    os._exit(7)

def quits(reading):
    raise SystemExit(3)

def loops(reading):
    while True:
        pass

def asks_for_two(speed, set_point):
    return 0

def answers_text(reading):
    return "three"

def answers_another(reading):
    return {"brake": 1}

NUMBER = 3
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("given")
    (made / "mine.py").write_text(CODE, encoding="utf-8")
    (made / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    return made


def run(folder: Path, out: str, name: str, *options: str) -> Any:
    words = ("run", folder / "short.toml", "--controller", f"{folder / 'mine.py'}:{name}", "--quiet", "--no-report")
    return command(*words, "--out", folder / out, *options)


def certificate(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "certificate.json").read_text(encoding="utf-8"))
    return found


@pytest.fixture(scope="module")
def made(folder: Path) -> Path:
    """A run of the P controller, in this process."""
    assert run(folder, "made", "proportional", "--bus", "local").exit_code in (0, 1)
    return folder / "made"


@pytest.mark.long_after(1)
@pytest.mark.parametrize("options", [(), ("-i", "railhil")])
def test_the_bytes_are_the_same_on_every_bus(folder: Path, made: Path, options: tuple[str, ...]) -> None:
    out = f"bus{len(options)}"
    assert run(folder, out, "proportional", *options).exit_code in (0, 1)
    assert certificate(folder / out)["frames_sha256"] == certificate(made)["frames_sha256"]


def test_function_object_and_file_are_the_same_controller(folder: Path, made: Path) -> None:
    code: dict[str, Any] = {}
    exec(compile(CODE, "notebook", "exec"), code)  # noqa: S102
    wanted = certificate(made)["frames_sha256"].encode()
    for name in ("proportional", "Proportional"):
        outcome = railhil.run(folder / "short.toml", controller=code[name], out=folder / name)
        # The name in the handshake is another one.
        assert without_handshake(outcome.folder) == without_handshake(made), wanted
        assert outcome.certificate["given_controller"]["files"] == {}
        assert outcome.certificate["arithmetic"] == "float64"


def without_handshake(folder: Path) -> list[str]:
    lines = (folder / "frames.log").read_text(encoding="ascii").splitlines()
    return [line for line in lines if " 110#" in line]


def test_the_certificate_holds_the_hash_of_the_file_and_a_rerun_needs_the_same(folder: Path, made: Path) -> None:
    recorded = certificate(made)["given_controller"]
    (path,) = recorded["files"]
    assert path == str(folder / "mine.py")
    assert command("rerun", made).exit_code == 2
    text = f"{folder / 'mine.py'}:proportional"
    assert command("rerun", made, "--controller", text).exit_code == 0
    other = folder / "other.py"
    other.write_text(CODE.replace("3.6", "3.7"), encoding="utf-8")
    refused = command("rerun", made, "--controller", f"{other}:proportional")
    assert refused.exit_code == 2
    assert recorded["files"][path] in refused.err
    again = command("run", "--spec", made / "certificate.json", "--quiet", "--no-report", "--out", folder / "again")
    assert (again.exit_code, "code, which no file can load" in again.err) == (2, True)
    assert not (folder / "again").exists()


def test_the_record_is_judged_without_the_code(made: Path) -> None:
    assert command("verify", made).exit_code == 0
    assert command("score", made).exit_code in (0, 1)
    assert railhil.open_run(made).spec.law.label == certificate(made)["given_controller"]["label"]


WRONG = [
    ("not_finite", "not_finite: answer, notch: found nan, allowed a finite number"),
    ("raises", "mine.py:19: step: it raises ValueError: no more"),
    ("crashes", "crashes: control period 1: its process was killed by SIGSEGV"),
    ("leaves", "control period 1: its process ended with exit code 7"),
    ("quits", "EndsInterpreter"),
    ("loops", "loops: control period 1: no answer within 1 s"),
    ("asks_for_two", "start: asks_for_two(speed, set_point), expected one argument, the reading"),
    ("answers_text", "answer, notch: found 'three', allowed a number for notch (notch)"),
    ("answers_another", "answer: found {'brake': 1}, allowed a number for notch (notch)"),
    ("NUMBER", "start: a int, expected a function of the reading, or an object with step"),
    ("nothing", "mine.py: start: has no nothing, expected one of"),
]
#: On a bus, some of them are enough for most days.
WRONG_RUNS = [
    *((*one, ("--bus", "local")) for one in WRONG),
    *(
        pytest.param(*one, (), marks=[] if one[0] in ("raises", "crashes", "loops") else pytest.mark.long)
        for one in WRONG
    ),
]


@pytest.mark.parametrize(("name", "said", "bus"), WRONG_RUNS)
def test_wrong_code_is_one_line(folder: Path, tmp_path: Path, name: str, said: str, bus: tuple[str, ...]) -> None:
    found = run(folder, str(tmp_path / "out"), name, *bus, "--patience", "2")
    assert found.exit_code == 2
    assert said in found.out + found.err
    assert "Traceback" not in found.out + found.err
    assert not processes_of(folder)


def processes_of(folder: Path) -> list[str]:
    """Processes that are still there a moment later."""
    for _ in range(20):
        listed = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout
        left = [line for line in listed.splitlines() if "given.worker" in line and str(folder) in line]
        if not left:
            return []
        time.sleep(0.05)
    return left


def test_a_restart_begins_with_a_new_object(folder: Path) -> None:
    found = run(folder, "restart", "Proportional", "--bus", "local", "--fault", "controller restart @2s for 100ms")
    assert found.exit_code == 1
    assert "controller restart" in found.out
    assert not processes_of(folder)


def test_it_stands_beside_laws_in_a_comparison(folder: Path) -> None:
    laws = f"ipfc,{folder / 'mine.py'}:proportional"
    options = ("--bus", "local", "--quiet", "--no-report", "--out", folder / "compare")
    assert command("compare", folder / "short.toml", "--laws", laws, *options).exit_code in (0, 1)
    compared = json.loads((folder / "compare" / "compare.json").read_text(encoding="utf-8"))
    assert "mine-proportional" in json.dumps(compared)


def test_a_controller_of_another_system_gets_its_readings_and_answers_its_commands(tmp_path: Path) -> None:
    names: set[str] = set()

    def brake(reading: Any) -> dict[str, float]:
        names.update(reading._fields)
        return {"u": -800.0, "start": 0.0, "valid": 1.0}

    outcome = railhil.run("yizhuang_stop", controller=brake, out=tmp_path / "stop")
    assert outcome.verdict == "FAIL"
    assert {"speed1", "odometer", "sent_u"} <= names


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--arithmetic", "iq"), "--arithmetic: cannot be given with --controller"),
        (("--memory", "m"), "--memory: cannot be given with --controller"),
    ],
)
def test_options_of_laws_are_refused(folder: Path, options: tuple[str, ...], said: str) -> None:
    found = run(folder, "refused", "proportional", *options)
    assert (found.exit_code, said in found.err) == (2, True)


def test_a_text_that_names_nothing_is_one_line(folder: Path) -> None:
    for text in ("mine.txt", "a/b", str(folder / "gone.py:step"), str(folder / "mine.py:a-b")):
        found = command("run", "--controller", text)
        assert (found.exit_code, found.err.count("\n")) == (2, 1), text
    with pytest.raises(InputError, match=r"given.*nothing|allowed a law"):
        railhil.run(controller="a/b")
