"""Requests of a node of a real-time run to the kernel while it keeps deadlines.

============================ =======================================================================================
request                      reason
============================ =======================================================================================
no garbage collection        a collection stops the node for milliseconds at an arbitrary moment
timer slack of 1 ns          without SCHED_FIFO the kernel may end a sleep 50 us late to save a wake-up
SCHED_FIFO                   the node runs as soon as it is woken, however busy the processors are
locked memory                no page of the node has to be loaded in the middle of a tick
============================ =======================================================================================

The last two need a permission; without it the node reports the scheduling it was granted and continues. A node that
computes for :data:`RUNAWAY_S` without a pause gives up SCHED_FIFO, and one that can no longer do so is killed by the
kernel (RLIMIT_RTTIME), so a defect of the bench cannot block the machine.
"""

from __future__ import annotations

import ctypes
import gc
import os
import resource
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from railhil.common.errors import describe_os_error

#: SCHED_FIFO priorities: the hub carries a frame before a node continues, and no node waits for the recorder. All are
#: below 50, the priority of interrupt threads in a PREEMPT_RT kernel, including the CAN adapter's.
HUB_PRIORITY, NODE_PRIORITY, RECORDER_PRIORITY = 45, 40, 30
#: 99 is reserved for the kernel.
PRIORITY_MAX = 98
#: Computing time without a pause after which a node gives up SCHED_FIFO, and after which the kernel kills it, s.
RUNAWAY_S, KILLED_S = 0.5, 2.0
_MCL_CURRENT, _MCL_FUTURE = 1, 2
_PR_SET_TIMERSLACK, _PR_GET_TIMERSLACK = 29, 30
#: Normal scheduling after restoring: without CAP_SYS_NICE a process may not clear the flag again (sched(7)).
_GIVEN_BACK = os.SCHED_OTHER | os.SCHED_RESET_ON_FORK
_NORMAL = "normal scheduling"
_MARK = ": scheduling: "


@dataclass(slots=True)
class Scheduling:
    """Scheduling of a node: ``priority`` of SCHED_FIFO (0: normal scheduling), and the same in words.

    ``name``: the node's name for the printed line, empty to print nothing.
    """

    name: str = ""
    priority: int = 0
    sentence: str = _NORMAL


@contextmanager
def cycle(name: str, priority: int, aloud: bool = True) -> Iterator[Scheduling]:
    """Context in which a process keeps deadlines; everything is restored at its end.

    :param name: of the node, for the line on standard error on the scheduling granted.
    :param priority: SCHED_FIFO priority to ask for; 0 asks for none and prints nothing.
    :param aloud: False for a process whose standard error belongs to the user.
    """
    collecting = gc.isenabled()
    gc.freeze()
    gc.disable()
    libc = ctypes.CDLL(None, use_errno=True)
    slack_ns = libc.prctl(_PR_GET_TIMERSLACK, 0, 0, 0, 0)
    libc.prctl(_PR_SET_TIMERSLACK, 1, 0, 0, 0)
    scheduling = Scheduling(name=name if aloud else "")
    try:
        if priority:
            with _first_in_first_out(priority, scheduling, libc):
                yield scheduling
        else:
            yield scheduling
    finally:
        libc.prctl(_PR_SET_TIMERSLACK, slack_ns, 0, 0, 0)
        gc.unfreeze()
        if collecting:
            gc.enable()


def is_said(line: str) -> bool:
    """Whether a line of a node's output is the one about its scheduling."""
    return _MARK in line


def said_in(text: str, name: str) -> str:
    """The last line on scheduling in a node's output; a node that requested nothing prints none."""
    found = [line.partition(_MARK)[2] for line in text.splitlines() if line.startswith(name + _MARK)]
    return found[-1] if found else _NORMAL


def permitted_priority(priority: int = NODE_PRIORITY) -> tuple[int, str]:
    """SCHED_FIFO priority that this process may have, tried and restored at once; 0 with the reason if none."""
    before, parameter = os.sched_getscheduler(0), os.sched_getparam(0)
    granted, reason = _ask(priority)
    if granted:
        os.sched_setscheduler(0, before | os.SCHED_RESET_ON_FORK, parameter)
    return granted, reason


@contextmanager
def _first_in_first_out(priority: int, scheduling: Scheduling, libc: ctypes.CDLL) -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        # Only the main thread can handle the signal for a runaway.
        _say(scheduling, f"not permitted (not the main thread of its process); {_NORMAL}")
        yield
        return

    def give_up(*_: object) -> None:
        os.sched_setscheduler(0, _GIVEN_BACK, os.sched_param(0))
        given_up = f"SCHED_FIFO {scheduling.priority} given up: it computed for {RUNAWAY_S:g} s without a pause"
        scheduling.priority = 0
        _say(scheduling, f"{given_up}; {_NORMAL}")

    handler = signal.signal(signal.SIGXCPU, give_up)
    try:
        _limit_runaway()
        # Lock the memory first: it takes a while, during which other processes can still run.
        memory = _lock_memory(libc)
        scheduling.priority, reason = _ask(priority)
        if scheduling.priority:
            _say(scheduling, f"SCHED_FIFO {scheduling.priority}, {memory}")
        else:
            _say(scheduling, f"not permitted ({reason}); {_NORMAL}, {memory}")
        yield
    finally:
        os.sched_setscheduler(0, _GIVEN_BACK, os.sched_param(0))
        scheduling.priority = 0
        libc.munlockall()
        signal.signal(signal.SIGXCPU, handler)


def _limit_runaway() -> None:
    """Lower RLIMIT_RTTIME permanently: it has no effect under normal scheduling."""
    wanted_us = (round(RUNAWAY_S * 1e6), round(KILLED_S * 1e6))
    limits_us = resource.getrlimit(resource.RLIMIT_RTTIME)
    soft, hard = (
        mine if limit == resource.RLIM_INFINITY else min(mine, limit)
        for mine, limit in zip(wanted_us, limits_us, strict=True)
    )
    resource.setrlimit(resource.RLIMIT_RTTIME, (min(soft, hard), hard))


def _ask(priority: int) -> tuple[int, str]:
    """Request SCHED_FIFO, at most at the priority that the user's limit allows."""
    limit = resource.getrlimit(resource.RLIMIT_RTPRIO)[0]
    reason = f"no CAP_SYS_NICE, rtprio limit {limit}"
    for wanted in (priority, min(priority, limit)):
        if wanted < 1:
            continue
        try:
            # Threads and processes started from here on are not part of the cycle.
            os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(wanted))
        except PermissionError:
            if wanted <= limit:
                reason = "the control group has no realtime budget, cpu.rt_runtime_us"
        except OSError as error:
            reason = describe_os_error(error)
        else:
            return wanted, ""
    return 0, reason


def _lock_memory(libc: ctypes.CDLL) -> str:
    """Lock as much memory as permitted; returns the result in words.

    Future memory is locked only if there is no limit: at a limit the next allocation would fail.
    """
    limit = resource.getrlimit(resource.RLIMIT_MEMLOCK)[0]
    if libc.mlockall(_MCL_CURRENT) != 0:
        return f"memory not locked ({os.strerror(ctypes.get_errno()).lower()}, memlock limit {limit // 1024} KiB)"
    # More locked memory than the limit means that CAP_IPC_LOCK is effective; in some containers it is not.
    unlimited = limit == resource.RLIM_INFINITY or _locked_bytes() > limit
    if unlimited and libc.mlockall(_MCL_CURRENT | _MCL_FUTURE) == 0:
        return "memory locked"
    return "memory locked as far as it was in use at the start"


def _locked_bytes() -> int:
    """Memory of this process that is locked (VmLck of proc(5), in KiB there)."""
    status = Path("/proc/self/status").read_text(encoding="ascii", errors="replace")
    return next((int(line.split()[1]) * 1024 for line in status.splitlines() if line.startswith("VmLck:")), 0)


def _say(scheduling: Scheduling, sentence: str) -> None:
    scheduling.sentence = sentence
    if scheduling.name:
        print(f"{scheduling.name}{_MARK}{sentence}", file=sys.stderr, flush=True)
