"""Campaigns whose processes are killed: no run is lost and none is repeated, and the results have the same bytes."""

from __future__ import annotations

import io
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest
from rich.console import Console

from benchmarks.figures import QUICK_TOML
from hil_tests.campaign import dask_engine, engines
from hil_tests.campaign.folder import opened, request_of
from hil_tests.campaign.plan import Request, make_plan
from hil_tests.campaign.run import execute
from hil_tests.campaign.work import OtherCode, task_of
from hil_tests.cli import TIMEOUT_S, Done, railhil, wait_for
from hil_tests.dask_cluster import loopback_cluster
from scenarios.errors import InputError

pytestmark = pytest.mark.loop

#: Enough chunks that something can happen between two of them.
RUNS = 60
SAME = ("--runs", str(RUNS), "--first-seed", "7")


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(QUICK_TOML)
    return path


@pytest.fixture(scope="module")
def wanted(short, tmp_path_factory):
    """Bytes of the results of an undisturbed campaign."""
    folder = tmp_path_factory.mktemp("campaign") / "finished"
    done = railhil("campaign", short, *SAME, "--out", folder)
    assert done.exit_code == 0, done.err
    return (folder / "results.parquet").read_bytes()


class Campaign:
    """A campaign in a process of its own, one run in a part."""

    def __init__(self, short: Path, folder: Path, *engine: str) -> None:
        self.folder = folder
        words = ["campaign", short, *SAME, "--chunk", "1", "--out", folder, *engine]
        # A group of its own, as a terminal gives it: Ctrl-C reaches the workers too.
        self.process = subprocess.Popen(
            [sys.executable, "-m", "supervisor.cli", *map(str, words)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def parts(self) -> dict[str, int]:
        """Names of the parts and when each was made, ns."""
        return {path.name: path.stat().st_mtime_ns for path in self.folder.glob("parts/ipfc-*.parquet")}

    def wait_for_parts(self, count: int) -> None:
        wait_for(lambda: len(self.parts()) >= count or self.process.poll() is not None, TIMEOUT_S)
        assert self.process.poll() is None, self.process.stderr.read()

    @contextmanager
    def held(self) -> Iterator[None]:
        """It stands still while something is done to it: it cannot be done too soon."""
        self.process.send_signal(signal.SIGSTOP)
        try:
            yield
        finally:
            self.process.send_signal(signal.SIGCONT)

    def workers(self) -> list[psutil.Process]:
        """Worker processes of joblib."""
        return [child for child in psutil.Process(self.process.pid).children() if "--process-name" in child.cmdline()]

    def finish(self) -> Done:
        out, err = self.process.communicate(timeout=TIMEOUT_S)
        return Done(self.process.returncode, out, err)


def resumed(campaign: Campaign, kept: dict[str, int], wanted: bytes) -> None:
    """Go on, and see that what was there was not made again."""
    said: list[str] = []
    plan = make_plan(request_of(campaign.folder))
    with engines.running("batch", 1, None, said.append) as engine:
        execute(plan, str(campaign.folder), Console(file=io.StringIO()), engine, said.append)
    assert said == [f"{campaign.folder}: {len(kept)} of {RUNS} runs are there already"]
    parts = campaign.parts()
    assert len(parts) == RUNS
    assert {name: parts[name] for name in kept} == kept
    assert (campaign.folder / "results.parquet").read_bytes() == wanted


@pytest.mark.parametrize("engine", [(), ("--engine", "joblib", "--jobs", "2")], ids=["batch", "joblib"])
def test_a_killed_campaign_goes_on(short, tmp_path, wanted, engine):
    campaign = Campaign(short, tmp_path / "mine", *engine)
    campaign.wait_for_parts(4)
    with campaign.held():
        # Somebody else at the same time is refused.
        with (
            pytest.raises(InputError, match="found a campaign that is running there, allowed one process at a time"),
            opened(str(campaign.folder), make_plan(request_of(campaign.folder))),
        ):
            pass
        workers = campaign.workers()
        assert len(workers) == (2 if engine else 0)
        campaign.process.kill()
    campaign.finish()
    # Workers do not outlive it.
    wait_for(lambda: not any(worker.is_running() for worker in workers))
    kept = campaign.parts()
    assert 4 <= len(kept) < RUNS
    assert not (campaign.folder / "results.parquet").exists()
    resumed(campaign, kept, wanted)


@pytest.mark.parametrize(
    ("number", "exit_code", "engine"),
    [(signal.SIGINT, 130, ("--engine", "joblib", "--jobs", "2")), (signal.SIGTERM, 143, ())],
)
def test_a_stopped_campaign_says_how_it_goes_on(short, tmp_path, wanted, number, exit_code, engine):
    campaign = Campaign(short, tmp_path / "mine", *engine)
    campaign.wait_for_parts(2)
    workers = campaign.workers()
    # Ctrl-C reaches the whole group.
    (os.killpg if number is signal.SIGINT else os.kill)(campaign.process.pid, number)
    done = campaign.finish()
    assert (done.exit_code, done.out) == (exit_code, "")
    kept = campaign.parts()
    assert done.err.strip() == (
        f"railhil campaign: stopped; {len(kept)} of {RUNS} runs are kept; "
        f"railhil campaign --resume {campaign.folder} goes on"
    )
    wait_for(lambda: not any(worker.is_running() for worker in workers))
    resumed(campaign, kept, wanted)


def test_a_killed_worker_loses_nothing(short, tmp_path, wanted):
    campaign = Campaign(short, tmp_path / "mine", "--engine", "joblib", "--jobs", "2")
    campaign.wait_for_parts(4)
    with campaign.held():
        kept = campaign.parts()
        campaign.workers()[0].kill()
    done = campaign.finish()
    assert done.exit_code == 0, done.err
    assert "a worker process died: what it had is run again, " in done.one_line()
    parts = campaign.parts()
    assert {name: parts[name] for name in kept} == kept
    assert (campaign.folder / "results.parquet").read_bytes() == wanted


def deadly() -> Callable[[object], None]:
    """What kills the worker that works on it; a function of its own travels by value, without this module."""
    return lambda task: os.kill(os.getpid(), signal.SIGKILL)


def test_a_chunk_that_kills_every_worker_ends_the_campaign(monkeypatch):
    said: list[str] = []
    monkeypatch.setattr(engines, "run_task", deadly())
    with (
        engines.running("joblib", 2, None, said.append) as engine,
        pytest.raises(engines.WorkersLost, match="died 3 times in a row") as caught,
    ):
        list(engine([SimpleNamespace(chunk=SimpleNamespace(name=f"ipfc-{i}")) for i in range(4)]))
    assert caught.value.exit_code == 3
    assert len(said) == engines.LOSSES_MAX - 1


def test_a_worker_with_other_code_is_refused():
    plan = make_plan(Request(runs=1))
    (task,) = [task_of(plan, chunk) for chunk in plan.chunks()]
    with (
        engines.running("batch", 1, None, print) as engine,
        pytest.raises(OtherCode, match="has other code than this campaign"),
    ):
        list(engine([type(task)(**{name: getattr(task, name) for name in task.__slots__} | {"code_sha256": "0"})]))


# -- dask -------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def cluster():
    with loopback_cluster(2) as cluster:
        assert cluster.scheduler_address.startswith("tcp://127.0.0.1:")
        yield cluster


def test_dask_goes_on_after_a_killed_worker(cluster, short, tmp_path, wanted):
    campaign = Campaign(short, tmp_path / "mine", "--engine", "dask", "--scheduler", cluster.scheduler_address)
    campaign.wait_for_parts(4)
    with campaign.held():
        psutil.Process(next(iter(cluster.workers.values())).pid).kill()
    done = campaign.finish()
    assert done.exit_code == 0, done.err
    assert len(campaign.parts()) == RUNS
    assert (campaign.folder / "results.parquet").read_bytes() == wanted


def test_dask_that_gives_up_a_chunk_says_so(cluster, monkeypatch):
    monkeypatch.setattr(dask_engine, "run_task", deadly())
    with (
        engines.running("dask", 1, cluster.scheduler_address, print) as engine,
        pytest.raises(dask_engine.ClusterLost, match="its workers died 4 times"),
    ):
        list(engine([SimpleNamespace()]))


def test_nobody_at_the_address_is_one_line(monkeypatch):
    monkeypatch.setattr(dask_engine, "_CONNECT_S", 0.5)
    with (
        pytest.raises(InputError, match=r"--scheduler: found 'tcp://127.0.0.1:9', allowed tcp://HOST:PORT of a "),
        engines.running("dask", 1, "tcp://127.0.0.1:9", print),
    ):
        pass


def test_a_lost_scheduler_ends_the_campaign_and_it_goes_on(short, tmp_path, wanted):
    with loopback_cluster(1) as cluster:
        campaign = Campaign(short, tmp_path / "mine", "--engine", "dask", "--scheduler", cluster.scheduler_address)
        campaign.wait_for_parts(2)
        # Until the scheduler is gone.
        campaign.process.send_signal(signal.SIGSTOP)
    campaign.process.send_signal(signal.SIGCONT)
    done = campaign.finish()
    assert done.exit_code == 3
    kept = campaign.parts()
    assert f"is lost; {len(kept)} of {RUNS} runs are kept; railhil campaign --resume " in done.err.splitlines()[-1]
    assert "Traceback" not in done.err
    resumed(campaign, kept, wanted)
