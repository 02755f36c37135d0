"""The picture of one run: speed over distance, tracking error and notch over time."""

from __future__ import annotations

from pathlib import Path

from railhil.scenarios.model import Scenario
from railhil.supervisor import ato_panels
from railhil.supervisor.report.panels import save
from railhil.supervisor.report.recorded import curves
from railhil.supervisor.report.styles import Style
from railhil.supervisor.score import score
from railhil.supervisor.trace import Trace


def draw(scenario: Scenario, trace: Trace, out: Path) -> None:
    """Draw the run into a file whose bytes depend only on the record (fixed ids, no date)."""
    run = ato_panels.Drawn("train", Style(), curves(scenario, trace), score(scenario, trace))
    save(ato_panels.run_figure(scenario, run), out, scenario.title)
