"""The notebooks of docs/examples: each cell runs, and shows what its text says."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.paths import ROOT

NOTEBOOKS = sorted((ROOT / "docs" / "examples").glob("*.ipynb"))


def cells_of(path: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return found


def shown_by(cell: dict[str, Any], names: dict[str, Any]) -> object:
    """Run a cell as a notebook does; returns the value of its last expression, None if it ends otherwise.

    :param names: of the notebook so far.
    """
    body = ast.parse("".join(cell["source"])).body
    last = body.pop() if isinstance(body[-1], ast.Expr) else None
    exec(compile(ast.Module(body, []), "cell", "exec"), names)  # noqa: S102 - a cell of our own
    if last is None:
        return None
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names)  # noqa: S307 - a cell of our own


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_every_cell_runs_and_shows_something(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "__main__"}
    shown = [shown_by(cell, names) for cell in cells_of(path) if cell["cell_type"] == "code"]
    assert None not in shown
    pictures = [one._repr_html_() for one in shown if hasattr(one, "_repr_html_")]
    assert len(pictures) >= 3
    assert "PASS" in pictures[0]
    assert names["broken"].why.startswith("SERVICE BRAKE")
    assert next(event.level for event in names["broken"].events if event.source == "controller") == "hold"


def test_notebooks_are_stored_without_outputs() -> None:
    assert NOTEBOOKS
    for path in NOTEBOOKS:
        for cell in cells_of(path):
            assert not cell.get("outputs"), path
            assert cell.get("execution_count") is None, path
