"""Additional lines for the figures of a run: what its scenario assumes, and what to try after a FAIL."""

from __future__ import annotations

from pathlib import Path

from railhil.judge.judging import judging_of
from railhil.record.hash_list import REPORT
from railhil.report.recorded import RecordedRun
from railhil.scenarios.model import AnyScenario


def assumed(scenario: AnyScenario, folder: Path, verbose: bool) -> list[str]:
    """The scenario's choices where its sources give no value: one summary line, or all of them.

    :param folder: the run folder; its report lists them.
    """
    sentences = scenario.assumptions
    if verbose or not sentences:
        return [f"assumed: {sentence}" for sentence in sentences]
    where = f"listed in {folder / REPORT}" if (folder / REPORT).is_file() else f"railhil scenarios {scenario.name}"
    return [f"assumed: {len(sentences)} choices of the scenario that its sources leave open ({where}, or --verbose)"]


def next_step(run: RecordedRun, folder: Path) -> str:
    """What to try after a FAIL, depending on the cause; empty for other verdicts and for a foreign controller."""
    certificate = run.certificate
    if run.verdict != "FAIL" or certificate.get("foreign") or certificate.get("attached"):
        return ""
    if advice := judging_of(run.scenario).advice(run, folder):
        return advice
    shown = folder / REPORT
    return f"next: {shown} shows where" if shown.is_file() else f"next: railhil report {folder} draws the run"
