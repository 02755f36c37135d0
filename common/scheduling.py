"""What a node of a realtime run asks of the kernel, for the time in which it keeps deadlines.

============================ =======================================================================================
asked for                    because
============================ =======================================================================================
no garbage collection        a collection stops the node for milliseconds at a moment of its own choice
timer slack of 1 ns          without SCHED_FIFO the kernel lets a sleep end 50 us late to save a wake-up
SCHED_FIFO                   the node runs as soon as it is woken, however busy the processors are
locked memory                no page of the node has to be fetched in the middle of a tick
============================ =======================================================================================

The last two need a permission; the node says what it was granted and goes on without. A node that computes for
:data:`RUNAWAY_S` without a pause gives SCHED_FIFO up, and one that cannot even do that any more is killed by the kernel
(RLIMIT_RTTIME): a defect of the bench never takes the machine with it.
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

#: SCHED_FIFO priorities: a frame is carried before a node goes on, and no node waits for the recorder. All below 50,
#: where a PREEMPT_RT kernel has its interrupt threads, the CAN adapter's among them.
HUB_PRIORITY, NODE_PRIORITY, RECORDER_PRIORITY = 45, 40, 30
#: 99 is the kernel's own.
PRIORITY_MAX = 98
#: Computing time without a pause after which a node gives SCHED_FIFO up, and after which the kernel kills it, s.
RUNAWAY_S, KILLED_S = 0.5, 2.0
_MCL_CURRENT, _MCL_FUTURE = 1, 2
_PR_SET_TIMERSLACK, _PR_GET_TIMERSLACK = 29, 30
#: Normal scheduling as it is given back: who has no CAP_SYS_NICE may not take the flag away again (sched(7)).
_GIVEN_BACK = os.SCHED_OTHER | os.SCHED_RESET_ON_FORK
_NORMAL = "normal scheduling"
_MARK = ": scheduling: "


@dataclass(slots=True)
class Scheduling:
    """How a node is scheduled: ``priority`` of SCHED_FIFO (0: normal scheduling), and the same in words.

    ``name``: under which it is said aloud, empty for not.
    """

    name: str = ""
    priority: int = 0
    sentence: str = _NORMAL


@contextmanager
def cycle(name: str, priority: int, aloud: bool = True) -> Iterator[Scheduling]:
    """The part of a process in which deadlines are kept; everything is given back at its end.

    :param name: of the node, for the line on standard error that says what was granted.
    :param priority: SCHED_FIFO priority to ask for; 0 asks for none and says nothing.
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
    """Whether a line of a node's output only says how it is scheduled."""
    return _MARK in line


def said_in(text: str, name: str) -> str:
    """What a node has last said of its scheduling in its output; a node that was not asked says nothing."""
    found = [line.partition(_MARK)[2] for line in text.splitlines() if line.startswith(name + _MARK)]
    return found[-1] if found else _NORMAL


def permitted_priority(priority: int = NODE_PRIORITY) -> tuple[int, str]:
    """SCHED_FIFO priority that this process may have, tried and given back at once; 0 with the reason when none."""
    before, parameter = os.sched_getscheduler(0), os.sched_getparam(0)
    granted, reason = _ask(priority)
    if granted:
        os.sched_setscheduler(0, before | os.SCHED_RESET_ON_FORK, parameter)
    return granted, reason


@contextmanager
def _first_in_first_out(priority: int, scheduling: Scheduling, libc: ctypes.CDLL) -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        # Only the main thread can be told that it has run away.
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
        # First the memory: to lock it takes a while, which no other process has to wait for.
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
    """Lower RLIMIT_RTTIME, for good: it is of no account under normal scheduling."""
    wanted_us = (round(RUNAWAY_S * 1e6), round(KILLED_S * 1e6))
    limits_us = resource.getrlimit(resource.RLIMIT_RTTIME)
    soft, hard = (
        mine if limit == resource.RLIM_INFINITY else min(mine, limit)
        for mine, limit in zip(wanted_us, limits_us, strict=True)
    )
    resource.setrlimit(resource.RLIMIT_RTTIME, (min(soft, hard), hard))


def _ask(priority: int) -> tuple[int, str]:
    """Ask for SCHED_FIFO, at most at the priority that the limit of the user allows."""
    limit = resource.getrlimit(resource.RLIMIT_RTPRIO)[0]
    reason = f"no CAP_SYS_NICE, rtprio limit {limit}"
    for wanted in (priority, min(priority, limit)):
        if wanted < 1:
            continue
        try:
            # Threads and processes started from here on are no part of the cycle.
            os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(wanted))
        except PermissionError:
            if wanted <= limit:
                reason = "the control group has no realtime budget, cpu.rt_runtime_us"
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
        else:
            return wanted, ""
    return 0, reason


def _lock_memory(libc: ctypes.CDLL) -> str:
    """Lock memory as far as permitted; what was reached, in words.

    Memory of the future is only locked where no limit holds: at a limit the next allocation would fail.
    """
    limit = resource.getrlimit(resource.RLIMIT_MEMLOCK)[0]
    if libc.mlockall(_MCL_CURRENT) != 0:
        return f"memory not locked ({os.strerror(ctypes.get_errno()).lower()}, memlock limit {limit // 1024} KiB)"
    # Above the limit means that CAP_IPC_LOCK counts here, which it does not in every container.
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
