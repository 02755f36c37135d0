"""The figures of a run over a line: train graph, speed over distance, stops, energy, approaches."""

from __future__ import annotations

from collections.abc import Sequence

from railhil.charts.figure import Figure
from railhil.judge.record import Record
from railhil.report.styles import styles
from railhil.systems.line.panels.drawn import DrawnRun
from railhil.systems.line.panels.over_distance import approaches, speed
from railhil.systems.line.panels.stops import energy, stop_errors
from railhil.systems.line.panels.train_graph import train_graph
from railhil.systems.line.scenario.model import LineScenario


def pictures(scenario: LineScenario, runs: Sequence[Record]) -> list[Figure]:
    """All figures, in reading order; empty if no run can be drawn."""
    looks = styles([run.controller for run in runs])
    drawn = [
        DrawnRun(run.label, style, number, scenario, run, len(runs) > 1)
        for number, (run, style) in enumerate(zip(runs, looks, strict=True))
        if run.can_be_drawn
    ]
    if not drawn:
        return []
    return [
        train_graph(scenario, drawn),
        speed(scenario, drawn),
        stop_errors(scenario, drawn),
        *energy(scenario, drawn),
        approaches(scenario, drawn),
    ]
