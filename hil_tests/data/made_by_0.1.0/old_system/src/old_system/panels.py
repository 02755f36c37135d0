"""The figure of the report: the position of the cart over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

from railhil.supervisor.report.figures import Picture, svg
from railhil.supervisor.report.panels import drawing

from old_system.wire import TRUTH


def pictures(scenario: Any, runs: Sequence[Any]) -> list[Picture]:
    """True position over time, for all runs that can be drawn."""
    drawn = [run for run in runs if run.can_be_drawn]
    if not drawn:
        return []
    title = "The cart over time"
    with drawing("none"):
        figure = Figure(figsize=(8.5, 3.0))
        axes = figure.add_axes((0.1, 0.2, 0.88, 0.75))
        for run in drawn:
            axes.plot(run.trace.times_s(TRUTH.PORT), run.trace.values(TRUTH.PORT, "TruePos"), label=run.label)
        axes.set(xlabel="time (s)", ylabel="position (m)")
        axes.legend(frameon=False)
        return [Picture("cart", title, "True position.", svg(figure, "cart", title))]
