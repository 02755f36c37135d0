"""The picture of one run: speed over distance, tracking error and notch over time."""

from __future__ import annotations

from pathlib import Path

from railhil.judge.score import score
from railhil.record.trace import Trace
from railhil.report.pictures import save
from railhil.report.recorded import curves
from railhil.report.styles import Style
from railhil.systems.ato import panels as ato_panels
from railhil.systems.ato.scenario.model import Scenario


def draw(scenario: Scenario, trace: Trace, out: Path) -> None:
    """Draw the run into a file whose bytes depend only on the record (fixed ids, no date)."""
    run = ato_panels.Drawn("train", Style(), curves(scenario, trace), score(scenario, trace))
    save(ato_panels.run_figure(scenario, run), out, scenario.title)
