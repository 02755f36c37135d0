"""Recorded runs in a cell of a notebook: the verdict, the scores with their units, and the system's first chart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from railhil.charts.figure import Figure
from railhil.charts.notebook import first_chart, html_cell, html_figure, html_paragraph, html_table, html_verdict
from railhil.judge.criteria import Criterion
from railhil.judge.judging import system_pictures

if TYPE_CHECKING:
    from railhil.judge.record import Record

#: Before the title of a score outside its limit.
_MISSED = "✗ "


def run_html(run: Record) -> str:
    """One run."""
    heads = ["score", "value", "unit", "allowed"]
    if run.published is not None:
        heads.append("published")
    criteria = [criterion for criterion in run.judging.criteria if criterion.applies(run.scenario)]
    return html_cell(
        html_verdict(run.verdict, run.title),
        html_paragraph(run.line),
        html_paragraph(run.caution),
        html_table("", heads, [_row(run, criterion) for criterion in criteria], numbers=(1, 4), missed=_MISSED),
        chart_html([run]),
        html_paragraph(run.place),
    )


def _row(run: Record, criterion: Criterion) -> list[str]:
    """Cells of one score."""
    limit, value = criterion.limit_in(run.scenario), run.score.with_sign(criterion)
    sign = "+" if criterion.signed else ""
    row = [
        _MISSED * bool(criterion.missed(run.scenario, value)) + criterion.title,
        criterion.without if value is None else f"{value:{sign}.{criterion.digits}f}",
        criterion.unit_typeset,
        "" if limit is None else criterion.bound(limit),
    ]
    if run.published is not None:
        row.append(criterion.shown(run.published.values.get(criterion.key), criterion.published_digits))
    return row


def chart_html(runs: Sequence[Record]) -> str:
    """The first chart of the system, with all runs of one scenario that can be drawn; empty if none can."""
    found = system_pictures(runs[0].scenario, runs)
    figure = next((one for one in found if isinstance(one, Figure)), None)
    return "" if figure is None else html_figure(first_chart(figure))
