"""Work beside a forked process has the result, and the errors, of this process alone."""

from __future__ import annotations

import subprocess
import sys

import pytest

#: In a process of its own: beside the threads of a test runner nothing is forked.
PROGRAM = """
import os, signal, sys, time
from pathlib import Path
from railhil.common import shared_out as module
from railhil.common.shared_out import shared_out

os.sched_getaffinity = lambda _: {0, 1}
here = os.getpid()
descriptors = sorted(os.listdir("/proc/self/fd"))

def alone() -> bool:
    return os.getpid() == here

def slow(value):
    def piece():
        time.sleep(0.05)
        return value, alone()
    return piece

def nothing_is_left():
    assert sorted(os.listdir("/proc/self/fd")) == descriptors
    try:
        os.waitpid(-1, 0)
    except ChildProcessError:
        return
    raise AssertionError("a process is left")
"""


def outcome(code: str) -> list[str]:
    done = subprocess.run([sys.executable, "-c", PROGRAM + code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_two_processes_do_the_pieces_and_the_results_are_in_order() -> None:
    code = """
found = shared_out([slow(k) for k in range(20)], meanwhile=lambda: print("meanwhile", alone()))
assert [value for value, _ in found] == list(range(20))
assert len({by for _, by in found}) == 2, found
nothing_is_left()
"""
    assert outcome(code) == ["meanwhile True"]


@pytest.mark.parametrize(
    "end", ["os.kill(os.getpid(), signal.SIGKILL)", "raise OSError(28, 'full')", "os._exit(0)", "return lambda: None"]
)
def test_what_the_other_process_does_not_bring_to_an_end_is_done_here(end: str) -> None:
    code = f"""
def piece():
    if not alone():
        {end}
    return "done here"

begun_s = time.monotonic()
assert shared_out([piece, piece, piece], meanwhile=lambda: time.sleep(0.2)) == ["done here"] * 3
nothing_is_left()
"""
    assert outcome(code) == []


@pytest.mark.parametrize("error", ["OSError(28, 'full')", "KeyboardInterrupt()"])
def test_an_error_is_raised_here_and_ends_the_other_process(error: str) -> None:
    code = f"""
def wrong():
    raise {error}

def endless():
    if alone():
        return
    time.sleep(1000)

for pieces, meanwhile in (([wrong, wrong], None), ([endless, endless], wrong)):
    try:
        shared_out(pieces, meanwhile)
    except BaseException as found:
        assert repr(found) == repr({error}), found
    else:
        raise AssertionError("no error")
    nothing_is_left()
"""
    assert outcome(code) == []


def test_the_signals_of_a_terminal_leave_the_other_process_alone() -> None:
    """Whoever has started it decides; a run that writes its results completes them."""
    code = """
os.setsid()
signal.signal(signal.SIGINT, lambda *_: print("told"))

def piece():
    if not alone():
        os.killpg(os.getpgid(0), signal.SIGINT)
        time.sleep(0.1)
    return alone()

assert shared_out([piece], meanwhile=lambda: time.sleep(0.3)) == [False]
nothing_is_left()
"""
    assert outcome(code) == ["told"]


@pytest.mark.parametrize(
    "reason",
    [
        "os.fork = None; os.sched_getaffinity = lambda _: {0}",
        "os.fork = None; module.can_fork = lambda: False",
        "os.fork = lambda: (_ for _ in ()).throw(BlockingIOError(11, 'no process'))",
        "os.memfd_create = lambda _: (_ for _ in ()).throw(OSError(24, 'too many files'))",
    ],
)
def test_without_another_process_all_is_done_here(reason: str) -> None:
    code = f"""
{reason}
assert shared_out([slow(1), slow(2)], meanwhile=lambda: print("meanwhile")) == [(1, True), (2, True)]
nothing_is_left()
"""
    assert outcome(code) == ["meanwhile"]
