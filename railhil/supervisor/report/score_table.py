"""The score table: each law measured on this bench, beside the published row of the same law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from railhil.scenarios.model import PublishedScore, Scenario
from railhil.supervisor.report.recorded import RecordedRun
from railhil.supervisor.score import STOP_WITHIN_M, Score


@dataclass(frozen=True, slots=True)
class Column:
    """One score: ``key`` in ``score.json``, title and unit, digits shown of a measured and of a published value.

    ``heading`` is title and unit in two lines for a terminal.
    """

    key: str
    title: str
    unit: str
    digits: int
    published_digits: int
    heading: str


COLUMNS = (
    Column("itae", "ITAE", "km/h s²", 1, 0, "ITAE\nkm/h s2"),
    Column("energy_kj", "energy", "kJ", 0, 0, "energy\nkJ"),
    Column("punctuality_s", "time error", "s", 4, 4, "time\nerror s"),
    Column("stop_error_m", "stop error", "m", 4, 4, "stop\nerror m"),
    Column("comfort", "comfort", "m/s²/km", 3, 3, "comfort\nm/s2/km"),
)


@dataclass(frozen=True, slots=True)
class Cell:
    """A measured value and the published one, as text (empty: none); ``best``: the least measured value of all runs
    that are an evaluation."""

    measured: str
    published: str
    best: bool


@dataclass(frozen=True, slots=True)
class Row:
    """One law: its cells in the order of :data:`COLUMNS`; no verdict when it is only published."""

    label: str
    verdict: str
    cells: tuple[Cell, ...]


def value_of(found: Score | PublishedScore, column: Column) -> float | None:
    """Value of a column, None when the run never got there."""
    value: float | None = getattr(found, column.key)
    return value


def shown(value: float | None, digits: int) -> str:
    """A value with its digits; ``-`` for none."""
    return "-" if value is None else f"{value:.{digits}f}"


def stopped_within(found: Sequence[Score]) -> dict[float, int]:
    """How many of the runs stopped within each of ``STOP_WITHIN_M``; one that never stopped is within none."""
    errors_m = [score.stop_error_m for score in found if score.stop_error_m is not None]
    return {limit: sum(error <= limit for error in errors_m) for limit in STOP_WITHIN_M}


def stops_sentence(found: Sequence[Score]) -> str:
    """:func:`stopped_within` in words."""
    parts = (f"{limit:g} m: {count} of {len(found)}" for limit, count in stopped_within(found).items())
    return f"stopped within {', '.join(parts)}"


def _cell(run: RecordedRun, column: Column, best: str) -> Cell:
    text = shown(value_of(run.score, column), column.digits)
    row = run.published
    is_best = text == best and not run.seed_was_trained
    return Cell(text, shown(value_of(row, column), column.published_digits) if row else "", is_best)


def rows(scenario: Scenario, runs: Sequence[RecordedRun]) -> list[Row]:
    """Rows of the runs in their order, then the published rows of laws that were not run."""
    best = []
    for column in COLUMNS:
        judged = [run.score for run in runs if not run.seed_was_trained]
        values = [value for score in judged if (value := value_of(score, column)) is not None]
        best.append(shown(min(values), column.digits) if len(values) > 1 else "")
    found = [
        Row(run.label, run.verdict, tuple(_cell(run, column, text) for column, text in zip(COLUMNS, best, strict=True)))
        for run in runs
    ]
    run_here = {run.controller for run in runs}
    for row in scenario.published:
        if row.controller not in run_here:
            cells = (Cell("", shown(value_of(row, column), column.published_digits), False) for column in COLUMNS)
            found.append(Row(row.controller, "", tuple(cells)))
    return found
