"""Engines: tasks in, parts out, in any order: in this process, on several cores (joblib) or machines (dask)."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from functools import partial
from typing import Any

from railhil.batch import say_compiling
from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import INVALID
from railhil.common.extras import need
from railhil.study.pool import be_worker
from railhil.study.work import Task, run_task

Parts = Generator[tuple[str, bytes], None, None]
Engine = Callable[[Sequence[Task]], Parts]
#: The function that a worker applies to a task; returns name and bytes of its part.
Work = Callable[[Any], tuple[str, bytes]]
#: Called with one sentence that the user should see at once.
Say = Callable[[str], None]
#: Number of successive worker losses, without a finished chunk in between, after which a study gives up.
LOSSES_MAX = 3


class WorkersLost(Exception):
    """Too many workers were lost; finished parts are kept."""

    exit_code = INVALID


def _batch(tasks: Sequence[Task], work: Work) -> Parts:
    yield from map(work, tasks)


def _joblib(tasks: Sequence[Task], work: Work, jobs: int, say: Say) -> Parts:
    import joblib
    from joblib.externals.loky.process_executor import BrokenProcessPool

    # A stopped study prints its own message.
    warnings.filterwarnings("ignore", message=".*still being processed by the workers", category=UserWarning)
    left = {task.name: task for task in tasks}
    losses = 0
    while left:
        calls = [joblib.delayed(work)(task) for task in left.values()]
        try:
            with joblib.parallel_config(backend="loky", n_jobs=jobs, initializer=be_worker):
                pool = joblib.Parallel(return_as="generator_unordered", batch_size=1)
                with closing(pool(calls)) as parts:
                    for name, content in parts:
                        yield name, content
                        del left[name]
                        losses = 0
        except BrokenProcessPool as error:
            losses += 1
            if losses >= LOSSES_MAX:
                raise WorkersLost(f"worker processes died {count_of(losses, 'time')} in a row (memory?)") from error
            say(f"a worker process died: what it had is run again, {len(left)} chunks are left")


@contextmanager
def running(
    name: str, jobs: int, scheduler: str | None, say: Say, *, work: Work = run_task, kernel: str | None = None
) -> Iterator[Engine]:
    """The engine of that name, ready to work.

    :param jobs: processes of joblib, -1 one per core.
    :param scheduler: address of dask's scheduler.
    :param say: called when a worker is lost.
    :param work: the function that a worker applies to a task.
    :param kernel: module with the compiled loops of the system's batch; None: nothing is compiled.
    :raises scenarios.errors.InputError: a library is missing, or there is no answer from the address.
    """
    if name == "dask":
        need("distributed", "dask")
        from railhil.study.dask_engine import connected

        if scheduler is None:
            raise InputError("command line", "--scheduler", Words(), "tcp://HOST:PORT, the scheduler of --engine dask")
        with connected(scheduler, say, work=work) as engine:
            yield engine
        return
    # If the work is done on this machine, report missing libraries before the folder is made.
    if kernel is not None:
        need("numba", "campaign")
        say_compiling(say, kernel)
    if name == "joblib":
        need("joblib", "campaign")
        yield partial(_joblib, work=work, jobs=jobs, say=say)
    else:
        yield partial(_batch, work=work)
