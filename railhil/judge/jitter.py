"""Timing of a run: lateness of the cycles, latency of the answers, missed polls.

It is measured by the plant, which has the deadlines and writes ``timing.csv`` to the run folder. Without that file (a
plant that was started elsewhere, or was killed) the arrivals of the ticks at the recorder are used instead. They are
later and less even than the ticks themselves, and do not show whether an answer was too late for the plant.
"""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.bus.clock import RATE_MAX_10TH, RATE_MIN_10TH, rate_to_10th
from railhil.common.digits import count_of, text_beside_limit
from railhil.record.run_folder import TIMING
from railhil.record.trace import Trace

#: Name in the run folder: the arrivals at the recorder.
WALL = "wall.csv"
#: A run with more than this share of its cycles more than ``LATE_MS`` late is INVALID.
LATE_SHARE_MAX = 0.001
LATE_MS = 5.0
#: A run with one cycle this late is also INVALID: in a long run a single pause of the host would be too small a share.
#: A pause of 200 ms (fault K2) makes the next cycle late by 200 ms less the rest of its tick, of up to 50 ms here.
PAUSE_MS = 150.0
#: Bins of the histogram in ms, five per decade; values outside are counted in the first or last bin.
EDGES_MS: tuple[float, ...] = tuple(float(f"{10 ** (step / 5):.3g}") for step in range(-15, 16))
#: Source of the measurement.
PLANT, RECORDER, NOBODY = "plant", "supervisor", "none"
_TICK = "tick"
Milliseconds: TypeAlias = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Jitter:
    """Lateness of cycles against absolute deadlines, in ms; ``histogram`` counts them in the bins of ``EDGES_MS``."""

    cycles: int
    p50_ms: float
    p99_ms: float
    p999_ms: float
    max_ms: float
    late_share: float
    histogram: tuple[int, ...] = ()

    @property
    def valid(self) -> bool:
        """Whether the timing is good enough for a verdict."""
        return self.late_share <= LATE_SHARE_MAX and self.max_ms < PAUSE_MS

    def sentence(self) -> str:
        """Reason for which the timing is not good enough."""
        if self.late_share > LATE_SHARE_MAX:
            share = text_beside_limit(100 * self.late_share, 100 * LATE_SHARE_MAX, 2)
            cycles = count_of(self.cycles, "cycle")
            return f"timing: {share}% of {cycles} more than {LATE_MS:g} ms late, allowed {LATE_SHARE_MAX:.1%}"
        late = text_beside_limit(self.max_ms, PAUSE_MS, 0)
        return f"timing: a cycle {late} ms late, allowed less than {PAUSE_MS:g} ms"

    def as_json(self) -> dict[str, Any]:
        """Figures without the histogram."""
        return {key: value for key, value in asdict(self).items() if key != "histogram"}


@dataclass(frozen=True, slots=True)
class Answers:
    """Polls of one port: their number, the number without an answer in time, and the latency of the others, in ms."""

    port: str
    polls: int
    missed: int
    p50_ms: float
    p99_ms: float
    max_ms: float


@dataclass(frozen=True, slots=True)
class RunTiming:
    """Timing of a run. ``source`` names the measuring node; in lockstep there are no deadlines and no measurement.

    ``answers`` are known only to the plant; ``scheduling`` has the scheduling granted to each process, by role.
    ``pace``: a sentence if the plant kept a pace other than the requested one, else empty.
    """

    source: str
    polls: int
    missed_polls: int
    jitter: Jitter | None = None
    arrivals: Jitter | None = None
    answers: tuple[Answers, ...] = ()
    scheduling: Mapping[str, str] = field(default_factory=dict)
    pace: str = ""

    def as_json(self) -> dict[str, Any]:
        """``run.timing`` of ``score.json``."""
        document: dict[str, Any] = {"source": self.source, "polls": self.polls, "missed_polls": self.missed_polls}
        if self.jitter is None:
            return document
        document["lateness"] = self.jitter.as_json()
        document["histogram"] = {"edges_ms": list(EDGES_MS), "counts": list(self.jitter.histogram)}
        document["arrivals"] = None if self.arrivals is None else self.arrivals.as_json()
        document["answers"] = [asdict(answers) for answers in self.answers]
        document["scheduling"] = dict(self.scheduling)
        if self.pace:
            document["pace"] = self.pace
        return document


def jitter_from(late_ms: Milliseconds) -> Jitter:
    """Jitter of cycles with these latenesses, shape (n,). Without any cycle the timing is not good enough for a
    verdict."""
    if len(late_ms) == 0:
        return Jitter(0, 0.0, 0.0, 0.0, 0.0, 1.0, (0,) * (len(EDGES_MS) - 1))
    p50, p99, p999 = np.percentile(late_ms, (50, 99, 99.9))
    counts, _ = np.histogram(np.clip(late_ms, EDGES_MS[0], EDGES_MS[-1]), EDGES_MS)
    return Jitter(
        cycles=len(late_ms),
        p50_ms=float(p50),
        p99_ms=float(p99),
        p999_ms=float(p999),
        max_ms=float(late_ms.max()),
        late_share=float(np.mean(late_ms > LATE_MS)),
        histogram=tuple(map(int, counts)),
    )


def write_wall_times(ticks: array[int], wall_ns: array[int], out: Path) -> None:
    """Write the additional file of a real-time run: arrival of each tick in ns of wall time since the first."""
    rows = np.column_stack([np.array(ticks, dtype=np.int64), np.array(wall_ns, dtype=np.int64)])
    rows[:, 1] -= rows[0, 1] if len(rows) else 0
    np.savetxt(out, rows, fmt="%d", delimiter=",", header="tick,wall_ns", comments="")


def kept_pace(asked: float, told: float) -> tuple[float, str]:
    """Pace of the ticks in simulated seconds per wall second, and a sentence if it is not the requested one.

    :param asked: the exact pace given to this command.
    :param told: pace from TIME_SYNC, in tenths (:func:`railhil.bus.clock.rate_to_10th`); 0: none.
    """
    asked_10th, told_10th = rate_to_10th(asked), round(told * 10)
    if told_10th in (0, asked_10th):
        return asked, ""
    end = {RATE_MIN_10TH: " or slower", RATE_MAX_10TH: " or faster"}.get(told_10th, "")
    return told, f"pace of the plant: {told:g}{end} as TIME_SYNC says in tenths, not {asked:g} (--rate)"


def arrivals_of(ticks: Sequence[int], wall_ns: Sequence[int], tick_ns: float) -> Jitter:
    """Jitter of the arrivals of ticks that are ``tick_ns`` of wall time apart; the earliest one defines zero."""
    late_ms = (np.array(wall_ns, dtype=np.int64) - np.array(ticks, dtype=np.int64) * tick_ns) / 1e6
    return jitter_from(late_ms - late_ms.min() if len(late_ms) else late_ms)


def plant_timing(path: Path) -> tuple[Jitter, tuple[Answers, ...]] | None:
    """Lateness and answers as written by the plant; None if there is no complete table."""
    found: dict[str, list[int]] = {_TICK: []}
    try:
        lines = path.read_text(encoding="ascii").splitlines()
        for line in lines[1:]:
            _, event, ns = line.split(",")
            found.setdefault(event, []).append(int(ns))
    except (OSError, ValueError):
        # The process that writes it may have been killed; then the arrivals are used instead.
        return None
    late_ms = np.array(found.pop(_TICK), dtype=np.float64) / 1e6
    return jitter_from(late_ms), tuple(_answers(port, np.array(taken_ns)) for port, taken_ns in sorted(found.items()))


def _answers(port: str, taken_ns: npt.NDArray[np.int64]) -> Answers:
    """Statistics of one port's polls; a latency below zero means a missed poll."""
    answered_ms = taken_ns[taken_ns >= 0] / 1e6
    p50, p99 = np.percentile(answered_ms, (50, 99)) if len(answered_ms) else (0.0, 0.0)
    longest_ms = float(answered_ms.max()) if len(answered_ms) else 0.0
    return Answers(port, len(taken_ns), int(np.sum(taken_ns < 0)), float(p50), float(p99), longest_ms)


def lockstep_timing(trace: Trace) -> RunTiming:
    """Timing of a lockstep run, without deadlines."""
    return RunTiming(NOBODY, trace.polls, trace.missed_polls)


def realtime_timing(
    folder: Path, trace: Trace, arrivals: Jitter, scheduling: Mapping[str, str], pace: str = ""
) -> RunTiming:
    """Timing of a real-time run, from the plant's table in ``folder`` or else from the arrivals at the recorder."""
    measured = plant_timing(folder / TIMING)
    if measured is None:
        return RunTiming(RECORDER, trace.polls, trace.missed_polls, arrivals, arrivals, (), scheduling, pace)
    jitter, answers = measured
    polls, missed = sum(item.polls for item in answers), sum(item.missed for item in answers)
    return RunTiming(PLANT, polls, missed, jitter, arrivals, answers, scheduling, pace)
