"""What ``railhil reproduce`` has written, read again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from railhil.charts.figure import Figure
from railhil.reproduce.paper import Measurement, Results


def read_document(found: Mapping[str, Any]) -> tuple[Results, list[Figure]]:
    """The measured runs of a document, and its figures, both without their curves."""
    runs = {run["run"]: Measurement.from_json(run["run"], run) for run in found["runs"]}
    results = Results(tuple(found["seeds"]), runs, found["railhil"])
    return results, [Figure(**one, charts=()) for one in found["figures"]]
