"""One session of pytest that has collected a module's tests and runs them in forks of itself, once for each mutant.

Nothing is imported twice: a fork costs some milliseconds. A mutant inside a function is put into the imported module,
and only the tests that come to its line are run, the shortest first, up to the first failure. Any other (a constant of
the module, a default value), and any that survives, needs a session of its own, in a process that has not imported the
module.
"""

from __future__ import annotations

import gc
import os
import pickle
import resource
import select
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

import pytest

from hil_tests.mutation.install import replace_code
from hil_tests.mutation.operators import Mutant
from railhil.common.python_process import end_with_parent

#: What a mutant may use before it counts as noticed: an endless loop, or endless memory.
CPU_FACTOR, CPU_MARGIN_S, MEMORY_MAX_BYTES = 5, 2, 4 << 30


@dataclass
class Baseline:
    """A run of the tests on the module as it is: duration of each test in s, lines of the module that it came to."""

    failed: list[str] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)
    lines: dict[str, set[int]] = field(default_factory=dict)


def forked(work: Callable[[], Any]) -> tuple[int, int]:
    """Start a process for ``work``: its id, and a file descriptor from which the pickled result can be read.

    It ends with this process, however that ends. A signal to the command would not reach it, because it has a process
    group of its own.
    """
    reading, writing = os.pipe()
    parent = os.getpid()
    sys.stdout.flush()
    sys.stderr.flush()
    pid = os.fork()
    if pid:
        os.close(writing)
        return pid, reading
    try:
        os.close(reading)
        os.setpgid(0, 0)
        end_with_parent()
        if os.getppid() != parent:
            # It ended before it could be watched.
            return 0, reading
        result = pickle.dumps(work())
        with os.fdopen(writing, "wb") as pipe:
            pipe.write(result)
    finally:
        # Neither exit handlers nor the parent's stack belong to this process.
        os._exit(0)


def collected(pid: int, reading: int, timeout_s: float | None = None) -> Any:
    """The result of a process of :func:`forked`; None if a signal, an exception or ``timeout_s`` ended it."""
    with os.fdopen(reading, "rb") as pipe:
        ready, _, _ = select.select([pipe], [], [], timeout_s)
        if not ready:
            os.killpg(pid, signal.SIGKILL)
        data = pipe.read() if ready else b""
    os.waitpid(pid, 0)
    return pickle.loads(data) if data else None


def side_by_side(works: Iterable[Callable[[], Any]], jobs: int, timeout_s: float) -> Iterator[Any]:
    """Results of the works in their order, ``jobs`` processes at a time."""
    running: deque[tuple[int, int]] = deque()
    for work in works:
        running.append(forked(work))
        if len(running) == jobs:
            yield collected(*running.popleft(), timeout_s)
    while running:
        yield collected(*running.popleft(), timeout_s)


def limit_process(seconds: float) -> None:
    """Limits of a process in which a mutant runs."""
    used_s = time.process_time()
    allowed_s = int(used_s + CPU_FACTOR * seconds + CPU_MARGIN_S)
    resource.setrlimit(resource.RLIMIT_CPU, (allowed_s, allowed_s))
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY_MAX_BYTES, MEMORY_MAX_BYTES))
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    os.dup2(quiet, 2)


class Reports:
    """Plugin that keeps the outcome of each test."""

    def __init__(self) -> None:
        self.failed: list[str] = []
        self.seconds: dict[str, float] = {}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.seconds[report.nodeid] = self.seconds.get(report.nodeid, 0.0) + report.duration
        if report.failed and report.nodeid not in self.failed:
            self.failed.append(report.nodeid)


def run_items(items: Sequence[pytest.Item], stop: bool = True) -> Reports:
    """Run collected tests in this process, up to the first failure if ``stop``."""
    reports = Reports()
    items[0].config.pluginmanager.register(reports)
    for place, item in enumerate(items):
        following = items[place + 1] if place + 1 < len(items) else None
        item.ihook.pytest_runtest_protocol(item=item, nextitem=following)
        if stop and reports.failed:
            break
    return reports


class WarmSession:
    """Plugin that replaces pytest's loop over the tests: ``baseline`` and ``cold`` are its results.

    ``cold``: the places in ``mutants`` of those that need a session of their own. Of those inside functions these are
    the ones that no test noticed here: the function may have been called at the import, by the tests too.
    """

    def __init__(self, module: str, mutants: Sequence[Mutant], jobs: int) -> None:
        self._module, self._mutants, self._jobs = module, mutants, jobs
        self.baseline = Baseline()
        self.cold: list[int] = []

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        __import__(self._module)
        module = sys.modules[self._module]
        gc.freeze()
        items = session.items
        baseline: Baseline | None = collected(*forked(lambda: self._baseline(items)))
        if baseline is None:
            raise pytest.UsageError(f"{self._module}: the tests of the unchanged module ended their process")
        self.baseline = baseline
        if baseline.failed:
            return True
        by_duration = sorted(items, key=lambda item: baseline.seconds[item.nodeid])

        def trial(mutant: Mutant) -> Callable[[], Any]:
            chosen = [item for item in by_duration if not baseline.lines[item.nodeid].isdisjoint(mutant.lines)]
            return lambda: self._trial(mutant, chosen, sum(baseline.seconds[item.nodeid] for item in chosen))

        warm = [place for place, mutant in enumerate(self._mutants) if mutant.in_body]
        self.cold = [place for place, mutant in enumerate(self._mutants) if not mutant.in_body]
        timeout_s = 60 + 20 * sum(baseline.seconds.values())
        results = side_by_side((trial(self._mutants[place]) for place in warm), self._jobs, timeout_s)
        self.cold += [place for place, noticed in zip(warm, results, strict=True) if noticed is False]
        assert module is sys.modules[self._module]
        return True

    def _baseline(self, items: Sequence[pytest.Item]) -> Baseline:
        found = Baseline()
        path = sys.modules[self._module].__file__
        lines: set[int] = set()

        def inside(frame: FrameType, event: str, arg: object) -> Any:
            lines.add(frame.f_lineno)
            return inside

        def entered(frame: FrameType, event: str, arg: object) -> Any:
            return inside if frame.f_code.co_filename == path else None

        reports = Reports()
        items[0].config.pluginmanager.register(reports)
        for place, item in enumerate(items):
            lines.clear()
            threading.settrace(entered)
            sys.settrace(entered)
            following = items[place + 1] if place + 1 < len(items) else None
            item.ihook.pytest_runtest_protocol(item=item, nextitem=following)
            sys.settrace(None)
            found.lines[item.nodeid] = set(lines)
        found.failed, found.seconds = reports.failed, reports.seconds
        return found

    def _trial(self, mutant: Mutant, items: Sequence[pytest.Item], seconds: float) -> bool:
        """Whether a test notices it. An endless mutant ends this process, which counts as noticed."""
        if not items or not replace_code(sys.modules[self._module], mutant.tree(), mutant.scope):
            return False
        limit_process(seconds)
        return bool(run_items(items).failed)


class ColdSession:
    """Plugin for a session on a module that was imported changed: the shortest tests first, up to the first failure."""

    def __init__(self, seconds: dict[str, float]) -> None:
        self._seconds = seconds
        self.alive = False

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items.sort(key=lambda item: self._seconds.get(item.nodeid, 0.0))

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        if not session.testsfailed:
            self.alive = not run_items(session.items).failed
        return True
