"""The result of ``railhil reproduce`` as one JSON document, and the measured runs of such a document."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from typing import Any

from railhil.reproduce.paper import Line, Measured, Paper, Planned, Results, Table


@dataclass(frozen=True, slots=True)
class Shown:
    """A picture beside the page, ``name``.svg."""

    name: str
    title: str
    caption: str


def document(paper: Paper, results: Results, pictures: Sequence[Shown] = ()) -> dict[str, Any]:
    """Runs, tables and statements of a paper, and the pictures that stand beside the document."""
    return {
        "paper": paper.name,
        "title": paper.title,
        "source": paper.source,
        "railhil": version("railhil"),
        "protocol": list(paper.protocol),
        "seeds": list(results.seeds),
        "runs": [
            _run(planned, results.runs[planned.key])
            for planned in paper.planned(results.seeds)
            if planned.key in results.runs
        ],
        "tables": [_table(table) for table in paper.tables(results)],
        "statements": [asdict(statement) for statement in paper.statements(results)],
        "figures": [asdict(picture) for picture in pictures],
    }


def _run(planned: Planned, found: Measured) -> dict[str, Any]:
    return {
        "run": found.key,
        "again": planned.again,
        "verdict": found.verdict,
        "reasons": list(found.reasons),
        "sha256": found.sha256,
        "measured": dict(found.values),
    }


def _table(table: Table) -> dict[str, Any]:
    return {
        "name": table.name,
        "title": table.title,
        "note": table.note,
        "lines": [_line(table, line) for line in table.lines],
    }


def _line(table: Table, line: Line) -> dict[str, Any]:
    return {
        "quantity": line.quantity,
        "item": line.item,
        "unit": line.unit,
        "published": line.published,
        "measured": dict(zip(table.columns, line.measured, strict=True)),
        "ratio": dict(zip(table.columns, line.ratios, strict=True)) if table.with_ratio else {},
        "remark": line.remark,
    }


def results_of(found: Mapping[str, Any]) -> Results:
    """The measured runs of a document made by :func:`document`, without their curves."""
    runs = {
        run["run"]: Measured(run["run"], run["verdict"], tuple(run["reasons"]), run["sha256"], run["measured"])
        for run in found["runs"]
    }
    return Results(tuple(found["seeds"]), runs)


def pictures_of(found: Mapping[str, Any]) -> list[Shown]:
    """The pictures of a document made by :func:`document`."""
    return [Shown(**one) for one in found["figures"]]
