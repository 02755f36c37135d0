"""Campaigns whose processes are killed: no run is lost and none is repeated, and the results have the same bytes."""

from __future__ import annotations

import io
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import psutil
import pytest
from rich.console import Console

from hil_tests.support.cli import TIMEOUT_S, Done, railhil, wait_for
from hil_tests.support.dask_cluster import loopback_cluster
from railhil.campaign.plan import Plan, Request, make_plan
from railhil.campaign.study import CAMPAIGN
from railhil.common.errors import InputError
from railhil.study import engines
from railhil.study.execute import execute
from railhil.study.manifest import read_manifest
from railhil.study.parts import opened
from railhil.study.work import OtherCode, run_task, task_of

pytestmark = [pytest.mark.loop, pytest.mark.slow]

T = TypeVar("T")
R = TypeVar("R")
#: Enough chunks that something can happen between two of them.
RUNS = 60
FIRST_SEED = 7


@pytest.fixture(scope="module")
def wanted(short, tmp_path_factory):
    """Bytes of the results of an undisturbed campaign."""
    folder = tmp_path_factory.mktemp("campaign") / "finished"
    made(make_plan(Request(scenario=str(short), runs=RUNS, first_seed=FIRST_SEED)), folder)
    return (folder / "results.parquet").read_bytes()


def made(
    plan: Plan,
    folder: Path,
    engine: str = "batch",
    scheduler: str | None = None,
    after_a_part: Callable[[int], None] = lambda count: None,
) -> list[str]:
    """Bring a campaign to its end in this process; what it has said.

    :param after_a_part: is called with the number of the parts so far.
    """
    said: list[str] = []
    with engines.running(engine, said.append, 2, scheduler) as start:

        @contextmanager
        def watched(work: Callable[[T], R], items: Sequence[T], /) -> Iterator[Iterator[tuple[int, R]]]:
            def results() -> Iterator[tuple[int, R]]:
                for count, result in enumerate(made, 1):
                    yield result
                    after_a_part(count)

            with start(work, items) as made:
                yield results()

        execute(CAMPAIGN, plan, str(folder), Console(file=io.StringIO()), watched, said.append)
    return said


def workers_of(process: int) -> list[psutil.Process]:
    """The worker processes that have not ended."""
    children = psutil.Process(process).children()
    living = [child for child in children if child.status() != psutil.STATUS_ZOMBIE]
    return [child for child in living if "resource_tracker" not in " ".join(child.cmdline())]


def in_parts_of_one(short: Path) -> Plan:
    return make_plan(Request(scenario=str(short), runs=RUNS, first_seed=FIRST_SEED, chunk=1))


class Campaign:
    """A campaign in a process of its own, one run in a part."""

    def __init__(self, short: Path, folder: Path, *engine: str) -> None:
        self.folder = folder
        words = ["campaign", short, "--runs", RUNS, "--seed", FIRST_SEED, "--chunk", 1, "--out", folder, *engine]
        # A group of its own, as a terminal gives it: Ctrl-C reaches the workers too.
        self.process = subprocess.Popen(
            [sys.executable, "-m", "railhil.cli", *map(str, words)],
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
        return workers_of(self.process.pid)

    def finish(self) -> Done:
        out, err = self.process.communicate(timeout=TIMEOUT_S)
        return Done(self.process.returncode, out, err)


def begun(campaign: Campaign) -> Plan:
    """The plan of a campaign as its folder has it."""
    return make_plan(read_manifest(campaign.folder, CAMPAIGN).request)


def resumed(campaign: Campaign, kept: dict[str, int], wanted: bytes) -> None:
    """Go on, and see that what was there was not made again."""
    said = made(begun(campaign), campaign.folder)
    assert said[:1] == [f"{campaign.folder}: {len(kept)} of {RUNS} runs are there already"]
    parts = campaign.parts()
    assert len(parts) == RUNS
    assert {name: parts[name] for name in kept} == kept
    assert (campaign.folder / "results.parquet").read_bytes() == wanted


def test_a_killed_campaign_goes_on(short, tmp_path, wanted):
    campaign = Campaign(short, tmp_path / "mine", "--engine", "processes", "--jobs", "2")
    campaign.wait_for_parts(4)
    with campaign.held():
        # Somebody else at the same time is refused.
        with (
            pytest.raises(InputError, match="is in use by a campaign"),
            opened(CAMPAIGN, begun(campaign), str(campaign.folder)),
        ):
            pass
        workers = campaign.workers()
        assert len(workers) == 2
        campaign.process.kill()
    campaign.finish()
    # Workers do not outlive it.
    wait_for(lambda: not any(worker.is_running() for worker in workers))
    kept = campaign.parts()
    assert 4 <= len(kept) < RUNS
    assert not (campaign.folder / "results.parquet").exists()
    resumed(campaign, kept, wanted)


@pytest.mark.long
@pytest.mark.parametrize(
    ("number", "exit_code", "engine"),
    [(signal.SIGINT, 130, ("--engine", "processes", "--jobs", "2")), (signal.SIGTERM, 143, ())],
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


@pytest.mark.long
def test_a_killed_worker_loses_nothing(short, tmp_path, wanted):
    kept: dict[Path, int] = {}

    def kill(count: int) -> None:
        if count == 4:
            kept.update({path: path.stat().st_mtime_ns for path in tmp_path.glob("mine/parts/*.parquet")})
            workers_of(os.getpid())[0].kill()

    said, spent = made(in_parts_of_one(short), tmp_path / "mine", "processes", after_a_part=kill)
    assert said.startswith("a worker process died: what it had is run again, ")
    assert " of processor time " in spent
    assert len(kept) == 4
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    assert (tmp_path / "mine" / "results.parquet").read_bytes() == wanted


def die(item: object) -> None:
    """Kill the worker that works on it."""
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.long
def test_a_chunk_that_kills_every_worker_ends_the_campaign():
    said: list[str] = []
    with (
        pytest.raises(engines.WorkersLost, match="died 3 times in a row") as caught,
        engines.processes(2, said.append)(die, range(4)) as results,
    ):
        list(results)
    assert caught.value.exit_code == 3
    assert len(said) == 2


def test_a_worker_with_other_code_is_refused():
    plan = make_plan(Request(runs=1))
    (task,) = [task_of(CAMPAIGN, plan, chunk) for chunk in plan.chunks()]
    with pytest.raises(OtherCode, match="has other code than this study"):
        run_task(replace(task, code=("0", *task.code[1:])))


# -- dask -------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def cluster():
    with loopback_cluster(2) as cluster:
        assert cluster.scheduler_address.startswith("tcp://127.0.0.1:")
        yield cluster


@pytest.mark.long
def test_dask_goes_on_after_a_killed_worker(cluster, short, tmp_path, wanted):
    def kill(count: int) -> None:
        if count == 4:
            psutil.Process(next(iter(cluster.workers.values())).pid).kill()

    made(in_parts_of_one(short), tmp_path / "mine", "dask", cluster.scheduler_address, kill)
    assert len(list(tmp_path.glob("mine/parts/*.parquet"))) == RUNS
    assert (tmp_path / "mine" / "results.parquet").read_bytes() == wanted


@pytest.mark.long
def test_dask_that_gives_up_a_chunk_says_so(cluster):
    # Every process that collects the tests would load dask.
    from railhil.study.dask_engine import ClusterLost

    with (
        engines.running("dask", print, scheduler=cluster.scheduler_address) as engine,
        pytest.raises(ClusterLost, match="its workers died 4 times"),
        # By value: the workers of dask do not know this module.
        engine(lambda item: os.kill(os.getpid(), signal.SIGKILL), [None]) as results,
    ):
        list(results)


def test_nobody_at_the_address_is_one_line():
    from railhil.study.dask_engine import connected

    with (
        pytest.raises(InputError, match=r"--scheduler: found 'tcp://127.0.0.1:9', allowed tcp://HOST:PORT of a "),
        connected("tcp://127.0.0.1:9", print, connect_s=0.5),
    ):
        pass


@pytest.mark.long_after(1)
@pytest.mark.parametrize("address", ["nowhere", "tls://127.0.0.1:9"])
def test_an_address_that_cannot_be_used_leaves_one_line_behind(tmp_path, address):
    """In a process of its own: what dask has left half made complains when the process ends."""
    done = railhil("campaign", "--engine", "dask", "--scheduler", address, cwd=tmp_path)
    assert (done.exit_code, done.out) == (2, "")
    assert len(done.err.splitlines()) == 1
    assert f"--scheduler: found '{address}', allowed tcp://HOST:PORT of a running dask scheduler" in done.err
    assert not list(tmp_path.iterdir())


@pytest.mark.long
def test_a_lost_scheduler_ends_the_campaign_and_it_goes_on(cluster, short, tmp_path, wanted):
    """Comes last: the cluster is gone afterwards."""
    campaign = Campaign(short, tmp_path / "mine", "--engine", "dask", "--scheduler", cluster.scheduler_address)
    campaign.wait_for_parts(2)
    with campaign.held():
        cluster.close()
    done = campaign.finish()
    assert done.exit_code == 3
    kept = campaign.parts()
    assert f"is lost; {len(kept)} of {RUNS} runs are kept; railhil campaign --resume " in done.err.splitlines()[-1]
    assert "Traceback" not in done.err
    resumed(campaign, kept, wanted)
