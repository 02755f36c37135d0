"""The picture of one run of a system without a picture of its own: signals over time, one panel for each unit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from railhil.supervisor.report import panels
from railhil.supervisor.signals import drawn_table, signal_units
from railhil.supervisor.trace import Trace

_HEIGHT_IN = 2.2


def draw(scenario: Any, trace: Trace, out: Path) -> None:
    """Draw the signals of ``signals.csv`` into a file whose bytes depend only on the record (fixed ids, no date)."""
    header, rows = drawn_table(scenario, trace)
    by_unit: dict[str, list[int]] = {}
    for column, unit in enumerate(signal_units(scenario, trace).values()):
        by_unit.setdefault(unit, []).append(column)
    time_s, by_unit["s"] = rows[:, 0], by_unit["s"][1:]
    shown = {unit: columns for unit, columns in by_unit.items() if columns}
    with panels.drawing():
        figure = Figure(figsize=(8.5, 0.8 + _HEIGHT_IN * len(shown)), layout="constrained")
        stacked = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
        for axes, (unit, columns) in zip(stacked, shown.items(), strict=True):
            for column in columns:
                axes.plot(time_s, rows[:, column], label=header[column], linewidth=1)
            axes.set(ylabel=unit)
            panels.legend(axes)
        figure.suptitle(scenario.title)
        stacked[-1].set(xlabel="time (s)")
        figure.align_ylabels(list(stacked))
        figure.savefig(out, metadata={"Date": None} if out.suffix == ".svg" else None)
