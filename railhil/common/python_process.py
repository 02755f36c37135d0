"""A module as a process of its own, ``python -P -m MODULE WORDS``: forked where that is safe, else a new interpreter.

A forked process has already loaded the modules of this one, which saves most of its start: a third of a second for a
node. Like a new interpreter it gets its standard streams and no other descriptors, default signals, its own command
line for :mod:`sys`, and no exit handlers of this process. Only tools that list processes show this command's line; the
short name there is the given title. The last functions end or stop this process.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import gc
import os
import runpy
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NoReturn, Protocol

#: prctl(2): a signal for this process when its parent thread exits.
_PR_SET_PDEATHSIG = 1
#: prctl(2): the name of this process in /proc/PID/comm, at most 15 bytes.
_PR_SET_NAME = 15
#: Interval between two checks whether a process has ended, s.
_LOOK_S = 0.002
#: Words before a command: the kernel ends it with its parent thread, also if this process is killed (util-linux).
WITH_PARENT = ("setpriv", "--pdeathsig", "KILL")


class Process(Protocol):
    """The common interface of :class:`subprocess.Popen` and a forked process."""

    pid: int
    returncode: int | None

    def poll(self) -> int | None:
        """Exit code, negative for a signal; None while it runs."""

    def wait(self, timeout: float | None = None) -> int:
        """Wait for the end, at most ``timeout`` s.

        :raises subprocess.TimeoutExpired: it still runs.
        """

    def send_signal(self, number: int, /) -> None:
        """Send it a signal, unless it has ended."""

    def terminate(self) -> None:
        """SIGTERM."""

    def kill(self) -> None:
        """SIGKILL."""


def start_module(title: str, module: str, words: Sequence[str], output: Path, handed: Sequence[int] = ()) -> Process:
    """Start it with nothing as its input.

    :param output: receives standard output and standard error.
    :param handed: descriptors that it inherits, under their numbers.
    """
    with output.open("wb") as stream:
        if can_fork():
            return _Forked(title, module, words, stream.fileno(), handed)
        return subprocess.Popen(
            [sys.executable, "-P", "-m", module, *words],
            stdin=subprocess.DEVNULL,
            stdout=stream,
            stderr=subprocess.STDOUT,
            pass_fds=handed,
        )


def can_fork() -> bool:
    """Not beside other threads, which may hold locks; elsewhere than on Linux, system libraries do not permit it."""
    return sys.platform == "linux" and threading.active_count() == 1


class _Forked:
    """A forked process, as :class:`Process`."""

    def __init__(self, title: str, module: str, words: Sequence[str], output: int, handed: Sequence[int]) -> None:
        self._words = [module, *words]
        self.returncode: int | None = None
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        # In the new process this command's handlers would raise in this command's code, which would continue there.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())
        gc.freeze()
        try:
            self.pid = os.fork()
            if not self.pid:
                _become(title, module, words, output, handed, before)
        finally:
            gc.unfreeze()
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    def poll(self) -> int | None:
        if self.returncode is None:
            try:
                pid, status = os.waitpid(self.pid, os.WNOHANG)
            except ChildProcessError:
                # Other code has waited for it; handled as in subprocess.
                pid, status = self.pid, 0
            if pid:
                self.returncode = os.waitstatus_to_exitcode(status)
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        deadline_s = None if timeout is None else time.monotonic() + timeout
        while True:
            code = self.poll()
            if code is not None:
                return code
            if deadline_s is not None and time.monotonic() >= deadline_s:
                raise subprocess.TimeoutExpired(self._words, timeout or 0.0)
            time.sleep(_LOOK_S)

    def send_signal(self, number: int) -> None:
        if self.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def terminate(self) -> None:
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        self.send_signal(signal.SIGKILL)


def _become(
    title: str, module: str, words: Sequence[str], output: int, handed: Sequence[int], blocked: set[int]
) -> NoReturn:
    """In the new process, with all signals held back: run the module and end with its exit code."""
    code = 1
    try:
        atexit._clear()
        _take_streams(output, handed)
        for number in signal.valid_signals():
            if callable(signal.getsignal(number)):
                signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
        signal.set_wakeup_fd(-1)
        # A Ctrl-C waits until the module listens to it.
        signal.pthread_sigmask(signal.SIG_SETMASK, {*blocked, signal.SIGINT})
        ctypes.CDLL(None).prctl(_PR_SET_NAME, title.encode()[:15], 0, 0, 0)
        sys.argv = [module, *words]
        runpy.run_path(_file(module), run_name="__main__")
        code = 0
    except SystemExit as stop:
        code = stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    except BaseException:
        sys.excepthook(*sys.exc_info())
    finally:
        try:
            signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())
            with contextlib.suppress(Exception):
                atexit._run_exitfuncs()
            for stream in (sys.stdout, sys.stderr):
                with contextlib.suppress(Exception):
                    stream.flush()
        finally:
            # Never return into this command's code.
            os._exit(code & 0xFF)


def _file(module: str) -> str:
    """The file that ``python -m`` runs: by its path, because not every import hook (pytest's) can run a module."""
    spec = find_spec(module)
    if spec is not None and spec.submodule_search_locations is not None:
        spec = find_spec(f"{module}.__main__")
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(f"No module named {module}")
    return spec.origin


def _take_streams(output: int, handed: Sequence[int]) -> None:
    """Standard streams and the handed descriptors; every other one is closed, among them ends of lifelines."""
    null = os.open(os.devnull, os.O_RDONLY)
    for number, source in enumerate((null, output, output)):
        os.dup2(source, number)
    low = 3
    for kept in sorted(handed):
        os.closerange(low, kept)
        low = kept + 1
    os.closerange(low, os.sysconf("SC_OPEN_MAX"))
    sys.stdin = os.fdopen(0, encoding="utf-8")
    # Buffered as for a file in a new interpreter, but each line is written when it is complete.
    for name, number in (("stdout", 1), ("stderr", 2)):
        setattr(sys, name, os.fdopen(number, "w", buffering=1, encoding="utf-8", errors="backslashreplace"))


def end_with_parent() -> None:
    """Ask the kernel to kill this process when its parent thread exits.

    Without this, killing the parent would leave this process running. Linux only; a no-op elsewhere. Children do not
    inherit it.
    """
    prctl = getattr(ctypes.CDLL(None), "prctl", None)
    if prctl is not None:
        prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)


def end_group(process: subprocess.Popen[Any]) -> None:
    """Kill a process that was started with a session of its own, and all that it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def kill_this_process() -> None:
    """End this process at once (SIGKILL)."""
    os.kill(os.getpid(), signal.SIGKILL)


def stop_this_process(duration_s: float) -> None:
    """Stop this process (SIGSTOP) and have it continued (SIGCONT) after a time on the wall clock in s."""
    number = str(os.getpid())
    # A stopped process cannot continue itself.
    words = ["sh", "-c", 'kill -STOP "$1"; sleep "$2"; kill -CONT "$1"', "sh", number, f"{duration_s:g}"]
    with subprocess.Popen(words, stdin=subprocess.DEVNULL, start_new_session=True) as helper:
        helper.wait()
