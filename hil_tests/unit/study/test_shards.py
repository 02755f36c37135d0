"""``--shard K/N``: any order, any sharding and any kills give the bytes of one undisturbed process."""

from __future__ import annotations

import argparse
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hil_tests.support.cli import railhil, wait_for
from hil_tests.support.paths import ROOT
from hil_tests.support.toy_study import TOY, Plan, Request, contents, make
from railhil.common.errors import InputError
from railhil.study.parts import opened
from railhil.study.plan import Shard

RUNS = 5
REQUEST = Request(runs=RUNS)


class Killed(BaseException):
    """As SIGKILL does, it leaves no process that could tidy up."""


@dataclass(frozen=True)
class Step:
    """A process that makes a shard in a folder, and is killed before a part (None: it comes to its end); ``torn``: in
    the middle of a line of its list and of a file."""

    number: int
    count: int
    folder: int
    killed_before: int | None
    torn: bool


@st.composite
def steps(draw: st.DrawFn) -> Step:
    count = draw(st.integers(1, 5))
    number = draw(st.integers(1, count))
    return Step(number, count, draw(st.integers(0, 2)), draw(st.none() | st.integers(0, 3)), draw(st.booleans()))


@cache
def undisturbed() -> dict[str, bytes]:
    with TemporaryDirectory() as folder:
        make(REQUEST, Path(folder) / "toy")
        return contents(Path(folder) / "toy")


def take(step: Step, folder: Path) -> None:
    def kill(count: int) -> None:
        if count == step.killed_before:
            raise Killed

    try:
        make(REQUEST, folder, f"{step.number}/{step.count}", kill)
    except Killed:
        if step.torn:
            with (folder / "parts" / f"shard-{step.number}-of-{step.count}.sha256").open("a") as listed:
                listed.write("0123456789abcdef")
            (folder / "parts" / ".part-torn.parquet").write_bytes(b"PAR1")


@pytest.mark.slow
@settings(max_examples=15, deadline=None)
@given(st.lists(steps(), max_size=6))
def test_any_shards_killed_at_random_in_any_folders_merge_to_the_same_bytes(taken: list[Step]) -> None:
    """Folders of several machines are copied into one, in any order; one process makes what is missing."""
    with TemporaryDirectory() as private:
        folders = [Path(private) / str(index) for index in range(3)]
        for step in taken:
            take(step, folders[step.folder])
        whole = Path(private) / "whole"
        for folder in reversed(folders):
            if folder.exists():
                shutil.copytree(folder, whole, dirs_exist_ok=True)
        make(REQUEST, whole)
        assert contents(whole) == undisturbed()


@pytest.mark.slow
@settings(max_examples=10, deadline=None)
@given(st.integers(1, 9).flatmap(lambda count: st.permutations(range(1, count + 1))))
def test_the_last_shard_joins_all_parts(order: list[int]) -> None:
    with TemporaryDirectory() as private:
        folder = Path(private) / "toy"
        for number in order[:-1]:
            made, _ = make(REQUEST, folder, f"{number}/{len(order)}")
            # A shard beyond the last part has none: then the others may be complete.
            if not made.is_whole:
                assert not (folder / "results.parquet").exists()
        made, _ = make(REQUEST, folder, f"{order[-1]}/{len(order)}")
        assert made.is_whole
        assert made.summary["runs"] == RUNS
        assert contents(folder) == undisturbed()


def test_a_part_that_is_not_as_its_shard_has_listed_it_is_made_again(tmp_path: Path) -> None:
    make(REQUEST, tmp_path, "1/2")
    listed = tmp_path / "parts" / "shard-1-of-2.sha256"
    listed.write_text(listed.read_text().replace("toy-00002", "toy-00003"))
    _, said = make(REQUEST, tmp_path)
    assert said[0].endswith("toy-00002.parquet is not as listed in SHA256SUMS: its 1 run is made again")
    assert contents(tmp_path) == undisturbed()


@pytest.mark.parametrize("text", ["0/4", "5/4", "x/y", "1", "1/0", "-1/4", "1/4/4", "1.0/2", ""])
def test_a_wrong_shard_says_what_is_allowed(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match=re.escape(f"found {text}, allowed K/N with K from 1 to N")):
        Shard.parse(text)


@pytest.mark.parametrize("command", ["campaign", "learn"])
def test_a_wrong_shard_is_one_line_and_exit_code_2(command: str, tmp_path: Path) -> None:
    for words, said in (
        (("--shard", "5/4", "--out", "mine"), "--shard: found 5/4, allowed K/N with K from 1 to N"),
        (("--shard", "1/4"), "--shard: used only with --out or --resume"),
        (("--shard", "1/4", "--verify", "mine"), "--verify: cannot be given with --shard, only with"),
    ):
        done = railhil(command, *words, cwd=tmp_path)
        assert done.exit_code == 2
        assert said in done.one_line()
    assert not list(tmp_path.iterdir())


def test_shards_of_another_plan_or_of_other_code_are_refused(tmp_path: Path) -> None:
    mine, other = tmp_path / "mine", tmp_path / "other"
    make(REQUEST, mine, "1/2")
    for request, key in ((Request(runs=6), "runs"), (Request(runs=RUNS, code="other"), "code")):
        with pytest.raises(InputError, match=rf"toy\.json: toy\.{key}: found "):
            make(request, mine, "2/2")
    # Also where they come from a folder of their own.
    make(Request(runs=RUNS, code="other"), other, "2/2")
    shutil.copy(other / "parts" / "shard-2-of-2.sha256", mine / "parts")
    for shard in (None, "2/2"):
        with pytest.raises(InputError, match=r"shard-2-of-2\.sha256: line 1: found '# toy .* shards of one plan"):
            make(REQUEST, mine, shard)


def test_one_process_alone_or_shards_each_once(tmp_path: Path) -> None:
    plan, folder = Plan(REQUEST), str(tmp_path / "toy")
    with opened(TOY, plan, folder, Shard(1, 2)), opened(TOY, plan, folder, Shard(2, 2)):
        for shard, words in (
            (None, "is in use by a toy"),
            (Shard(1, 2), "a toy of shard 1/2 that is running"),
        ):
            with pytest.raises(InputError, match=words), opened(TOY, plan, folder, shard):
                pass
    with (
        opened(TOY, plan, folder),
        pytest.raises(InputError, match="is in use by a toy"),
        opened(TOY, plan, folder, Shard(1, 2)),
    ):
        pass


def test_a_folder_with_something_else_is_no_folder_of_shards(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").touch()
    with pytest.raises(InputError, match=r"--out: found .* allowed an empty or new folder"):
        make(REQUEST, tmp_path, "1/2")
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


@pytest.mark.long
@pytest.mark.slow
def test_processes_killed_at_random_in_one_folder_give_the_same_bytes(tmp_path: Path) -> None:
    draw, folder, runs, shards = random.Random(1), tmp_path / "shards", 60, range(1, 4)

    def begin(number: int) -> subprocess.Popen[bytes]:
        words = [str(folder), str(runs), f"{number}/{len(shards)}"]
        return subprocess.Popen([sys.executable, "-m", "hil_tests.support.toy_study", *words], cwd=ROOT)

    # All of them begin at the same instant in a folder that is not there.
    running = {number: begin(number) for number in shards}
    kills = 0
    for _ in range(4):
        wait_for(lambda: any(folder.glob("parts/*.parquet")) or running[1].poll() is not None)
        time.sleep(draw.uniform(0.0, 0.2))
        number = draw.choice(list(shards))
        running[number].send_signal(signal.SIGKILL)
        kills += running[number].wait() == -signal.SIGKILL
        running[number] = begin(number)
    assert [process.wait() for process in running.values()] == [0, 0, 0]
    assert kills
    make(Request(runs=runs), tmp_path / "whole")
    assert contents(folder) == contents(tmp_path / "whole")
