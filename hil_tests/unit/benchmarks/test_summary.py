"""The command that prints the first table of docs/benchmarks.md."""

from __future__ import annotations

import pytest

from benchmarks.figures import MeasurementError
from benchmarks.summary import ROWS, cell
from hil_tests.support.paths import ROOT


def _document(value: float) -> dict[str, object]:
    figures = [{"name": figure, "value": value} for _, figure in ROWS.values()]
    return {"benchmarks": {benchmark: {"figures": figures} for benchmark, _ in ROWS.values()}}


def test_a_cell_has_median_and_range() -> None:
    documents = [_document(value) for value in (0.36, 1.03, 0.65)]
    assert {cell(documents, *where) for where in ROWS.values()} == {"0.65 (0.36 to 1.03)"}
    with pytest.raises(MeasurementError, match="has no figure 'first byte'"):
        cell(documents, "start_and_end", "first byte")


def test_its_figures_are_those_of_the_benchmarks() -> None:
    """By the names in the output that the page holds; a figure by another name would be noticed after minutes only."""
    page = (ROOT / "docs/benchmarks.md").read_text(encoding="utf-8")
    for _, figure in ROWS.values():
        assert figure in page, figure
