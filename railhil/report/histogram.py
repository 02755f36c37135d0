"""The timing figure of real-time runs: histogram of the cycles' lateness."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from railhil.charts.figure import Area, Chart, Curve, Figure
from railhil.judge.jitter import LATE_MS, LATE_SHARE_MAX
from railhil.report.jitter_panel import timing_of
from railhil.report.recorded import RecordedRun
from railhil.report.styles import styles

#: Labels of the horizontal axis, ms.
_DURATIONS_MS = (0.001, 0.01, 0.1, 1.0, 10.0, 100.0, 1000.0)


def lateness(runs: Sequence[RecordedRun]) -> list[Figure]:
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
