"""``railhil reproduce``: what it prints and writes of a paper with short runs, and what it refuses."""

from __future__ import annotations

import csv
import json
import pickle
import sys
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT
from hil_tests.support.reproduced import read_document
from hil_tests.support.short_paper import PAPERS, SHORT
from railhil.common.errors import InputError
from railhil.reproduce.__main__ import arguments, main
from railhil.reproduce.comparison import FOLLOWS_NOT, OPEN, Line, Table, find_least, rank_names
from railhil.reproduce.document import (
    format_seeds,
    make_document,
    render_csv,
    render_page,
    render_parameters,
)
from railhil.reproduce.ipfc import ADAPTED, CHATTER, RMS_ERROR
from railhil.reproduce.paper import PAPERS as SHIPPED
from railhil.reproduce.paper import Measurement, Results, find_paper
from railhil.run.make import NeverBegan
from railhil.scenarios.load import load_any
from railhil.scenarios.system import system_named
from railhil.systems.ato.judge.criteria import CRITERIA

IPFC = {"ipfc": SHIPPED["ipfc"]}


def test_without_a_paper_all_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert "ipfc" in capsys.readouterr().out
    assert main(["--json"]) == 0
    assert [one["paper"] for one in json.loads(capsys.readouterr().out)] == list(SHIPPED)


def test_each_paper_has_the_name_by_which_it_is_found() -> None:
    for name in SHIPPED:
        paper = find_paper(name)
        assert paper.name == name
        keys = [one.key for one in paper.plan(paper.text.seeds)]
        assert len(set(keys)) == len(keys) > 0


@pytest.mark.slow
def test_each_run_of_a_paper_has_its_scenario_and_its_law() -> None:
    specs = [one.spec for paper in map(find_paper, SHIPPED) for one in paper.plan(paper.text.seeds)]
    for scenario, law in {(spec.scenario, spec.law.controller) for spec in specs}:
        system_named(load_any(scenario).system).check_law(law, scenario, "law")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["ipcf"], "argument PAPER: found ipcf, allowed ipfc (did you mean ipfc?)"),
        (["ipfc", "--seeds", "1,1"], "argument --seeds: found 1,1, allowed each seed once"),
        (["ipfc", "--seeds", "1,x"], "argument --seeds: found 1,x, allowed seeds and ranges like 0-7,20"),
        (["ipfc", "--seeds", "0-1000"], "argument --seeds: found 0-1000, allowed seeds and ranges like 0-7,20"),
        (["ipfc", "--seeds", "7-5"], "argument --seeds: found 7-5, allowed seeds and ranges like 0-7,20"),
        (["ipfc", "--jobs", "0"], "argument --jobs: found 0"),
    ],
)
def test_usage(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main(words, IPFC)
    assert end.value.code == 2
    assert said in capsys.readouterr().err


def test_seeds_may_be_ranges() -> None:
    assert arguments().parse_args(["ipfc", "--seeds", "3, 7-9,1"]).seeds == (3, 7, 8, 9, 1)
    seeds = range(5, 15)
    assert format_seeds(seeds, ",", "-") == "5-14"
    assert format_seeds(seeds[:-1], ",", "-") == "5,6,7,8,9,10,11,12,13"
    assert format_seeds([*seeds, 20], ", ", " to ") == "5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 20"


def test_options_without_what_they_need(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"--out: used only with a paper: one of ipfc"):
        main(["--out", str(tmp_path)], IPFC)
    with pytest.raises(InputError, match=r"--keep-runs: used only with --out DIR"):
        main(["ipfc", "--keep-runs"])
    (tmp_path / "runs").mkdir()
    with pytest.raises(InputError, match=r"--keep-runs: found .*runs', allowed a folder without runs"):
        main(["ipfc", "--keep-runs", "--out", str(tmp_path)])
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match=r"--out: the folder .*file cannot be written"):
        main(["ipfc", "--out", str(tmp_path / "file")])


def test_completion_knows_the_papers() -> None:
    action = next(one for one in arguments()._actions if one.dest == "paper")
    assert list(action.choices or ()) == list(SHIPPED)


@pytest.mark.slow
def test_a_short_paper_is_run_printed_and_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first, again = tmp_path / "first", tmp_path / "again"
    assert main(["short", "--out", str(first), "--keep-runs", "--jobs", "1", "--seeds", "3,4"], PAPERS) == 0
    said = capsys.readouterr()
    assert "does not follow: Table 1: it takes 100 kJ." in said.out
    assert "1 of 2: run-3" in said.err
    assert (first / "runs" / "run-4" / "certificate.json").is_file()
    # In processes of their own, and as JSON: the same.
    assert main(["short", "--out", str(again), "--jobs", "2", "--seeds", "3,4", "--json"], PAPERS) == 0
    found = json.loads(capsys.readouterr().out)
    names = ["figure_1.svg", "page.md", "results.json", "table_1.csv"]
    assert sorted(path.name for path in again.iterdir()) == names
    for name in names:
        assert (first / name).read_bytes() == (again / name).read_bytes()
    assert found == json.loads((first / "results.json").read_text("utf-8"))
    text = (first / "page.md").read_text("utf-8")
    assert render_page(SHORT, *read_document(found)) == text
    assert "`railhil reproduce short --seeds 3,4 --out DIR`" in text
    energies = [run["measured"]["energy_kj"] for run in found["runs"]]
    line = found["tables"][0]["lines"][0]
    assert line["measured"]["bench"] == pytest.approx(sum(energies) / 2)
    assert line["ratio"]["bench"] == pytest.approx(line["measured"]["bench"] / 100)
    with (first / "table_1.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[0]["bench"]) == line["measured"]["bench"]
    assert rows[1]["published"] == rows[1]["bench ratio"] == ""


def _measured(key: str, **values: float | None) -> Measurement:
    return Measurement(key, "PASS", (), "0" * 64, values)


def test_a_figure_over_runs_needs_a_value_of_every_run() -> None:
    runs = {key: _measured(key, a=value, b=other) for key, value, other in (("x", 1.0, 2.0), ("y", 3.0, None))}
    found = Results((0, 1), runs)
    assert found.reduce(("x", "y"), "a") == 2.0
    assert found.reduce(("x", "y"), "b") is None
    assert found.reduce((), "a") is None
    assert found.reduce(("x", "y"), "a", max) == 3.0


def test_order_has_those_without_a_value_last() -> None:
    assert rank_names({"a": 2.0, "b": None, "c": -1.0}) == ["c", "a", "b"]
    assert (find_least({"a": 2.0, "b": None, "c": -1.0}), find_least({"a": None, "b": None})) == ("c", None)


def test_a_table_without_published_values_has_no_ratio() -> None:
    line = Line("law", "error", "m", 2, None, (1.0, None))
    table = Table("t", "T", ("x", "y"), (line,))
    assert table.headings == ["quantity", "", "unit", "x", "y", "remark"]
    assert table.cells(line) == ["error", "law", "m", "1.00", "-", ""]


def test_a_table_with_published_values() -> None:
    line = Line("law", "error", "m", 2, 4.0, (1.0, None), 1, "why")
    table = Table("t", "T", ("x", "y"), (line,))
    assert table.headings == ["quantity", "", "unit", "published", "x", "ratio", "y", "ratio", "remark"]
    assert table.cells(line) == ["error", "law", "m", "4.0", "1.00", "0.250", "-", "-", "why"]
    assert Line("law", "error", "m", 2, 0.0, (1.0,)).ratios == (None,)
    plain = Table("t", "T", ("x", "y"), (line,), with_ratio=False)
    assert plain.cells(line) == ["error", "law", "m", "4.0", "1.00", "-", "why"]


def test_an_invalid_run_is_named_and_decides_the_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["late"], PAPERS) == 3
    assert "INVALID: run-3: " in capsys.readouterr().out


def test_without_the_extra_the_page_has_no_figures(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert main(["short", "--out", str(tmp_path)], PAPERS) == 0
    assert "no figures: matplotlib is not installed (" in capsys.readouterr().out
    text = (tmp_path / "page.md").read_text("utf-8")
    assert "## Table 1" in text
    assert "## Figures" not in text
    assert json.loads((tmp_path / "results.json").read_text("utf-8"))["figures"] == []


def test_a_run_that_cannot_be_made_leaves_no_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not there"):
        main(["lost", "--out", str(tmp_path / "new"), "--keep-runs"], PAPERS)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(InputError, match="not there"):
        main(["lost", "--out", str(tmp_path)], PAPERS)


def test_a_refused_run_comes_back_from_its_process() -> None:
    back = pickle.loads(pickle.dumps(NeverBegan("the law refused", 2)))
    assert (str(back), back.exit_code) == ("the law refused", 2)
    assert pickle.loads(pickle.dumps(SHORT)) == SHORT


@pytest.mark.parametrize("name", list(SHIPPED))
def test_the_documents_have_what_the_command_writes(name: str) -> None:
    """From the measured values that stand there."""
    paper, folder = find_paper(name), ROOT / "docs" / "reproduce" / name
    written = json.loads((folder / "results.json").read_text("utf-8"))
    found, captions = read_document(written)
    write = f"railhil reproduce {name} --out docs/reproduce/{name} writes it"
    assert make_document(paper, found, captions) == written, write
    texts = {"page.md": render_page(paper, found, captions), **render_parameters(paper, found)}
    texts |= {f"{table.name}.csv": render_csv(table) for table in paper.compare(found)}
    for file, text in texts.items():
        assert (folder / file).read_text("utf-8") == text, write
    there = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    assert there == {*texts, "results.json", *(f"{one.name}.svg" for one in captions)}


@pytest.mark.parametrize("name", list(SHIPPED))
def test_what_was_not_measured_proves_nothing(name: str) -> None:
    paper, nothing = find_paper(name), Results(find_paper(name).text.seeds, {})
    assert list(paper.draw(nothing)) == []
    said = paper.judge(nothing)
    assert {one.verdict for one in said} == {OPEN}
    assert all("not made" in one.measured and not one.why for one in said)


@pytest.mark.parametrize("lost", ["not made", "INVALID", "without values"])
def test_a_paper_is_not_confirmed_by_runs_that_did_not_get_that_far(lost: str) -> None:
    """The order of the laws is that of the paper where nothing is known; a run that cannot be trusted is not known."""
    paper = find_paper("ipfc")
    keys = [one.key for one in paper.plan(paper.text.seeds)]
    names = [one.key for one in CRITERIA] + [RMS_ERROR, CHATTER, ADAPTED]
    runs = {
        key: Measurement(key, "INVALID" if lost == "INVALID" else "FAIL", (), "", dict.fromkeys(names))
        for key in keys
        if lost == "without values" or lost == "INVALID" or key != "ipfc-iq-0"
    }
    verdicts = {one.verdict for one in paper.judge(Results(paper.text.seeds, runs))}
    assert verdicts == ({FOLLOWS_NOT} if lost == "without values" else {OPEN})
