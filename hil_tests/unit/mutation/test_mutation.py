"""The mutation tester on a module made for it, and a few mutants of the bench, so that neither can rot."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from hil_tests.mutation import targets
from hil_tests.mutation.install import path_of
from hil_tests.mutation.operators import mutants
from hil_tests.mutation.targets import ROOT, explained, modules

SUBJECT = '''\
"""A module with every kind of place."""

LIMIT = 3
SPARE = 7


class Box:
    size = 2

    @property
    def double(self) -> int:
        return self.size * 2


def clipped(value: float) -> float:
    if value > LIMIT:
        return LIMIT
    return max(value, 0.5)


def forever(count: int) -> int:
    while count > 0:
        count -= 1
    return -count
'''
TESTS = """\
import pytest
from subject import Box, clipped, forever


def test_clipped():
    assert [clipped(x) for x in (-1.0, 0.5, 2.0, 3.0, 4.0)] == [0.5, 0.5, 2.0, 3, 3]


def test_box():
    assert Box().double == 4


def test_forever():
    assert forever(5) == 0
"""


@pytest.fixture
def subject(tmp_path: Path) -> Path:
    (tmp_path / "subject.py").write_text(SUBJECT, encoding="utf-8")
    (tmp_path / "test_subject.py").write_text(TESTS, encoding="utf-8")
    return tmp_path


def command(folder: Path, *arguments: str) -> tuple[int, list[str]]:
    done = subprocess.run(
        [sys.executable, "-m", "hil_tests.mutation", *arguments],
        cwd=folder, env={"PYTHONPATH": f"{folder}:{ROOT}", "PATH": ""}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.stderr == ""
    return done.returncode, done.stdout.splitlines()


@pytest.mark.long
@pytest.mark.slow
def test_what_no_test_notices_is_named(subject: Path) -> None:
    """Inside functions and outside. An endless loop is noticed."""
    code, said = command(subject, "subject", "--tests", "test_subject.py", "--jobs", "2")
    assert (code, said[0]) == (1, "subject: 27 mutants, 22 noticed, 0 explained, 5 not")
    alive = {"SPARE = 8", "SPARE = 6", "clipped: if value >= LIMIT:", "forever: return 0", "forever: return count"}
    assert {line.strip() for line in said[2::2]} == alive


@pytest.mark.long
@pytest.mark.slow
def test_a_text_that_no_mutant_contains_is_an_error(subject: Path) -> None:
    code, said = command(subject, "subject", "--tests", "test_subject.py", "--jobs", "1", "--only", "LIMIT: int")
    assert (code, said[-1]) == (1, "no mutant contains 'LIMIT: int'")


@pytest.mark.long
@pytest.mark.slow
def test_tests_that_fail_without_a_mutant_judge_nothing(subject: Path) -> None:
    (subject / "test_subject.py").write_text("def test_wrong():\n    assert False\n", encoding="utf-8")
    code, said = command(subject, "subject", "--tests", "test_subject.py")
    assert (code, said) == (1, ["  fails without any change: test_subject.py::test_wrong"])


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_nothing_outlives_the_command(subject: Path, number: signal.Signals) -> None:
    """Every process of the command has the writing end of a pipe: at its other end, the end of the file is the last
    one's."""
    began = subject / "began"
    waits = (
        f"import pathlib, time\n\n\ndef test_waits():\n    pathlib.Path({str(began)!r}).touch()\n    time.sleep(60)\n"
    )
    (subject / "test_subject.py").write_text(waits, encoding="utf-8")
    reading, writing = os.pipe()
    environment = {"PYTHONPATH": f"{subject}:{ROOT}", "PATH": ""}
    words = [sys.executable, "-m", "hil_tests.mutation", "subject", "--tests", "test_subject.py"]
    with subprocess.Popen(
        words, cwd=subject, env=environment, pass_fds=[writing], stderr=subprocess.PIPE, text=True
    ) as done, os.fdopen(reading, "rb") as pipe:  # fmt: skip
        os.close(writing)
        while not began.exists():
            assert done.poll() is None
            time.sleep(0.01)
        done.send_signal(number)
        assert done.communicate(timeout=30)[1] == ""
        assert done.returncode == (130 if number == signal.SIGINT else -number)
        assert select.select([pipe], [], [], 30)[0]
        assert pipe.read() == b""


def test_every_target_exists() -> None:
    for module in modules():
        assert Path(path_of(module)).is_file()
        assert all((ROOT / name).is_file() for name in targets.tests_of(module)), module


@pytest.mark.parametrize("module", modules())
def test_every_explained_survivor_is_a_mutant(module: str) -> None:
    known = explained(module)
    keys = Counter(mutant.key for mutant in mutants(Path(path_of(module)).read_text("utf-8"))) if known else Counter()
    assert [key for key in known if keys[key] != 1] == []
    assert all(why.strip() for why in known.values())


@pytest.mark.long
@pytest.mark.slow
def test_some_mutants_of_the_bench() -> None:
    """A fixed sample; all of them: ``python -m hil_tests.mutation``."""
    subjects = ("railhil.systems.ato.judge.measures", "railhil.judge.record_checks", "railhil.bus.acceptance")
    code, said = command(ROOT, *subjects, "--sample", "8", "--seed", "12", "--jobs", "2")
    assert code == 0, said
    assert [line.partition(":")[0] for line in said] == list(subjects)


@pytest.mark.long
@pytest.mark.slow
def test_a_changed_constant_of_the_bench_is_seen() -> None:
    """Its modules must come from the changed tree although they belong to a plugin of pytest."""
    module = "railhil.controller_node.ato.speed_monitors"
    code, said = command(ROOT, module, "--only", "WINDOW_MS: Final = 10000", "--jobs", "2")
    assert (code, said) == (0, [f"{module}: 2 mutants, 2 noticed, 0 explained, 0 not"])
