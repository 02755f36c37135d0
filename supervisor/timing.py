"""Jitter of a realtime run, as the supervisor saw the ticks arrive."""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scenarios.model import Scenario

#: A run in which more than this share of the cycles came more than ``LATE_MS`` late is INVALID.
LATE_SHARE_MAX = 0.001
LATE_MS = 5.0


@dataclass(frozen=True, slots=True)
class Jitter:
    """Lateness of the ticks against absolute deadlines, in ms; the earliest tick defines zero."""

    cycles: int
    p50_ms: float
    p99_ms: float
    p999_ms: float
    max_ms: float
    late_share: float

    @property
    def valid(self) -> bool:
        """Timing good enough for a verdict."""
        return self.late_share <= LATE_SHARE_MAX

    def sentence(self) -> str:
        """Why the timing is not good enough."""
        return (
            f"timing: {self.late_share:.2%} of {self.cycles} cycles more than {LATE_MS:g} ms late, "
            f"allowed {LATE_SHARE_MAX:.1%}"
        )


def write_wall_times(ticks: array[int], wall_ns: array[int], out: Path) -> None:
    """Write the side file of a realtime run: arrival of each tick in ns of wall time since the first."""
    rows = np.column_stack([np.array(ticks, dtype=np.int64), np.array(wall_ns, dtype=np.int64)])
    rows[:, 1] -= rows[0, 1] if len(rows) else 0
    np.savetxt(out, rows, fmt="%d", delimiter=",", header="tick,wall_ns", comments="")


def jitter_of(ticks: array[int], wall_ns: array[int], scenario: Scenario, rate: float) -> Jitter:
    """Jitter of tick arrivals at a pace of ``rate`` simulated seconds per second."""
    due_ns = np.array(ticks, dtype=np.int64) * (scenario.timing.base_tick_ns / rate)
    late_ms = (np.array(wall_ns, dtype=np.int64) - due_ns) / 1e6
    if len(late_ms) == 0:
        return Jitter(0, 0.0, 0.0, 0.0, 0.0, 1.0)
    late_ms = late_ms - late_ms.min()
    p50, p99, p999 = np.percentile(late_ms, (50, 99, 99.9))
    share = float(np.mean(late_ms > LATE_MS))
    return Jitter(len(late_ms), float(p50), float(p99), float(p999), float(late_ms.max()), share)
