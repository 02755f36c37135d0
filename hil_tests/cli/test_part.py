"""The parts of ``make test``: counting, missing and required capabilities, and how a part is ended."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from hil_tests import part
from hil_tests.support.cli import wait_for
from hil_tests.support.paths import ROOT
from railhil.machines import debian

CLOSING = "3 passed, 1 skipped, 2 deselected in 4.56s"


@pytest.fixture(autouse=True)
def handlers():
    """A part changes those of its process."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize(
    ("script", "code", "closing"),
    [
        (f"echo 9 passed in 1.00s; echo {CLOSING}", 0, "3 passed, 0 failed, 1 skipped"),
        ("echo '=== 1 failed, 2 passed, 1 error in 4.56s (0:01:02) ==='; echo ..; exit 1", 1, "2 passed, 2 failed"),
        ("echo no tests ran in 0.01s; exit 5", 1, "0 passed, 1 failed, 0 skipped"),
        (f"echo {CLOSING}; exit 125", 1, "3 passed, 1 failed, 1 skipped"),
        ("exit 77", 0, "0 passed, 0 failed, 1 skipped"),
    ],
)  # fmt: skip
def test_counts_are_those_of_the_closing_line(monkeypatch, capsys, script, code, closing):
    monkeypatch.delenv("RAILHIL_REQUIRE_ALL", raising=False)
    assert part.main(["kernel SocketCAN", "sh", "-c", script]) == code
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1].startswith(closing)
    said = "MISSING CAPABILITY: kernel SocketCAN: its tests did NOT run on this machine" in lines
    assert said == ("77" in script)


@pytest.mark.parametrize(("demanded", "code"), [("", 0), ("1", 1)])
def test_missing_capability_fails_only_where_all_are_demanded(monkeypatch, capsys, demanded, code):
    def none() -> None:
        raise debian.CapabilityError("no mirror")

    monkeypatch.setenv("RAILHIL_REQUIRE_ALL", demanded)
    monkeypatch.setitem(part.TOOLS, "compilers", none)
    assert part.main(["--tool", "compilers", "here", "echo", CLOSING]) == code
    assert part.main(["machine", "sh", "-c", "exit 77"]) == code
    out = capsys.readouterr().out
    assert "MISSING CAPABILITY: compilers: no mirror: its tests did NOT run on this machine\n" in out
    assert "3 passed, 0 failed, 2 skipped" in out or code == 1


def test_a_part_behind_takes_only_time_that_nobody_wants():
    """A process of its own: nobody gives this class of scheduling back without permission."""
    asked = f"import os; print(os.sched_getscheduler(0) == os.SCHED_IDLE); print({CLOSING!r})"
    words = [sys.executable, "-m", "hil_tests.part", "--behind", "machine", sys.executable, "-c", asked]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[2] == "True"


def test_total_is_the_sum_and_judges(tmp_path, capsys):
    counts = ["--counts", str(tmp_path / "build" / "counts")]
    assert part.main([*counts, "first", "sh", "-c", "echo 1 failed, 5 passed in 1.00s; exit 1"]) == 0
    assert part.main([*counts, "second", "echo", CLOSING]) == 0
    assert part.main([*counts, "--total", "2"]) == 1
    assert capsys.readouterr().out.splitlines()[-3:] == [
        "first: 5 passed, 1 failed, 0 skipped",
        "second: 3 passed, 0 failed, 1 skipped",
        "8 passed, 1 failed, 1 skipped",
    ]


def test_a_part_that_left_no_count_is_a_failure(tmp_path, capsys):
    counts = ["--counts", str(tmp_path / "counts")]
    assert part.main([*counts, "--total", "2"]) == 1
    assert part.main([*counts, "first", "echo", CLOSING]) == 0
    assert part.main([*counts, "--total", "2"]) == 1
    assert part.main([*counts, "--total", "1"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "3 passed, 0 failed, 1 skipped"


def _parts(text):
    """Targets that are a part; of several with one recipe the first does what the others do."""
    found = re.findall(r"^(test-[-a-z ]+):.*\n\t@\$\(PART\) (?!--counts)", text, re.M)
    return [name for names in map(str.split, found) for name in names[len(names) > 1 :]]


@pytest.mark.parametrize("target", ["test", "test-long"])
def test_make_sums_all_parts(target):
    text = (ROOT / "Makefile").read_text(encoding="utf-8")
    (recipe,) = re.findall(rf"^{target}:.*\n((?:\t.*\n)+)", text, re.M)
    there = [name for name in _parts(text) if re.search(rf" {name}\b(?!-)", recipe)]
    assert f"--total {len(there)}\n" in recipe
    assert len(there) > 1


def test_every_part_is_in_one_of_them():
    text = (ROOT / "Makefile").read_text(encoding="utf-8")
    recipes = re.findall(r"^test(?:-long)?:.*\n((?:\t.*\n)+)", text, re.M)
    for name in _parts(text):
        assert sum(len(re.findall(rf" {name}\b(?!-)", recipe)) for recipe in recipes) == 1, name


def test_told_to_end_it_ends_its_command_and_passes_on_what_that_says(tmp_path):
    started = tmp_path / "started"
    script = f"trap 'echo taken down; exit 143' TERM; echo $$ >{started}; while :; do sleep 0.05; done"
    process = subprocess.Popen(
        [sys.executable, "-m", "hil_tests.part", "machine", "sh", "-c", script], cwd=ROOT, stdout=subprocess.PIPE,
        text=True,
    )  # fmt: skip
    wait_for(lambda: started.exists() and started.read_text().strip())
    process.terminate()
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "taken down\nFAILED: machine: exit code 143\n0 passed, 1 failed, 0 skipped\n" in out
    assert not Path("/proc", started.read_text().strip()).exists()
