"""The runner of the whole suite: what it prints, what runs at the same time, and how it ends."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import pytest

from hil_tests import everything, parts
from hil_tests.parts import Part
from hil_tests.support.cli import wait_for
from railhil.common.exit_codes import guarded


def part(key: str, name: str, script: str, *, beside: bool = True) -> Part:
    """A part that is shell text."""
    return Part(key, name, ["sh", "-c", script], beside=beside)


#: Any machine that runs these tests has enough cores.
run = partial(parts.run, cores=2)


@pytest.fixture
def printed(capfd):
    """What has been printed since it was asked last, without the seconds, which nobody knows."""

    def read() -> list[str]:
        lines = capfd.readouterr().out.splitlines()
        return [line.partition(" after ")[0] for line in lines if line]

    return read


def meet(here: Path, there: Path) -> str:
    """Shell text that ends only when another part runs at the same time."""
    return f"touch {here}; until [ -e {there} ]; do sleep 0.05; done; "


def test_parts_of_different_keys_run_at_the_same_time_and_are_printed_whole_in_order(tmp_path, printed):
    one, other = tmp_path / "one", tmp_path / "other"
    # The first ends last.
    first = f"echo a; {meet(one, tmp_path / 'third')} echo b >&2; exit 3"
    second = f"echo c; {meet(other, one)} echo d"
    third = f"echo e; touch {tmp_path}/third"
    suite = [part("x", "first", first), part("y", "second", second), part("y", "third", third)]
    assert run(suite) == [3, 0, 0]
    assert printed() == [
        "=== side by side, each printed at its end: first; second, then third ===",
        "=== first ===", "a", "b", "=== first: exit code 3",
        "=== second ===", "c", "d", "=== second: exit code 0",
        "=== third ===", "e", "=== third: exit code 0",
    ]  # fmt: skip


def test_parts_of_one_key_never_run_side_by_side(tmp_path, printed):
    held = f"mkdir {tmp_path}/held && sleep 0.2 && rmdir {tmp_path}/held"
    assert run([part("x", "a", "true"), part("y", "b", held), part("y", "c", held)]) == [0, 0, 0]
    # One key alone prints as it goes.
    assert run([part("y", "b", held), part("y", "c", held)]) == [0, 0]
    assert printed()[-4:] == ["=== b ===", "=== b: exit code 0", "=== c ===", "=== c: exit code 0"]


@pytest.mark.parametrize("cores", [1, 2])
def test_only_neighbours_that_may_and_only_where_there_are_two_cores(cores):
    suite = [part("x", "a", "", beside=False), part("x", "b", "", beside=False), part("y", "c", ""), part("z", "d", "")]
    names = [[one.name for one in group] for group in parts._groups(suite, cores)]
    assert names == ([["a"], ["b"], ["c", "d"]] if cores == 2 else [["a"], ["b"], ["c"], ["d"]])


def ended_by(number: int, suite: Sequence[Part], started: Sequence[Path], output: Path, end_s: float = 60.0) -> int:
    """Exit code of the suite in a process that gets a signal when all those files are there."""

    def process() -> None:
        with output.open("w") as said:
            os.dup2(said.fileno(), 1)
            sys.stdout = said
            code = 1
            try:
                code = guarded("everything", lambda: everything.main([], suite, partial(run, end_s=end_s)))
            except SystemExit as error:
                code = int(error.code or 0)
        os._exit(code)

    child = multiprocessing.get_context("fork").Process(target=process)
    child.start()
    try:
        for file in started:
            wait_for(file.exists)
        os.kill(child.pid, number)
        child.join(30.0)
    finally:
        child.kill()
        child.join()
    return child.exitcode


@pytest.mark.parametrize(("number", "trap"), [(signal.SIGINT, "INT"), (signal.SIGTERM, "TERM")])
def test_signal_ends_all_with_what_they_have_started_and_prints_what_they_have_said(tmp_path, number, trap):
    files = [tmp_path / name for name in ("a", "b")]
    script = "exec 2>/dev/null; trap 'echo taken down; exit 5' {trap}; echo said; sh -c 'echo $$ >{file}.new; "
    script += "mv {file}.new {file}; exec sleep 600'"
    suite = [part(name, name, script.format(trap=trap, file=tmp_path / name)) for name in ("a", "b")]
    suite.append(part("b", "never", f"touch {tmp_path}/never"))
    code = ended_by(number, suite, files, tmp_path / "out")
    assert code == 128 + number
    said = [line.partition(" after ")[0] for line in (tmp_path / "out").read_text().splitlines() if line]
    assert said[1:] == [
        "=== a ===", "said", "taken down", "=== a: exit code 5",
        "=== b ===", "said", "taken down", "=== b: exit code 5",
    ]  # fmt: skip
    assert not (tmp_path / "never").exists()
    assert [Path(f"/proc/{file.read_text().strip()}").exists() for file in files] == [False, False]


def test_part_that_does_not_end_is_killed(tmp_path):
    stubborn = f"trap '' TERM; touch {tmp_path}/a; while :; do sleep 0.05; done"
    suite = [part("a", "a", stubborn), part("b", "b", f"touch {tmp_path}/b; exec sleep 600")]
    code = ended_by(signal.SIGTERM, suite, [tmp_path / "a", tmp_path / "b"], tmp_path / "out", end_s=0.2)
    assert code == 128 + signal.SIGTERM
    assert "=== a: exit code -9 after" in (tmp_path / "out").read_text()


@pytest.mark.parametrize(("demanded", "code"), [("", 0), ("1", 1)])
def test_missing_capability_fails_only_where_all_are_demanded(monkeypatch, printed, demanded, code):
    monkeypatch.setenv("RAILHIL_REQUIRE_ALL", demanded)
    suite = [part("a", "a", "exit 77"), part("b", "b", "true")]
    assert everything.main([], suite) == code
    assert printed()[-2:] == [
        "MISSING CAPABILITY: a: its tests did NOT run on this machine",
        "1 passed, 0 failed, 1 skipped",
    ]


def test_machines_and_engines_of_the_suite_are_two_lanes_at_its_end():
    groups = parts._groups(everything.parts(), 2)
    assert [[one.key for one in group] for group in groups] == [
        ["anywhere"],
        ["anywhere"],
        ["vcan", "compose", "compose"],
    ]
