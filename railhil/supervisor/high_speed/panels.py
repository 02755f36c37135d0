"""Figures of the report of a high-speed train."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

from railhil.supervisor.high_speed.ride import Ride
from railhil.supervisor.report.figures import Picture, svg
from railhil.supervisor.report.panels import drawing

_SIZE_IN = (8.5, 4.2)


def pictures(scenario: Any, runs: Sequence[Any]) -> list[Picture]:
    """Speed and error over distance, for all runs that can be drawn."""
    drawn = [run for run in runs if run.can_be_drawn]
    if not drawn:
        return []
    title = "Speed and error over distance"
    with drawing("none"):
        figure = Figure(figsize=_SIZE_IN)
        upper, lower = figure.add_axes((0.09, 0.5, 0.89, 0.45)), figure.add_axes((0.09, 0.12, 0.89, 0.3))
        for index, run in enumerate(drawn):
            ride = Ride.of(run.scenario, run.trace)
            place_km = ride.position_m / 1000.0
            if index == 0:
                upper.plot(place_km, ride.target_mps * 3.6, color="0.5", label="target")
            upper.plot(place_km, ride.speed_mps * 3.6, label=run.label)
            lower.plot(place_km, ride.error_kmh, label=run.label)
        upper.set(ylabel="speed (km/h)")
        lower.set(xlabel="position (km)", ylabel="error (km/h)")
        upper.legend(frameon=False)
        return [Picture("speed", title, "True speed; the error is speed less target.", svg(figure, "speed", title))]
