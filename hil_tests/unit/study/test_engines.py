"""Engines: the same results in one process and in several, which end in any case with the process that started them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import psutil
import pytest

from hil_tests.support.cli import wait_for
from railhil.common.errors import InputError
from railhil.study.engines import ENGINES, in_order, processes, processors, running

ITEMS = range(20)


def square(item: int) -> int:
    return item * item


def square_late(item: int) -> int:
    """The first items take longest."""
    time.sleep(0.05 if item < 2 else 0)
    return item * item


def refuse(item: int) -> int:
    raise InputError("file.toml", "key", item, "an even number")


def refuse_zero(item: int) -> None:
    """A worker with another item works on."""
    time.sleep(item)
    raise InputError("file.toml", "key", item, "more")


def die_once(marker: Path) -> int:
    """The first process that begins it dies."""
    try:
        marker.touch(exist_ok=False)
    except FileExistsError:
        return os.getpid()
    os.kill(os.getpid(), signal.SIGKILL)
    return 0


@pytest.mark.parametrize("name", [name for name in ENGINES if name != "dask"])
@pytest.mark.parametrize("jobs", [1, 2])
def test_every_engine_gives_each_item_its_result(name: str, jobs: int) -> None:
    with running(name, print, jobs) as engine, engine(square_late, ITEMS) as results:
        assert dict(results) == {item: item * item for item in ITEMS}


def test_results_come_in_the_order_of_the_items_if_that_is_wanted() -> None:
    with processes(2, print)(square_late, ITEMS) as results:
        assert list(in_order(results)) == [item * item for item in ITEMS]


@pytest.mark.parametrize(
    ("limit", "wanted"),
    [
        ("max 100000\n", None),
        ("100000 100000\n", 1),
        ("50000 100000\n", 1),
        ("100001 100000\n", 2 if len(os.sched_getaffinity(0)) > 1 else 1),
        ("9900000 100000\n", None),
    ],
)
def test_a_container_has_as_many_processors_as_its_quota(limit: str, wanted: int | None, tmp_path: Path) -> None:
    (tmp_path / "cpu.max").write_text(limit)
    all_of_them = len(os.sched_getaffinity(0))
    assert processors(tmp_path / "cpu.max") == (wanted or min(99, all_of_them))
    assert processors(tmp_path / "absent") == all_of_them


@pytest.mark.parametrize("jobs", [1, 2])
def test_bad_input_found_by_a_worker_is_that_of_the_command(jobs: int) -> None:
    with (
        pytest.raises(InputError, match=r"file\.toml: key: found 0, allowed an even number"),
        processes(jobs, print)(refuse, [0, 0]) as results,
    ):
        list(results)


def test_what_a_dead_worker_had_is_done_by_another(tmp_path: Path) -> None:
    said: list[str] = []
    with processes(2, said.append)(die_once, [tmp_path / "first", tmp_path / "second"]) as results:
        assert sorted(place for place, _ in results) == [0, 1]
    assert 1 <= len(said) <= 2
    assert said[0].startswith("a worker process died: what it had is run again, ")


def test_a_single_item_that_ends_its_process_does_not_end_the_command(tmp_path: Path) -> None:
    with processes(2, lambda sentence: None)(die_once, [tmp_path / "first"]) as results:
        ((_, worker),) = results
    assert worker != os.getpid()


def test_the_other_workers_of_a_dead_one_make_room_for_new_ones() -> None:
    """They do not end by themselves: they hold signals back."""
    before = set(psutil.Process().children())
    for _ in range(5):
        with processes(2, lambda sentence: None)(square, ITEMS) as results:
            found = [next(results)]
            worker = (set(psutil.Process().children()) - before).pop()
            worker.kill()
            found += results
        assert sorted(found) == [(item, item * item) for item in ITEMS]


def test_workers_beside_threads_are_no_forks_of_their_locks() -> None:
    lock = threading.Lock()
    hold = threading.Event()

    def held() -> None:
        with lock:
            hold.wait()

    thread = threading.Thread(target=held)
    thread.start()
    try:
        with processes(2, print)(square, ITEMS) as results:
            assert len(list(results)) == len(ITEMS)
            others = [one for one in psutil.Process().children() if one.status() != psutil.STATUS_ZOMBIE]
            commands = [" ".join(one.cmdline()) for one in others]
        assert sum("multiprocessing.spawn" in command for command in commands) == 2
    finally:
        hold.set()
        thread.join()


def test_an_exception_ends_the_workers_at_once() -> None:
    before = set(psutil.Process().children())
    began_s = time.monotonic()
    with (
        pytest.raises(InputError),
        processes(2, print)(refuse_zero, [60, 0]) as results,
    ):
        list(results)
    assert time.monotonic() - began_s < 30
    workers = set(psutil.Process().children()) - before
    assert [worker for worker in workers if "resource_tracker" not in " ".join(worker.cmdline())] == []


_LONG = """
import time
from railhil.study.engines import processes

if __name__ == "__main__":
    with processes(2, print)(time.sleep, [60.0] * 4) as results:
        print("begun", flush=True)
        list(results)
"""


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_workers_end_with_a_killed_parent(number: signal.Signals, tmp_path: Path) -> None:
    (tmp_path / "long.py").write_text(_LONG)
    parent = subprocess.Popen([sys.executable, str(tmp_path / "long.py")], stdout=subprocess.PIPE)
    assert parent.stdout is not None
    assert parent.stdout.readline() == b"begun\n"
    workers = psutil.Process(parent.pid).children()
    assert len(workers) == 2
    parent.send_signal(number)
    parent.communicate(timeout=30)
    wait_for(lambda: not any(worker.is_running() for worker in workers))
