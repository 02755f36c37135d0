"""The picture of one run of a system without a picture of its own: its signals over time, as in the page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from railhil.charts.figure import Figure
from railhil.record.trace import Trace
from railhil.report.over_time import signal_charts
from railhil.report.pictures import save


def draw(scenario: Any, trace: Trace, out: Path) -> None:
    """Draw the signals of ``signals.csv`` into a file whose bytes depend only on the record (fixed ids, no date)."""
    save(Figure("signals", scenario.title, "", signal_charts(scenario, trace)), out, scenario.title)
