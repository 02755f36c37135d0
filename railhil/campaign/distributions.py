"""The distributions of the scores of a campaign as a figure, for its report and for notebooks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pyarrow as pa

from railhil.campaign.rows import column_of, rows_of
from railhil.charts.figure import Figure
from railhil.judge.criteria import Criterion, limit_key
from railhil.report.distribution import Spread, bounds_of, picture
from railhil.report.styles import styles
from railhil.study.table import numbers


def distributions(summary: Mapping[str, Any], criteria: Sequence[Criterion], table: pa.Table) -> Figure:
    """A chart for each score, with a curve for each law.

    :param summary: content of ``summary.json``.
    :param table: rows of ``results.parquet``.
    """
    laws = summary["laws"]
    looks = dict(zip(laws, styles([law["controller"] for law in laws.values()]), strict=True))
    rows = {label: rows_of(table, label) for label in laws}
    spreads = [
        Spread(
            criterion,
            bounds_of(criterion, summary["limits"].get(limit_key(criterion))),
            {label: numbers(own, column_of(criterion)) for label, own in rows.items()},
        )
        for criterion in criteria
    ]
    return picture(spreads, looks)
