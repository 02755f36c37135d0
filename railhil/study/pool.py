"""Work on several processors; its processes end with the command, in any way."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from typing import TypeVar

from railhil.common.exit_codes import ending_signals, ignore_ending_signals
from railhil.common.python_process import end_with_parent

T = TypeVar("T")
R = TypeVar("R")


@contextmanager
def _held_back() -> Iterator[None]:
    """Signals are held back: an exception of a handler in the hooks around a fork would be lost."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ending_signals())
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def be_worker() -> None:
    """Leave the end to the command: Ctrl-C and ``timeout`` reach the whole group, and a worker that ended by itself
    would be a defect to the pool. If the command is killed, no other process ends its workers."""
    signal.pthread_sigmask(signal.SIG_BLOCK, ending_signals())
    end_with_parent()


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
        stop.error = error


@contextmanager
def each(work: Callable[[T], R], items: Sequence[T], jobs: int) -> Iterator[Iterator[R]]:
    """Results in the order of the items. If the block is left with an exception, the processes are ended at once.

    :param jobs: number of processes; 1: this one.
    """
    try:
        if jobs == 1 or len(items) < 2:
            yield map(work, items)
        else:
            with _processes(min(jobs, len(items))) as pool:
                with _held_back():
                    results = pool.map(work, items)
                yield results
    except (KeyboardInterrupt, SystemExit):
        # `timeout` signals twice; the remaining work is short.
        ignore_ending_signals()
        raise


@contextmanager
def _processes(count: int) -> Iterator[ProcessPoolExecutor]:
    others = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(count, initializer=be_worker)
    try:
        yield pool
    except BaseException:
        for process in set(multiprocessing.active_children()) - others:
            process.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
