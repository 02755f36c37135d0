"""A near and a far end on one bus, in Python or in C, and the conditions under which they are measured."""

from __future__ import annotations

import os
import resource
import select
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import psutil

from benchmarks.buses import Ends
from benchmarks.figures import MeasurementError
from benchmarks.peer import COMPLAINT
from benchmarks.processes import end, last_line

PYTHON = "Python"
C = "C"
#: Identifiers of the pairs' frames: two pairs may share a bus, and each receives only its own frames.
_FIRST_ID = {PYTHON: 0x110, C: 0x120}
_READY_S = 60.0
#: Time limit of a command.
ANSWER_S = 120.0
#: The hub has priority over its clients, as in a run.
_HUB_PRIORITY, _END_PRIORITY = 51, 50
#: CPU time without a wait after which the kernel ends a SCHED_FIFO process, which would otherwise block the machine.
_RUNAWAY_S = 5
_SPIN = "import sys, time\nend = time.monotonic() + float(sys.argv[1])\nwhile time.monotonic() < end: pass"


def _start(program: Sequence[str], mode: str, where: tuple[str, str], first_id: int) -> subprocess.Popen[bytes]:
    """Start an end; it inherits its own socket of a pair, but not the other end's."""
    kind, address = where
    return subprocess.Popen(
        [*program, mode, kind, address, hex(first_id)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        pass_fds=(int(address),) if kind == "pair" else (),
    )


class Pair:
    """Two processes; a context manager that ends both.

    :param language: PYTHON or C.
    :param loop: the C program, for C.
    """

    def __init__(self, language: str, loop: Path | None, ends: Ends) -> None:
        self.language = language
        self._name = f"{language} loop on {' '.join(ends.near)}"
        self._hub_pids = ends.hub_pids
        program = [str(loop)] if loop is not None else [sys.executable, "-m", "benchmarks.peer"]
        self._received = b""
        self._far = _start(program, "echo", ends.far, _FIRST_ID[language])
        try:
            self._near = _start(program, "near", ends.near, _FIRST_ID[language])
        except BaseException:
            # Ctrl-C too leaves no process behind.
            end(self._far)
            raise

    def __enter__(self) -> Pair:
        return self

    def __exit__(self, *_: object) -> None:
        for process in (self._near, self._far):
            end(process)
            for stream in (process.stdin, process.stdout, process.stderr):
                if stream is not None:
                    stream.close()

    @property
    def pids(self) -> list[int]:
        """Process ids of both ends."""
        return [self._near.pid, self._far.pid]

    @property
    def hub_pids(self) -> list[int]:
        """Ids of the processes between the ends, also of processes that a daemon has started for its clients."""
        children = [child.pid for pid in self._hub_pids for child in psutil.Process(pid).children()]
        return [*self._hub_pids, *children]

    def wait_until_ready(self) -> None:
        """Wait until frames are echoed.

        :raises MeasurementError: they are not.
        """
        if self._line(_READY_S) != "ready":
            raise MeasurementError(f"{self._name}: the near end is not ready")

    def tell(self, command: str) -> None:
        """Send a command of :mod:`benchmarks.peer`; :meth:`answer` returns its result."""
        assert self._near.stdin is not None
        self._near.stdin.write(f"{command}\n".encode())
        self._near.stdin.flush()

    def answer(self) -> list[int]:
        """Nanoseconds measured by the previous command.

        :raises MeasurementError: an end has failed, or does not answer in time.
        """
        return [int(word) for word in self._line(ANSWER_S).split()]

    def ask(self, command: str) -> list[int]:
        """:meth:`tell` and :meth:`answer`."""
        self.tell(command)
        return self.answer()

    def _line(self, timeout_s: float) -> str:
        assert self._near.stdout is not None
        descriptor = self._near.stdout.fileno()
        deadline_s = time.monotonic() + timeout_s
        while b"\n" not in self._received:
            rest_s = deadline_s - time.monotonic()
            if rest_s <= 0 or not select.select([descriptor], [], [], rest_s)[0]:
                raise MeasurementError(f"{self._name}: no answer within {timeout_s:g} s")
            chunk = os.read(descriptor, 1 << 20)
            if not chunk:
                raise MeasurementError(f"{self._name}: {self._last_words()}")
            self._received += chunk
        line, _, self._received = self._received.partition(b"\n")
        return line.decode()

    def _last_words(self) -> str:
        """The reason why the near end, or else the far end, has ended."""
        for process in (self._near, self._far):
            end(process)
            assert process.stderr is not None
            said = process.stderr.read().decode(errors="replace")
            # A library may complain after the end's own line, when its objects are freed.
            own = [line for line in said.splitlines() if line.startswith(COMPLAINT)]
            if own or said:
                return own[-1] if own else last_line(said)
        return "an end has ended without a word"


@contextmanager
def pinned(pids: Iterable[int]) -> Iterator[None]:
    """Keep processes on one CPU."""
    before = os.sched_getaffinity(0)
    _set_affinity(pids, {min(before)})
    try:
        yield
    finally:
        _set_affinity(pids, before)


def _set_affinity(pids: Iterable[int], cpus: set[int]) -> None:
    for pid in pids:
        os.sched_setaffinity(pid, cpus)


@contextmanager
def fifo(pairs: Sequence[Pair]) -> Iterator[None]:
    """SCHED_FIFO for the pairs and their hubs, which have the higher priority.

    :raises PermissionError: not permitted for this user.
    """
    priorities = {pid: _HUB_PRIORITY for pair in pairs for pid in pair.hub_pids}
    priorities |= {pid: _END_PRIORITY for pair in pairs for pid in pair.pids}
    limits = {pid: resource.prlimit(pid, resource.RLIMIT_RTTIME) for pid in priorities}
    try:
        for pid, priority in priorities.items():
            resource.prlimit(pid, resource.RLIMIT_RTTIME, _runaway_limit_us(limits[pid]))
            os.sched_setscheduler(pid, os.SCHED_FIFO, os.sched_param(priority))
        yield
    finally:
        for pid, limit in limits.items():
            # A process that has ended needs no reset.
            with suppress(ProcessLookupError):
                os.sched_setscheduler(pid, os.SCHED_OTHER, os.sched_param(0))
                resource.prlimit(pid, resource.RLIMIT_RTTIME, limit)


def _runaway_limit_us(limits_us: tuple[int, int]) -> tuple[int, int]:
    """Soft and hard RLIMIT_RTTIME: our limits, or the lower hard limit that the process was started with."""
    hard_us = limits_us[1]
    wanted_us = _RUNAWAY_S * 1_000_000
    return (wanted_us if hard_us == resource.RLIM_INFINITY else min(wanted_us, hard_us)), hard_us


@contextmanager
def busy_cores(limit_s: float) -> Iterator[None]:
    """A busy loop on every core; the processes end by themselves after ``limit_s``."""
    spinners: list[subprocess.Popen[Any]] = []
    with ExitStack() as stack:
        for cpu in os.sched_getaffinity(0):
            spinner = subprocess.Popen([sys.executable, "-c", _SPIN, str(limit_s)])
            stack.callback(end, spinner)
            os.sched_setaffinity(spinner.pid, {cpu})
            spinners.append(spinner)
        # Wait until the interpreters have started and the load is effective.
        time.sleep(0.3)
        yield
