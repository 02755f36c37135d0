"""Prints scores together with the published ones."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from railhil.common.output import Output, table
from railhil.judge.judging import judging_of
from railhil.judge.score import Score
from railhil.report.tables import published_text
from railhil.scenarios.model import AnyScenario, watch_sentence

#: Below this width columns are separated by one space, so that no number is truncated.
_TIGHT_COLUMNS = 66
_COLOURS = {"PASS": "bold green", "FAIL": "bold red"}


def score_table(scenario: AnyScenario, found: Sequence[tuple[str, Score]], tight: bool = False) -> Table:
    """Measured scores by label, then the rows of the published table (time and stop error without sign, as
    published)."""
    rows, criteria = table(tight), judging_of(scenario).criteria
    rows.add_column("")
    for criterion in criteria:
        rows.add_column(criterion.heading, justify="right", no_wrap=True)
    for label, score in found:
        values = (criterion.shown(score.values[criterion.key]) for criterion in criteria)
        rows.add_row(label, *values, style="bold")
    for row in scenario.published:
        values = (published_text(row, criterion) for criterion in criteria)
        rows.add_row(f"{row.controller} (published)", *values)
    return rows


def print_scores(console: Output, scenario: AnyScenario, found: Sequence[tuple[str, Score]]) -> None:
    """Title and table of completed runs, nothing if there are none; then the stops of runs with several."""
    if any(value is not None for _, score in found for value in score.values.values()):
        console.say(scenario.title, style="italic")
        console.print(score_table(scenario, found, tight=console.width < _TIGHT_COLUMNS))
    for label, score in found:
        for stop in score.listed_stops:
            error = "" if stop.error_m is None else f" {stop.error_m:+.4f} m"
            console.say(f"{label}: stop {stop.planned.name}{error} {stop.verdict}")


def print_watch(console: Output, scenario: AnyScenario) -> None:
    """One line if the scenario's watches are weaker than usual, which makes the verdict less meaningful."""
    if sentence := watch_sentence(scenario):
        console.say(sentence, style="bold yellow")


def print_verdict(console: Output, verdict: str, line: str) -> None:
    """One line: the verdict and its reason."""
    console.say(f"{verdict}: {line}" if line else verdict, style=_COLOURS.get(verdict, "bold yellow"))
