"""Printing a score beside the published ones."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.table import Table

from scenarios.model import Scenario
from supervisor.run import RunOptions, RunResult
from supervisor.score import Score


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def score_table(scenario: Scenario, found: Score, label: str) -> Table:
    """Measured scores, then the rows of the published table."""
    table = Table("", title=scenario.title)
    for title in ("ITAE km/h s2", "energy kJ", "punctuality s", "stop error m", "comfort m/s2/km"):
        table.add_column(title, justify="right")
    table.add_row(
        label,
        _number(found.itae, 1),
        _number(found.energy_kj, 0),
        _number(found.punctuality_s, 4),
        _number(found.stop_error_m, 4),
        _number(found.comfort, 3),
        style="bold",
    )
    for row in scenario.published:
        table.add_row(
            f"{row.controller} (published)",
            _number(row.itae, 0),
            _number(row.energy_kj, 0),
            _number(row.punctuality_s, 4),
            _number(row.stop_error_m, 4),
            _number(row.comfort, 3),
        )
    return table


def print_verdict(console: Console, verdict: str, line: str) -> None:
    """One line: verdict and why."""
    colour = {"PASS": "green", "FAIL": "red"}.get(verdict, "yellow")
    reason = f": {line}" if line else ""
    console.print(f"[{colour} bold]{verdict}[/]{reason}", highlight=False, soft_wrap=True)


def print_result(console: Console, scenario: Scenario, result: RunResult, options: RunOptions, folder: Path) -> None:
    """Table, run facts, verdict."""
    verdict = result.score.verdict if result.exit_code in (0, 1) else "INVALID"
    if result.score.itae is not None:
        console.print(score_table(scenario, result.score, f"{options.controller} {options.arithmetic} (measured)"))
    for sentence in scenario.assumptions:
        console.print(f"assumed: {sentence}", highlight=False, style="dim", soft_wrap=True)
    console.print(
        f"{result.sim_time_s:.2f} s simulated in {result.wall_time_s:.2f} s = {result.speed_factor:.0f} times real time, "
        f"{result.frames} frames on {result.transport}, first frame after {result.first_frame_s:.2f} s",
        highlight=False,
        soft_wrap=True,
    )
    if result.jitter is not None:
        jitter = result.jitter
        console.print(
            f"lateness of {jitter.cycles} cycles: p50 {jitter.p50_ms:.3f} ms, p99 {jitter.p99_ms:.3f} ms, "
            f"p99.9 {jitter.p999_ms:.3f} ms, max {jitter.max_ms:.3f} ms",
            highlight=False,
            soft_wrap=True,
        )
    console.print(f"frames.log sha256 {result.frames_sha256}", highlight=False, soft_wrap=True)
    console.print(f"run folder {folder}", highlight=False, soft_wrap=True)
    print_verdict(console, verdict, result.line)
