"""Printing a score beside the published ones."""

from __future__ import annotations

from pathlib import Path

from rich.table import Table

from scenarios.model import Scenario
from supervisor.cli.output import Output, table
from supervisor.run import RunOptions, RunResult
from supervisor.score import Score

_COLUMNS = ("ITAE\nkm/h s2", "energy\nkJ", "time\nerror s", "stop\nerror m", "comfort\nm/s2/km")
#: Below this width the columns stand one blank apart, so that no number is cut.
_TIGHT_COLUMNS = 66
_COLOURS = {"PASS": "bold green", "FAIL": "bold red"}


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def score_table(scenario: Scenario, found: Score, label: str, tight: bool = False) -> Table:
    """Measured scores, then the rows of the published table (time and stop error without sign, as published)."""
    rows = table(tight)
    rows.add_column("", no_wrap=True)
    for title in _COLUMNS:
        rows.add_column(title, justify="right", no_wrap=True)
    rows.add_row(
        label,
        _number(found.itae, 1),
        _number(found.energy_kj, 0),
        _number(found.punctuality_s, 4),
        _number(found.stop_error_m, 4),
        _number(found.comfort, 3),
        style="bold",
    )
    for row in scenario.published:
        rows.add_row(
            f"{row.controller} (published)",
            _number(row.itae, 0),
            _number(row.energy_kj, 0),
            _number(row.punctuality_s, 4),
            _number(row.stop_error_m, 4),
            _number(row.comfort, 3),
        )
    return rows


def print_score(console: Output, scenario: Scenario, found: Score, label: str) -> None:
    """Title and table of a run that came to its end; nothing for one that did not."""
    if found.itae is not None:
        console.say(scenario.title, style="italic")
        console.print(score_table(scenario, found, label, tight=console.width < _TIGHT_COLUMNS))


def print_verdict(console: Output, verdict: str, line: str) -> None:
    """One line: verdict and why."""
    console.say(f"{verdict}: {line}" if line else verdict, style=_COLOURS.get(verdict, "bold yellow"))


def print_result(console: Output, scenario: Scenario, result: RunResult, options: RunOptions, folder: Path) -> None:
    """Table, run facts, verdict."""
    verdict = result.score.verdict if result.exit_code in (0, 1) else "INVALID"
    print_score(console, scenario, result.score, f"{options.controller} {options.arithmetic} (measured)")
    for sentence in scenario.assumptions:
        console.say(f"assumed: {sentence}", style="dim")
    console.say(
        f"{result.sim_time_s:.2f} s simulated in {result.wall_time_s:.2f} s = {result.speed_factor:.0f} times "
        f"real time, {result.frames} frames on {result.transport}, first frame after {result.first_frame_s:.2f} s"
    )
    if result.jitter is not None:
        jitter = result.jitter
        console.say(
            f"lateness of {jitter.cycles} cycles: p50 {jitter.p50_ms:.3f} ms, p99 {jitter.p99_ms:.3f} ms, "
            f"p99.9 {jitter.p999_ms:.3f} ms, max {jitter.max_ms:.3f} ms"
        )
    if result.telemetry is not None:
        console.say(f"arithmetic: {result.telemetry.sentence()}")
    console.say(f"frames.log sha256 {result.frames_sha256}")
    console.say(f"run folder {folder}")
    print_verdict(console, verdict, result.line)
