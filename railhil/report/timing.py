"""The timing of runs: words and table rows from ``score.json``, and the figure of real-time runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from railhil.charts.figure import Area, Chart, Curve, Figure
from railhil.common.digits import count_of
from railhil.judge.jitter import LATE_MS, LATE_SHARE_MAX, PLANT
from railhil.judge.record import Record
from railhil.report.styles import styles

HEADINGS = ("law", "cycles", "p50", "p99", "p99.9", "max", f"over {LATE_MS:g} ms", "polls", "missed")
_FIGURES = (("p50", "p50_ms"), ("p99", "p99_ms"), ("p99.9", "p999_ms"), ("max", "max_ms"))
_BY_PLANT = "the plant, at the beginning of each cycle and at each answer"
_BY_RECORDER = (
    "the supervisor, by the arrival of each tick (the plant has left no table here): the transport time counts too, "
    "and an answer that came too late for the plant counts as an answer"
)


def timing_of(run: Record) -> dict[str, Any]:
    """``run.timing`` of a run, empty if there is none."""
    found: dict[str, Any] = run.score_document.get("run", {}).get("timing") or {}
    return found


def jitter_sentence(jitter: Mapping[str, Any]) -> str:
    """Lateness of the cycles in one line."""
    text = ", ".join(f"{name} {jitter[key]:.3f} ms" for name, key in _FIGURES)
    return f"lateness of {count_of(jitter['cycles'], 'cycle')}: {text}"


def answers_sentence(timing: Mapping[str, Any]) -> str:
    """Missed polls, and the latency of the answers per port, in one line."""
    text = f"{timing['missed_polls']} of {count_of(timing['polls'], 'poll')} missed"
    for item in timing["answers"]:
        figures = (f"{name} {item[key]:.3f} ms" for name, key in _FIGURES if key in item)
        text += f"; {item['port']} {', '.join(figures)}"
    return text


def scheduling_sentence(timing: Mapping[str, Any]) -> str:
    """The scheduling granted to each process; processes with the same are named together."""
    roles: dict[str, list[str]] = {}
    for role, sentence in timing["scheduling"].items():
        roles.setdefault(sentence, []).append(role)
    text = "; ".join(f"{' and '.join(names)}: {sentence}" for sentence, names in roles.items())
    return text if "plant" in timing["scheduling"] else f"{text}; plant and controller were started elsewhere"


def timing_rows(document: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Facts on the timing of a run, from its ``score.json``."""
    rows: list[tuple[str, str]] = []
    run = document.get("run", {})
    timing = run.get("timing") or {}
    jitter = document.get("jitter")
    if jitter is None:
        missed = timing.get("missed_polls")
        return [] if missed is None else [("Timing", f"lockstep: no timing, missed polls {missed}")]
    rows.append(("Jitter", jitter_sentence(jitter)))
    if timing.get("lateness"):
        rows.append(("Measured by", _BY_PLANT if timing["source"] == PLANT else _BY_RECORDER))
        if timing.get("pace"):
            rows.append(("Pace", timing["pace"]))
        rows.append(("Answers", answers_sentence(timing)))
        rows.append(("Scheduling", scheduling_sentence(timing)))
    if run:
        rows.append(("Wall time", f"{run['sim_time_s']:.2f} s simulated in {run['wall_time_s']:.2f} s of wall time"))
    return rows


def timed(runs: Sequence[Record]) -> list[Record]:
    """The real-time runs, with their timing."""
    return [run for run in runs if timing_of(run).get("lateness")]


def table(runs: Sequence[Record]) -> list[tuple[str, ...]]:
    """A row per real-time run, cells under :data:`HEADINGS`; empty if all runs were in lockstep."""
    found = []
    for run in timed(runs):
        timing = timing_of(run)
        late = timing["lateness"]
        figures = (f"{late[key]:.3f}" for _, key in _FIGURES)
        counts = (str(timing["polls"]), str(timing["missed_polls"]))
        found.append((run.label, str(late["cycles"]), *figures, f"{late['late_share']:.3%}", *counts))
    return found


#: Labels of the horizontal axis, ms.
_DURATIONS_MS = (0.001, 0.01, 0.1, 1.0, 10.0, 100.0, 1000.0)


def lateness(runs: Sequence[Record]) -> list[Figure]:
    """Number of cycles over lateness with the limit that counts against the run; empty if no run has kept time."""
    curves = []
    for number, (run, style) in enumerate(zip(runs, styles([run.controller for run in runs]), strict=True)):
        if found := timing_of(run).get("histogram"):
            edges_ms, counts = np.array(found["edges_ms"]), np.array(found["counts"], dtype=np.float64)
            stairs = np.append(counts, counts[-1])
            curves.append((edges_ms, Curve(run.label, edges_ms, stairs, style.look, "", True, True, number)))
    if not curves:
        return []
    caption = (
        "How long after its absolute deadline each cycle began, in wall time; both axes are logarithmic. The dotted "
        f"line is {LATE_MS:g} ms: a run with more than {LATE_SHARE_MAX:.1%} of its cycles beyond it is INVALID."
    )
    bounds = min(float(edges[0]) for edges, _ in curves), max(float(edges[-1]) for edges, _ in curves)
    chart = Chart(
        [curve for _, curve in curves],
        "lateness",
        "cycles",
        bounds,
        (0.7, None),
        [Area((LATE_MS, LATE_MS), None, "line", f"{LATE_MS:g} ms")],
        x_names={late_ms: _duration(late_ms) for late_ms in _DURATIONS_MS},
        is_log=True,
        height_px=220,
    )
    return [Figure("lateness", "Lateness of the cycles", caption, [chart])]


def _duration(late_ms: float) -> str:
    return f"{late_ms:g} ms" if late_ms >= 1.0 else f"{late_ms * 1e3:g} µs"
