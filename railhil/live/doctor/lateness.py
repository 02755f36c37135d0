"""Lateness of a loop with absolute deadlines, measured on this machine."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from railhil.bus.clock import Pacer
from railhil.common.scheduling import NODE_PRIORITY, cycle, permitted_priority
from railhil.judge.jitter import LATE_MS, Jitter, jitter_from
from railhil.live.doctor.finding import Finding
from railhil.live.doctor.machine import is_virtual

CYCLE_NS = 10_000_000
CYCLES = 200
#: Required p99 lateness of a plant, ms: 1 without SCHED_FIFO on an idle machine, 0.3 with it under any load.
GOOD_P99_MS = {0: 1.0, NODE_PRIORITY: 0.3}
_VIRTUAL = "most likely stopped by the host: give the virtual machine whole processors of it"
_REAL = "a driver, another realtime process or the firmware (SMI): a PREEMPT_RT kernel, `hwlatdetect`, power saving off"


def lateness() -> list[Finding]:
    """Measured for 2 s with normal scheduling, and for 2 s more with SCHED_FIFO if permitted."""
    priorities = [0, NODE_PRIORITY] if permitted_priority()[0] else [0]
    virtual = is_virtual(Path("/"))
    return [judged(measured(priority), priority, virtual) for priority in priorities]


def measured(priority: int, cycles: int = CYCLES) -> Jitter:
    """Lateness of ``cycles`` cycles of 10 ms."""
    late_ms = np.zeros(cycles)
    with cycle("doctor", priority, aloud=False):
        pacer = Pacer(1.0)
        pacer.start()
        for tick in range(cycles):
            # The first deadline is in the future, so that it is waited for.
            late_ms[tick] = pacer.wait((tick + 1) * CYCLE_NS) / 1e6
    return jitter_from(late_ms)


def judged(jitter: Jitter, priority: int, virtual: bool) -> Finding:
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
