"""The figure of the report: both carts over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

from railhil.report.pictures import Picture, drawing, svg
from two_carts.wire import TRUTH


def pictures(scenario: Any, runs: Sequence[Any]) -> list[Picture]:
    """Positions over time, for all runs that can be drawn."""
    drawn = [run for run in runs if run.can_be_drawn]
    if not drawn:
        return []
    title = "Both carts over time"
    with drawing("none"):
        figure = Figure(figsize=(8.5, 3.0))
        axes = figure.add_axes((0.1, 0.2, 0.88, 0.75))
        for run in drawn:
            time_s = run.trace.times_s(TRUTH.PORT)
            for unit in (1, 2):
                axes.plot(time_s, run.trace.values(TRUTH.PORT, f"TruePos{unit}"), label=f"{run.label} {unit}")
        axes.set(xlabel="time (s)", ylabel="position (m)")
        axes.legend(frameon=False)
        return [Picture("carts", title, "True positions.", svg(figure, "carts", title))]
