"""Engines: a function and items in, results out in any order: in this process, in several, or over machines (dask)."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from math import ceil
from pathlib import Path
from typing import Protocol, TypeVar

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import INVALID, ending_signals, ignore_ending_signals
from railhil.common.extras import need
from railhil.common.python_process import can_fork, end_with_parent, kill_this_process

T = TypeVar("T")
R = TypeVar("R")
#: Called with one sentence that the user should see at once.
Say = Callable[[str], None]
#: Number of successive worker losses, without a result in between, after which an engine gives up.
LOSSES_MAX = 3
#: cgroups(7): cpu.max of the control group in which a container sees itself.
_CONTAINER_LIMIT = Path("/sys/fs/cgroup/cpu.max")
#: Items handed out per process, so that each has its next one while a result is on its way.
_AHEAD = 2


class Engine(Protocol):
    """Applies a function to each item, in any order and in any process; for each it gives the place of the item and
    the result.

    The workers start when the context is entered, and are ended at once when it is left. An item
    whose worker dies goes to another one: the function must be able to begin again. An exception of the function ends
    the results.
    """

    def __call__(
        self, work: Callable[[T], R], items: Sequence[T], /
    ) -> AbstractContextManager[Iterator[tuple[int, R]]]: ...


class WorkersLost(Exception):
    """Too many workers were lost; the results until then stand."""

    exit_code = INVALID


def processors(limit: Path = _CONTAINER_LIMIT) -> int:
    """Number of processors that this process may use, at least 1.

    :param limit: file with the processor time per period that a container has.
    """
    allowed = len(os.sched_getaffinity(0))
    # A quota, "max" without one, and the period, both in us; no such file: no control groups of version 2.
    quota, period = limit.read_text().split() if limit.is_file() else ("max", "")
    return allowed if quota == "max" else max(1, min(allowed, ceil(int(quota) / int(period))))


def _one_process(work: Callable[[T], R], items: Sequence[T], /) -> AbstractContextManager[Iterator[tuple[int, R]]]:
    return nullcontext(enumerate(map(work, items)))


def processes(jobs: int, say: Say) -> Engine:
    """The engine on several processes of this machine; they end with this one, in whatever way it ends.

    With one process all is done in this one; with several even a single item is not: it may end its process.

    :param say: called when a process has died.
    """

    @contextmanager
    def engine(work: Callable[[T], R], items: Sequence[T], /) -> Iterator[Iterator[tuple[int, R]]]:
        if jobs < 2 or not items:
            yield enumerate(map(work, items))
            return
        with ExitStack() as held:
            count = min(jobs, len(items))
            yield _collected(held, held.enter_context(_pool(count)), work, items, count, say)

    return engine


def _collected(
    held: ExitStack, pool: ProcessPoolExecutor, work: Callable[[T], R], items: Sequence[T], count: int, say: Say
) -> Generator[tuple[int, R], None, None]:
    """Results of a pool, and of its successors when a process has died; ``held`` is the context of the pool.

    :raises WorkersLost: they died too often.
    """
    waiting, losses = list(reversed(range(len(items)))), 0
    running: dict[Future[R], int] = {}
    while waiting or running:
        try:
            while waiting and len(running) < _AHEAD * count:
                running[pool.submit(work, items[waiting[-1]])] = waiting[-1]
                waiting.pop()
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                result = future.result()
                yield running.pop(future), result
                losses = 0
        except BrokenProcessPool as error:
            losses += 1
            if losses >= LOSSES_MAX:
                raise WorkersLost(f"worker processes died {count_of(losses, 'time')} in a row (memory?)") from error
            waiting += sorted(running.values(), reverse=True)
            running.clear()
            say(f"a worker process died: what it had is run again, {len(waiting)} are left")
            held.close()
            pool = held.enter_context(_pool(count))


@contextmanager
def _pool(count: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that have been started; forked where that is safe, which saves loading all modules again."""
    others = set(multiprocessing.active_children())
    context = multiprocessing.get_context("fork" if can_fork() else "spawn")
    pool = ProcessPoolExecutor(count, context, _be_worker, (os.getpid(),))
    try:
        with _held_back():
            for _ in range(count):
                # A process starts with the first call that it could take.
                pool.submit(os.getpid)
        yield pool
    finally:
        # Workers hold back the signal by which a broken pool would end them.
        with _held_back():
            for process in set(multiprocessing.active_children()) - others:
                process.kill()
        pool.shutdown(cancel_futures=True)


def _be_worker(parent: int) -> None:
    """Leave the end to the command: Ctrl-C and ``timeout`` reach the whole group, and a worker that ended by itself
    would be a defect to the pool. If the command is killed, no other process ends its workers."""
    signal.pthread_sigmask(signal.SIG_BLOCK, ending_signals())
    end_with_parent()
    if os.getppid() != parent:
        # It was killed before.
        kill_this_process()


@contextmanager
def _held_back() -> Iterator[None]:
    """Signals are held back: an exception of a handler in the hooks around a fork would be lost."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ending_signals())
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _dask(jobs: int, scheduler: str | None, say: Say) -> Iterator[Engine]:
    need("distributed", "dask")
    from railhil.study.dask_engine import connected

    if scheduler is None:
        raise InputError("command line", "--scheduler", Words(), "tcp://HOST:PORT, the scheduler of --engine dask")
    with connected(scheduler, say) as engine:
        yield engine


#: Name -> (processes, address of dask's scheduler, what is called with remarks) -> the engine, ready to work.
_ENGINES: Mapping[str, Callable[[int, str | None, Say], AbstractContextManager[Engine]]] = {
    "batch": lambda jobs, scheduler, say: nullcontext(_one_process),
    "processes": lambda jobs, scheduler, say: nullcontext(processes(jobs, say)),
    "dask": _dask,
}
#: Names of the engines.
ENGINES = tuple(_ENGINES)


def running(
    name: str, say: Say, jobs: int | None = None, scheduler: str | None = None
) -> AbstractContextManager[Engine]:
    """The engine of that name, ready to work.

    :param say: called when a worker is lost.
    :param jobs: number of processes; None: one for each processor.
    :param scheduler: address of dask's scheduler.
    :raises scenarios.errors.InputError: a library is missing, or there is no answer from the address.
    """
    return _ENGINES[name](jobs or processors(), scheduler, say)


def in_order(results: Iterable[tuple[int, R]]) -> Iterator[R]:
    """Results of an engine in the order of the items, each as soon as those before it are there."""
    early: dict[int, R] = {}
    following = 0
    for place, result in results:
        early[place] = result
        while following in early:
            yield early.pop(following)
            following += 1


class Stop:
    """Whether a signal has stopped a command. ``error``: as it was raised, None if none has; ``code``: the exit code,
    128 and the number of the signal, else 0."""

    error: KeyboardInterrupt | SystemExit | None = None

    @property
    def code(self) -> int:
        if self.error is None:
            return 0
        code = getattr(self.error, "code", None)
        return code if isinstance(code, int) else 128 + signal.SIGINT

    def after(self, done: int, of: int) -> str:
        """The line on the signal, and on the share of the work done before it."""
        return f"stopped by {signal.Signals(self.code - 128).name} after {done} of {of}"


@contextmanager
def until_stopped() -> Iterator[Stop]:
    """A signal that ends the command ends only the block; results until then are kept and printed."""
    stop = Stop()
    try:
        yield stop
    except (KeyboardInterrupt, SystemExit) as error:
        # `timeout` signals twice; the remaining work is short.
        ignore_ending_signals()
        stop.error = error
