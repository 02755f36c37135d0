"""Branches of a run: the bytes of the straight run with the same faults, in a process that leaves nothing behind."""

from __future__ import annotations

import hashlib
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.support.branches import TRUNKS, random_texts, straight_sha256, trunk_spec
from hil_tests.support.cli import railhil
from hil_tests.support.short_runs import RUN_2M_TOML, RUN_297M_TOML
from railhil.common.errors import InputError
from railhil.judge.record import Record, checked_record
from railhil.run import no_return
from railhil.run.branch import Trunk, branch, branch_straight, why_straight
from railhil.run.make import record_run
from railhil.run.no_return import NoReturn, ended_at, find_no_return
from railhil.run.spec import brought_controller
from railhil.scenarios.run_spec import LawSpec, RunSpec

pytestmark = [pytest.mark.faults, pytest.mark.slow, pytest.mark.timeout(600)]

needs_fork = pytest.mark.skipif(sys.platform != "linux", reason="MISSING CAPABILITY a fork of a run (Linux)")
#: Limits that 2 m in 4 s keep.
_WIDE = ("plan.stop_error_max_m=1", "plan.time_error_max_s=1")
#: Branches of each trunk in make test, and of each trunk and seed in make test-long.
_QUICK, _LONG = {"ato": 4, "ato_safe": 3, "stop": 2, "hst1": 2, "emu3": 1, "line": 1}, 10


@pytest.fixture
def short(tmp_path: Path) -> RunSpec:
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML)
    return RunSpec(str(path), _WIDE, LawSpec("ipfc_plus"), bus="local", seed=1)


def drawn(name: str, seed: int, count: int, folder: Path) -> Iterator[str]:
    """Branches of one trunk, with faults of its own in every second one; yields those that differ."""
    chance = random.Random(seed)
    spec = trunk_spec(name, folder)
    own = tuple(random_texts(spec.load(), chance, 1.0)[:1]) if seed % 2 else ()
    spec = replace(spec, faults=own)
    scenario = spec.load()
    forked = 0
    with Trunk(spec) as trunk:
        instants_s = sorted(round(chance.uniform(0.3, TRUNKS[name][3]), 2) for _ in range(count))
        for number, instant_s in enumerate(instants_s):
            if not goes_on_to(trunk, instant_s):
                # A fault of its own has ended the run.
                break
            faults = (*own, *random_texts(scenario, chance, instant_s + 0.01))
            try:
                replace(spec, faults=faults).load()
            except InputError:
                # Two of them on one target.
                continue
            made = trunk.branch(faults, folder / f"branch{number}", keep=False)
            forked += not trunk.straight
            if made.frames_sha256 != straight_sha256(spec, faults, folder / f"straight{number}"):
                yield f"{name}: seed {seed}: @{instant_s}s {faults}"
    assert forked or own, "every branch was a straight run"


def goes_on_to(trunk: Trunk, instant_s: float) -> bool:
    """Advance a trunk; False: its run ends before."""
    try:
        trunk.advance(instant_s)
    except InputError as error:
        if "end of the run" not in str(error):
            raise
        return False
    return True


@needs_fork
@pytest.mark.parametrize("name", TRUNKS)
def test_branches_have_the_bytes_of_the_straight_run(name: str, tmp_path: Path) -> None:
    assert list(drawn(name, 2, _QUICK[name], tmp_path)) == []


@needs_fork
@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("seed", range(100, 105))
@pytest.mark.parametrize("name", TRUNKS)
def test_many_branches_have_the_bytes_of_the_straight_run(name: str, seed: int, tmp_path: Path) -> None:
    """300 in all."""
    assert list(drawn(name, seed, _LONG, tmp_path)) == []


@needs_fork
def test_a_branch_is_a_run_of_its_own_and_says_where_it_comes_from(short: RunSpec, tmp_path: Path) -> None:
    trunk = record_run(replace(short, out=tmp_path / "trunk"))
    made = branch(trunk.place, 2.0, "TRN_SPEED loss for 100ms", out=tmp_path / "branch")
    straight = record_run(replace(short, faults=("TRN_SPEED loss @2s for 100ms",), out=tmp_path / "straight"))
    found = made.certificate
    assert found["frames_sha256"] == straight.frames_sha256 != trunk.frames_sha256
    assert found["faults"] == ["TRN_SPEED loss @2s for 100ms"]
    source = found["branched_from"]
    lines = trunk.log.read_bytes().splitlines(keepends=True)[: source["lines"]]
    assert 1.98 <= float(lines[-1][1:9]) < 2.0 == source["instant_s"]
    assert source["sha256"] == hashlib.sha256(b"".join(lines)).hexdigest()
    names = {path.name for path in straight.place.iterdir()}
    assert names == {path.name for path in (tmp_path / "branch").iterdir()}
    done = railhil("rerun", tmp_path / "branch")
    assert (done.exit_code, done.out[:10]) == (0, "same bytes")


def test_a_branch_that_cannot_be_forked_is_a_straight_run_with_the_same_bytes(short: RunSpec, tmp_path: Path) -> None:
    faults = ("TRN_SPEED replay 100ms @2s for 300ms",)
    with Trunk(short) as trunk:
        trunk.advance(1.5)
        made = trunk.branch(faults, tmp_path / "made")
    assert "depends on what was before" in trunk.straight or why_straight(short)
    straight = branch_straight(short, faults, tmp_path / "straight", 1.5, trunk.straight)
    assert made.frames_sha256 == straight.frames_sha256
    assert made.branched_from == straight.branched_from
    assert (made.branched_from or {})["straight"] == trunk.straight


def steady(reading: object) -> float:
    """A controller of one's own."""
    return 1.0


@needs_fork
def test_a_controller_of_ones_own_is_not_forked(short: RunSpec, tmp_path: Path) -> None:
    given = replace(short, law=LawSpec.of_given(brought_controller(steady)))
    with Trunk(given) as trunk:
        trunk.advance(1.0)
        made = trunk.branch(("TRN_SPEED loss @2s x1",), keep=False)
    assert trunk.straight == "the controller is one of your own"
    assert made.frames_sha256 == straight_sha256(given, ("TRN_SPEED loss @2s x1",), tmp_path / "straight")
    assert why_straight(replace(short, orders=("2s stop",))) == "the run has orders of an operator"


@needs_fork
@pytest.mark.parametrize(
    ("instant_s", "faults", "said"),
    [
        (2.0, ("TRN_SPEED loss @1s for 100ms",), "which begins at 1 s, expected a fault that begins at the instant"),
        (2.0, ("speed stuck @v>0.1m/s",), "expected a fault that begins at the instant of the branch or later"),
        (2.0, ("traction weak @departed",), "expected a fault that begins at the instant of the branch or later"),
        (99.0, (), "expected a time before the end of the run"),
    ],
)
def test_a_branch_in_the_past_is_refused(
    instant_s: float, faults: tuple[str, ...], said: str, short: RunSpec, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=said) as refused, Trunk(short) as trunk:
        make_at(trunk, instant_s, faults, tmp_path / "out")
    assert "\n" not in str(refused.value)
    assert not (tmp_path / "out").exists()


def make_at(trunk: Trunk, instant_s: float, faults: tuple[str, ...], out: Path) -> None:
    """A branch at an instant."""
    trunk.advance(instant_s)
    trunk.branch(faults, out)


@needs_fork
def test_a_branch_may_leave_out_a_fault_of_its_trunk_that_has_not_begun(short: RunSpec, tmp_path: Path) -> None:
    spec = replace(short, faults=("TRN_SPEED loss @500ms for 50ms", "speed stuck @3s"))
    faults = (spec.faults[0], "pantograph off @2500ms", "NOTCH_CMD loss @3s x2")
    with Trunk(spec) as trunk:
        trunk.advance(2.0)
        made = trunk.branch(faults, keep=False)
        assert not trunk.straight
        with pytest.raises(InputError, match="fault 1"):
            trunk.branch(faults[1:], keep=False)
    assert made.frames_sha256 == straight_sha256(short, faults, tmp_path / "straight")


@needs_fork
def test_a_fork_has_one_thread_and_python_warns_of_nothing(short: RunSpec, tmp_path: Path) -> None:
    words = "import sys; sys.path[:0] = [%r]; from hil_tests.support.branches import fork_here; fork_here(%r, %r)"
    root = str(Path(__file__).parents[2])
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", words % (root, short.scenario, str(tmp_path / "out"))],
        capture_output=True, text=True, timeout=300, check=False,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    assert (done.returncode, done.stdout.split()) == (0, ["1", "thread"]), done.stderr


@needs_fork
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL], ids=["ctrl_c", "kill_9"])
def test_nothing_is_left_of_a_trunk_whose_parent_ends(number: signal.Signals, tmp_path: Path) -> None:
    path = tmp_path / "long.toml"
    path.write_text(RUN_297M_TOML)
    program = (
        "import sys\nfrom railhil.run.branch import Trunk\nfrom railhil.scenarios.run_spec import RunSpec\n"
        "with Trunk(RunSpec(sys.argv[1])) as trunk:\n"
        "    trunk.advance(1.0)\n    print(trunk._process.pid, flush=True)\n"
        "    while True:\n        trunk.branch(['TRN_SPEED loss @2s x1'], keep=False)\n"
    )
    parent = subprocess.Popen(
        [sys.executable, "-c", program, str(path)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        text=True, cwd=tmp_path, start_new_session=True, env={**os.environ, "TMPDIR": str(tmp_path)},
    )  # fmt: skip
    with parent:
        assert parent.stdout is not None
        trunk = int(parent.stdout.readline())
        deadline_s = time.monotonic() + 60.0
        while not (branches := children_of(trunk)) and time.monotonic() < deadline_s:
            time.sleep(0.01)
        assert branches
        os.killpg(parent.pid, number) if number == signal.SIGINT else parent.kill()
        parent.wait(60)
    deadline_s = time.monotonic() + 20.0
    while (left := [pid for pid in (trunk, *branches) if is_running(pid)]) and time.monotonic() < deadline_s:
        time.sleep(0.05)
    assert left == []


def children_of(pid: int) -> list[int]:
    """The processes that a process has started."""
    try:
        return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except FileNotFoundError:
        return []


def is_running(pid: int) -> bool:
    """Whether a process is there and not only waited for."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@needs_fork
def test_a_trunk_leaves_no_open_file_and_no_folder(
    short: RunSpec, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "private").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "private"))
    before = sorted(os.listdir("/proc/self/fd"))
    with Trunk(short) as trunk:
        trunk.advance(1.0)
        assert trunk._process is not None
        opened = [
            os.readlink(f"/proc/{trunk._process.pid}/fd/{name}")
            for name in os.listdir(f"/proc/{trunk._process.pid}/fd")
        ]
        assert not [name for name in opened if name.startswith(str(tmp_path)) and not name.endswith("(deleted)")]
        trunk.branch(("TRN_SPEED loss @2s x1",), tmp_path / "out")
    assert sorted(os.listdir("/proc/self/fd")) == before
    assert list((tmp_path / "private").iterdir()) == []


@needs_fork
def test_a_branch_with_other_noise_is_the_run_that_has_it_from_there(short: RunSpec, tmp_path: Path) -> None:
    found = set()
    with Trunk(short) as trunk:
        for from_s in (0.5, 2.0):
            trunk.advance(from_s)
            for seed in (8, 9):
                setting = f"noise_from=[{from_s}, {seed}]"
                made = trunk.branch((), keep=False, settings=(setting,))
                assert not trunk.straight
                straight = record_run(
                    replace(short, settings=(*short.settings, setting), out=tmp_path / f"{len(found)}")
                )
                assert made.frames_sha256 == straight.frames_sha256
                found.add(made.frames_sha256)
    assert len(found) == 4


@needs_fork
def test_the_point_of_no_return_is_between_two_ticks(short: RunSpec, tmp_path: Path) -> None:
    spec = replace(short, faults=("brake off @2s",))
    run = record_run(replace(spec, out=tmp_path / "run"))
    assert run.verdict == "FAIL"
    record = checked_record(str(run.place), None)
    found = find_no_return(record)
    assert found.saved_s is not None
    assert round(found.lost_s - found.saved_s, 6) == 0.01
    for time_s, verdict in ((found.saved_s, "PASS"), (found.lost_s, "FAIL")):
        faults = ("brake off @2s", f"brake ok @{time_s:g}s")
        assert record_run(replace(spec, faults=faults), keep=False).score.verdict == verdict
    done = railhil("branch", run.place, "--no-return", "--json")
    assert done.exit_code == 0
    assert json.loads(done.out)["saved_s"] == found.saved_s


@pytest.mark.slow
def test_verdict_and_report_of_a_run_tell_its_point_of_no_return(short: RunSpec, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text('[[requirement]]\nid = "A-1"\nsays = "always true_speed <= 1 km/h"\n')
    place = tmp_path / "run"
    words = ("--requirements", tmp_path / "mine.toml", "--fault", "TRN_SPEED loss @1s for 10ms", "--out", place)
    done = railhil("run", *short.words, *words, "--no-return")
    assert done.exit_code == 1
    verdict = next(line for line in done.out.splitlines() if line.startswith("FAIL: requirement A-1"))
    said = "ending the faults does not save the run: without them it fails, too (1 branch)"
    assert verdict.endswith(f"; {said}")
    assert said in (place / "report.html").read_text()
    # Without the option it is not looked for.
    assert railhil("report", place).exit_code == 0
    assert said not in (place / "report.html").read_text()
    assert railhil("report", place, "--no-return").exit_code == 0
    assert said in (place / "report.html").read_text()


def test_a_run_that_cannot_be_repeated_says_why_it_has_no_point_of_no_return(
    short: RunSpec, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(record: Record) -> NoReturn:
        raise InputError(record.folder, "pace", "realtime", "lockstep")

    monkeypatch.setattr(no_return, "find_no_return", refuse)
    run = record_run(replace(short, faults=("brake off @2s",), out=tmp_path / "run"))
    said = no_return.no_return_sentence(checked_record(str(run.place), None))
    assert said.startswith("the point of no return is not known: ")
    assert "found 'realtime', allowed lockstep" in said


def test_a_run_that_its_faults_have_not_lost_is_told_none(short: RunSpec, tmp_path: Path) -> None:
    done = railhil("run", *short.words, "--out", tmp_path / "run", "--no-return", "--no-report")
    assert (done.exit_code, "ending" in done.out) == (0, False)


def test_a_run_that_passes_has_no_point_of_no_return(short: RunSpec, tmp_path: Path) -> None:
    run = record_run(replace(short, out=tmp_path / "run"))
    assert run.verdict == "PASS"
    assert not no_return.no_return_sentence(checked_record(str(run.place), None))
    done = railhil("branch", run.place, "--no-return")
    assert (done.exit_code, "found 'PASS', allowed FAIL" in done.err) == (2, True)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--fault", "TRN_SPEED loss"), "@TIME"),
        (("@2s",), "--fault"),
        (("soon", "--fault", "TRN_SPEED loss"), "@150s"),
        (("@2s", "--fault", "TRN_SPEED lose"), "lose"),
        (("@2s", "--no-return"), "--no-return"),
    ],
)
def test_bad_words_are_one_line(words: tuple[str, ...], said: str, short: RunSpec, tmp_path: Path) -> None:
    run = record_run(replace(short, out=tmp_path / "run"))
    done = railhil("branch", run.place, *words)
    assert (done.exit_code, done.err.count("\n")) == (2, 1)
    assert said in done.err


def test_faults_end_at_an_instant_and_later_ones_never_begin() -> None:
    from railhil.run.no_return import _Acting

    acting = [
        _Acting("TRN_SPEED loss @1s expect TRACTION CUT", 1.0, None),
        _Acting("speed stuck @2s for 500ms", 2.0, 2.5),
        _Acting("brake off @4s", 4.0, None),
    ]
    assert ended_at(acting, 3.0) == (
        "TRN_SPEED loss @1s",
        "speed stuck @2s for 500ms",
        "brake off @manual",
        "TRN_SPEED ok @3s",
    )
