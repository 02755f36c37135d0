"""The picture of one run: speed over distance, tracking error and notch over time."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from railhil.scenarios.model import Scenario
from railhil.supervisor.report import panels
from railhil.supervisor.report.recorded import curves
from railhil.supervisor.report.styles import Style
from railhil.supervisor.score import score
from railhil.supervisor.trace import Trace


def draw(scenario: Scenario, trace: Trace, out: Path) -> None:
    """Draw the run into a file whose bytes depend only on the record (fixed ids, no date)."""
    run = panels.Drawn("train", Style(), curves(scenario, trace), score(scenario, trace))
    with panels.drawing():
        figure = Figure(figsize=(8.5, 7.0), layout="constrained")
        track, error, notch = figure.subplots(3, 1, height_ratios=(2.2, 1, 1))
        panels.speed_over_distance(track, scenario, [run])
        track.set(xlabel="distance (m)", title=scenario.title)
        track.legend(loc="lower center", ncols=3, frameon=False, markerscale=0)
        panels.speed_error(error, run)
        error.set(ylabel="speed error\n(km/h)")
        panels.notch(notch, run)
        notch.set(xlabel="time (s)", ylabel="notch")
        for axes in (error, notch):
            panels.time_axis(axes, scenario)
        figure.align_ylabels([track, error, notch])
        metadata = {"Date": None} if out.suffix == ".svg" else None
        figure.savefig(out, metadata=metadata)
