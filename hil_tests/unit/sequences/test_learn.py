"""``railhil learn``: equal to the bench run by run, whatever the processes, and after any interruption."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.dask_cluster import loopback_cluster
from hil_tests.support.remembering import Learning
from railhil.common.errors import InputError
from railhil.common.exit_codes import PASS
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.sequences.__main__ import COMMAND
from railhil.sequences.one import runner_of, sequence, sequence_batch_of, sequences
from railhil.sequences.plan import Request, make_plan, run_specs

pytestmark = pytest.mark.slow


_RUNS, _SEQUENCES = 4, 3


def learn(short: Path, out: Path, *words: str, jobs: int = 1) -> int:
    given = ("--runs", str(_RUNS), "--sequences", str(_SEQUENCES), "--chunk", "1", "--seed", "7", "--jobs", str(jobs))
    report = () if jobs == 1 and out.name == "one" else ("--no-report",)
    return COMMAND.main([str(short), "--controller", "learning", *given, "--out", str(out), *report, *words])


def rows(folder: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = pq.read_table(folder / "results.parquet").to_pylist()
    return found


@pytest.mark.long
def test_sequences_are_those_of_the_bench(short: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert learn(short, tmp_path / "one") == PASS
    said = capsys.readouterr().out
    assert f"{_SEQUENCES} sequences of {_RUNS} perturbed runs of benchmark_quick, learning, float64" in said
    assert "stop error, m, by the number of the run" in said
    found = rows(tmp_path / "one")
    assert [(one["sequence"], one["run"], one["seed"]) for one in found[:5]] == [
        (7, 1, 7), (7, 2, 8), (7, 3, 9), (7, 4, 10), (11, 1, 11),
    ]  # fmt: skip
    assert [one["memory_used"] for one in found[:4]] == ["", "A", "B", "A"]
    assert [json.loads(one["memory"])["runs"] for one in found] == [1, 2, 3, 4] * _SEQUENCES
    assert found[0]["memory_before_sha256"] == found[4]["memory_before_sha256"], "every sequence begins with nothing"
    assert len({one["memory_after_sha256"] for one in found[:4]}) == 4
    assert COMMAND.main(["--verify", str(tmp_path / "one"), "--sequences", "2"]) == PASS
    assert "8 of 8 runs are the same on the bench" in capsys.readouterr().out
    page = (tmp_path / "one" / "report.html").read_text()
    assert f"report {tmp_path / 'one' / 'report.html'}" in said
    recorded = json.loads((tmp_path / "one" / "learn.json").read_text())["recorded"]
    assert f"UTC on {recorded['host']} by {recorded['operator']} with railhil " in page
    for text in ("Learning: stop error", "Distribution: stop error", "What the law keeps", "Two runs of the first seq"):
        assert text in page
    # A single file that opens offline, the same for the same results.
    assert not re.search(r"(?:src|href)=.https?:|url\(https?:|@import", page)
    assert str(tmp_path) not in page
    out = tmp_path / "again.html"
    assert railhil("report", tmp_path / "one", "--out", out).exit_code == PASS
    assert out.read_text() == page
    (tmp_path / "one" / "report.html").unlink()
    assert COMMAND.main(["--resume", str(tmp_path / "one"), "--jobs", "1"]) == PASS
    assert (tmp_path / "one" / "report.html").read_text() == page


@pytest.mark.long
def test_processes_and_machines_make_no_difference(short: Path, tmp_path: Path) -> None:
    for jobs in (1, 2):
        assert learn(short, tmp_path / str(jobs), jobs=jobs) == PASS
    with loopback_cluster(1) as cluster:
        words = ["--runs", str(_RUNS), "--sequences", str(_SEQUENCES), "--chunk", "1", "--seed", "7", "--no-report"]
        words += ["--scheduler", cluster.scheduler_address, "--out", str(tmp_path / "dask")]
        assert COMMAND.main([str(short), "--controller", "learning", *words]) == PASS
    for name in ("results.parquet", "summary.json"):
        one, two, dask = ((tmp_path / folder / name).read_bytes() for folder in ("1", "2", "dask"))
        assert one == two == dask


def test_after_a_kill_it_goes_on_with_the_same_bytes(short: Path, tmp_path: Path) -> None:
    whole, torn = tmp_path / "whole", tmp_path / "torn"
    assert learn(short, whole) == PASS
    words = [str(short), "--controller", "learning", "--runs", str(_RUNS), "--sequences", str(_SEQUENCES)]
    words += ["--chunk", "1", "--seed", "7", "--jobs", "1", "--out", str(torn)]
    process = subprocess.Popen([sys.executable, "-P", "-m", "railhil.sequences", *words], stderr=subprocess.PIPE)
    while process.poll() is None and not [*torn.glob("parts/*.parquet")]:
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    # Half a part, as a disk may leave it, is made again.
    kept = sorted(torn.glob("parts/*.parquet"))
    assert kept
    kept[0].write_bytes(kept[0].read_bytes()[:100])
    assert COMMAND.main(["--resume", str(torn), "--jobs", "1"]) == PASS
    for name in ("results.parquet", "summary.json"):
        assert (torn / name).read_bytes() == (whole / name).read_bytes()


def test_other_work_is_not_mixed_in(short: Path, tmp_path: Path) -> None:
    assert learn(short, tmp_path / "out", "--sequences", "1", "--runs", "1") == PASS
    with pytest.raises(
        InputError, match=r"study\.runs: found 1, allowed 2 to go on with it; another --out begins a new study"
    ):
        learn(short, tmp_path / "out", "--sequences", "1", "--runs", "2")


def test_seeds_that_the_law_was_made_on_are_refused(short: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Learning, "design_seeds", {"benchmark_quick": range(9, 12)})
    words = [str(short), "--controller", "learning", "--seed", "7", "--runs", "2", "--sequences"]
    with pytest.raises(InputError, match=r"--seed: seed 9, on which learning's own.* expected another --seed"):
        COMMAND.main([*words, "2"])
    make_plan(Request(str(short), controller="learning", seed=7, runs=2, sequences=1))
    make_plan(Request(str(short), controller="learning", seed=7, runs=2, sequences=2, nominal=True))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--controller", "ipfc"), "--controller: found 'ipfc', allowed a law that keeps a memory from run to run"),
        (("--controller", "nobody"), "--controller: found 'nobody'"),
        (("--seed", "4294967295"), "--seed: last seed"),
        (
            ("--jobs", "2", "--scheduler", "tcp://127.0.0.1:1"),
            "--scheduler: cannot be given with --jobs",
        ),
        (("--verify", "x", "--runs", "2"), "--verify: cannot be given with --runs, only with --sequences and --draw"),
        (("--resume", "nowhere"), r"learn\.json: does not exist, expected a file of railhil learn"),
    ],
)
def test_bad_input_is_one_line(words: tuple[str, ...], line: str, short: Path) -> None:
    scenario = [] if "--resume" in words or "--verify" in words else [str(short)]
    law = [] if "--controller" in words or not scenario else ["--controller", "learning"]
    with pytest.raises(InputError, match=line) as refused:
        COMMAND.main([*scenario, *law, *words])
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.long
def test_runs_made_together_are_those_made_one_by_one() -> None:
    """System ``stop`` makes the same run of all sequences at once."""
    scenario = load_any("yizhuang_stop")
    base = RunSpec("yizhuang_stop", law=LawSpec("ilc_stop", "float64"), perturbed=True, bus="local")
    wanted = [run_specs(base, scenario, seed, 2) for seed in (3, 4)]
    assert sequence_batch_of(scenario) is not None
    found = {(place, number): run for place, number, run in sequences(scenario, wanted)}
    assert [*found] == [(0, 1), (1, 1), (0, 2), (1, 2)]
    for place, specs in enumerate(wanted):
        for number, run in enumerate(sequence(scenario, specs, runner_of(scenario)), 1):
            other = found[place, number]
            assert (other.score, other.digest, other.record, other.left) == (
                run.score,
                run.digest,
                run.record,
                run.left,
            )
