"""``railhil reproduce ipfc``: docs/reproduce/ipfc is what the command writes.

Only the runs in the controller's fixed point are made again: five of the ten.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.paths import ROOT
from hil_tests.support.published import PUBLISHED_SHA256
from hil_tests.support.reproduced import read_document
from railhil.reproduce.comparison import FOLLOWS, FOLLOWS_NOT, OPEN
from railhil.reproduce.document import render_page, write_page
from railhil.reproduce.ipfc import PAPER, USUAL, list_laws
from railhil.reproduce.measurement import measure_paper
from railhil.reproduce.paper import Entry, Results

FOLDER = ROOT / "docs" / "reproduce" / "ipfc"
WRITE = "railhil reproduce ipfc --out docs/reproduce/ipfc writes it"


def plan(seeds: Sequence[int]) -> list[Entry]:
    return [one for one in PAPER.plan(seeds) if one.spec.law.arithmetic == USUAL]


@pytest.fixture(scope="module")
def written() -> dict[str, Any]:
    """The document in the docs."""
    found: dict[str, Any] = json.loads((FOLDER / "results.json").read_text("utf-8"))
    return found


@pytest.fixture(scope="module")
def made() -> Results:
    """The runs in fixed point, with their curves."""
    return measure_paper(replace(PAPER, plan=plan), PAPER.text.seeds, drawn=True)


def test_every_figure_is_there(written: dict[str, Any]) -> None:
    assert [one["name"] for one in written["figures"]] == ["figure_6", "figure_7", "figure_8", "figure_9"]
    table = next(one for one in written["tables"] if one["name"] == "table_2")
    assert len(table["lines"]) == 25
    assert all(line["published"] is not None for line in table["lines"])
    printed = {line["item"]: line["published"] for line in table["lines"] if line["quantity"] == "stop error"}
    assert printed == {"ipfc": 0.0464, "tpfc2": 0.0751, "tpfc1": 0.0835, "tdmc": 0.1127, "fuzzy_pid": 0.1529}


def _as_published(written: dict[str, Any]) -> Results:
    """Runs that come to exactly what Table 2 says."""
    found = read_document(written)[0]
    table = next(one for one in written["tables"] if one["name"] == "table_2")
    keys = {"ITAE": "itae", "energy": "energy_kj", "time error": "punctuality_s", "stop error": "stop_error_m"}
    runs = dict(found.runs)
    for name, run in runs.items():
        law = name.split("-")[0]
        lines = {line["quantity"]: line["published"] for line in table["lines"] if line["item"] == law}
        values = {keys.get(title, title): value for title, value in lines.items()}
        runs[name] = replace(run, values={**run.values, **values})
    return Results(found.seeds, runs)


def test_statements_follow_from_runs_that_come_to_what_is_published(written: dict[str, Any]) -> None:
    said = {one.at: one.verdict for one in PAPER.judge(_as_published(written))}
    assert said.pop("Sect. 3.2, eqs. (23) to (27)") == FOLLOWS_NOT
    assert said.pop("Table 2, comfort and energy of one run") == OPEN
    assert said.pop("Figures 7 and 9") == said.pop("Figure 8") == FOLLOWS_NOT
    assert set(said.values()) == {FOLLOWS}, said
    improvements = PAPER.compare(_as_published(written))[2]
    for line in improvements.lines:
        assert line.published is not None
        assert line.measured[0] is not None
        assert (abs(line.measured[0] - line.published) > 0.1) == bool(line.remark)
    assert [line.remark for line in improvements.lines if line.remark] == ["its own Table 2 gives 71.3"]


def test_a_run_that_never_stops_is_shown(written: dict[str, Any]) -> None:
    """Its scores have no value, and it is the last in every order."""
    found = read_document(written)[0]
    runs = dict(found.runs)
    for name, run in runs.items():
        if name.startswith("ipfc-"):
            runs[name] = replace(run, values=dict.fromkeys(run.values))
    text = render_page(PAPER, Results(found.seeds, runs))
    assert "| stop error | ipfc | m | 0.0464 | - | - | - | - |  |" in text
    assert "fuzzy_pid 2230.4, tdmc 2243.5, ipfc -." in text


@pytest.mark.long
@pytest.mark.slow
def test_the_bench_measures_what_the_page_says(made: Results, written: dict[str, Any]) -> None:
    there = {run["run"]: run for run in written["runs"]}
    assert len(made.runs) == len(list_laws())
    for name, run in made.runs.items():
        assert run.values == there[name]["measured"], name
        assert run.sha256 == there[name]["sha256"]
        assert (run.verdict, list(run.reasons)) == (there[name]["verdict"], there[name]["reasons"])
    assert made.runs["ipfc-iq-0"].sha256 == PUBLISHED_SHA256


@pytest.mark.long
@pytest.mark.slow
def test_figures_are_drawn_from_the_runs(made: Results, written: dict[str, Any], tmp_path: Path) -> None:
    before = read_document(written)[0]
    whole = replace(before, runs={**before.runs, **made.runs})
    first, again = tmp_path / "first", tmp_path / "again"
    for folder in (first, again):
        folder.mkdir()
        write_page(PAPER, whole, PAPER.draw(whole), folder)
    names = sorted(path.name for path in FOLDER.iterdir())
    assert sorted(path.name for path in first.iterdir()) == names
    assert all((first / name).read_bytes() == (again / name).read_bytes() for name in names)
    for name in ("page.md", "results.json"):
        assert (first / name).read_bytes() == (FOLDER / name).read_bytes(), WRITE
    for number in (7, 8, 9):
        drawn = (first / f"figure_{number}.svg").read_text("utf-8")
        assert all(f">{law}<" in drawn for law in list_laws())
