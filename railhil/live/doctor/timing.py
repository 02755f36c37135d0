"""The realtime scheduling that this machine permits, and the measured lateness of a loop with absolute deadlines."""

from __future__ import annotations

import getpass
import platform
from pathlib import Path

import numpy as np

from railhil.bus.clock import Pacer
from railhil.common.scheduling import HUB_PRIORITY, NODE_PRIORITY, cycle, permitted_priority
from railhil.judge.jitter import LATE_MS, Jitter, jitter_from
from railhil.live.doctor.machine import Finding, is_virtual, read_text

#: sched_rt_runtime_us without throttling, sched(7).
_NO_THROTTLE = -1
#: Minimum share of the time needed for a run.
_SHARE_MIN = 0.5


def scheduling(root: Path = Path("/"), version: str | None = None) -> list[Finding]:
    """SCHED_FIFO, locked memory, throttling and the preemption model."""
    return [
        fifo(*permitted_priority(HUB_PRIORITY)),
        _memory(),
        _throttle(root),
        preemption(root, version or platform.version()),
    ]


def fifo(granted: int, reason: str) -> Finding:
    """SCHED_FIFO.

    :param granted: highest priority granted to this process of those that the bench requests, 0: none.
    :param reason: reason why a higher one is not granted.
    """
    if granted == HUB_PRIORITY:
        return Finding("SCHED_FIFO", f"permitted at the bench's priorities, up to {HUB_PRIORITY}")
    advice = f"echo '{_user()} - rtprio {HUB_PRIORITY}' | sudo tee -a /etc/security/limits.conf, then log in again"
    if granted:
        return Finding("SCHED_FIFO", f"permitted up to {granted} only: hub and nodes share a priority", advice)
    return Finding("SCHED_FIFO", f"not permitted ({reason})", advice)


def _memory() -> Finding:
    """Scheduling that a node would be granted, found by trying, because limit or capabilities alone do not determine
    it."""
    with cycle("doctor", HUB_PRIORITY, aloud=False) as granted:
        memory = granted.sentence.rpartition(", memory ")[2]
    if memory == "locked":
        return Finding("locked memory", "permitted")
    command = f"echo '{_user()} - memlock unlimited' | sudo tee -a /etc/security/limits.conf, then log in again"
    return Finding("locked memory", memory, command)


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return "USER"


def _throttle(root: Path) -> Finding:
    text = read_text(root / "proc/sys/kernel/sched_rt_runtime_us")
    period = read_text(root / "proc/sys/kernel/sched_rt_period_us")
    if not text or not period:
        return Finding("throttle", "not known (no sched_rt_runtime_us)")
    if int(text) == _NO_THROTTLE:
        advice = "sudo sysctl kernel.sched_rt_runtime_us=950000"
        return Finding("throttle", "none: a runaway SCHED_FIFO process takes a processor for good", advice)
    share = int(text) / int(period)
    if share < _SHARE_MIN:
        return Finding("throttle", f"realtime has {share:.0%} only", "sudo sysctl kernel.sched_rt_runtime_us=950000")
    return Finding("throttle", f"realtime processes have at most {share:.0%} of the time (the bench needs less)")


def preemption(root: Path, version: str) -> Finding:
    """Preemption model: it decides how soon the kernel runs a woken process."""
    if read_text(root / "sys/kernel/realtime") == "1" or "PREEMPT_RT" in version:
        return Finding("preemption", "PREEMPT_RT: latencies have a bound")
    chosen = read_text(root / "sys/kernel/debug/sched/preempt")
    mode = chosen.partition("(")[2].partition(")")[0]
    kind = "PREEMPT_DYNAMIC" if "PREEMPT_DYNAMIC" in version else "PREEMPT" if "PREEMPT" in version else "none"
    shown = f"{kind}, now {mode}" if mode else kind
    if kind == "none" or mode in ("none", "voluntary"):
        advice = "kernel parameter preempt=full" if "DYNAMIC" in kind else "a kernel with PREEMPT or PREEMPT_RT"
        return Finding("preemption", f"{shown}: latencies of milliseconds are possible", advice)
    if kind == "PREEMPT_DYNAMIC" and not mode:
        # The kernel may have been started with preempt=none, so nothing is claimed without a check.
        shown += ", its mode not known (root can read /sys/kernel/debug/sched/preempt)"
    advice = "for a bound: a PREEMPT_RT kernel (Debian: sudo apt install linux-image-rt-amd64)"
    return Finding("preemption", f"{shown}: no bound; the 10 ms loop measures", advice)


CYCLE_NS = 10_000_000
CYCLES = 200
#: Required p99 lateness of a plant, ms: 1 without SCHED_FIFO on an idle machine, 0.3 with it under any load.
GOOD_P99_MS = {0: 1.0, NODE_PRIORITY: 0.3}
_VIRTUAL = "most likely stopped by the host: give the virtual machine whole processors of it"
_REAL = "a driver, another realtime process or the firmware (SMI): a PREEMPT_RT kernel, `hwlatdetect`, power saving off"


def measure_lateness() -> list[Finding]:
    """Measure for 2 s with normal scheduling, and for 2 s more with SCHED_FIFO if permitted."""
    priorities = [0, NODE_PRIORITY] if permitted_priority()[0] else [0]
    virtual = is_virtual(Path("/"))
    return [judge(measure(priority), priority, virtual) for priority in priorities]


def measure(priority: int, cycles: int = CYCLES) -> Jitter:
    """Lateness of ``cycles`` cycles of 10 ms."""
    late_ms = np.zeros(cycles)
    with cycle("doctor", priority, aloud=False):
        pacer = Pacer(1.0)
        pacer.start()
        for tick in range(cycles):
            # The first deadline is in the future, so that the loop waits for it.
            late_ms[tick] = pacer.wait((tick + 1) * CYCLE_NS) / 1e6
    return jitter_from(late_ms)


def judge(jitter: Jitter, priority: int, virtual: bool) -> Finding:
    """Figures of a measurement, and the remedy if they are not good enough for a run at 1x.

    :param virtual: whether it was measured in a virtual machine.
    """
    name = "SCHED_FIFO" if priority else "normal scheduling"
    found = f"{name}: p50 {jitter.p50_ms:.3f} ms, p99 {jitter.p99_ms:.3f} ms, max {jitter.max_ms:.3f} ms late"
    if priority and jitter.max_ms > LATE_MS:
        # SCHED_FIFO can be delayed by the kernel's own work, a higher priority, the throttling, or a layer below the
        # kernel.
        return Finding("10 ms loop", found, _VIRTUAL if virtual else _REAL)
    if jitter.p99_ms <= GOOD_P99_MS[priority]:
        return Finding("10 ms loop", found)
    better = "a PREEMPT_RT kernel" if priority else "fewer other processes, or SCHED_FIFO"
    return Finding("10 ms loop", found, f"p99 above {GOOD_P99_MS[priority]:g} ms: {better}")
