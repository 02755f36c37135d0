"""``railhil runs`` and ``railhil query`` on a terminal."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hil_tests.support.cli import Railhil, complaint
from hil_tests.support.run_folders import write_run
from hil_tests.support.short_runs import RUN_2M_TOML


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    write_run(tmp_path / "one")
    write_run(tmp_path / "two", "tpfc1", "FAIL", seed=7)
    return tmp_path


def test_the_table_has_a_line_for_each_folder(here: Railhil, runs: Path) -> None:
    done = here("runs", runs)
    assert done.exit_code == 0, done.err
    assert "stop error +0.4 m" in " ".join(done.out.split())
    assert done.out.splitlines()[-1] == f"2 folders below {runs}; 2 new or changed since the index was last made"
    assert here("runs", runs, "--new").out.splitlines()[-1].startswith("0 folders of 2 ")
    assert here("runs", runs, "--last", "1").out.splitlines()[-1].startswith("2 folders below")


def test_the_json_document_is_what_was_chosen(here: Railhil, runs: Path) -> None:
    done = here("runs", runs, "--where", "verdict=FAIL", "--json")
    assert [one["folder"] for one in done.json] == ["two"]
    assert [one["law"] for one in here("runs", runs, "--group", "law", "--json").json] == ["ipfc", "tpfc1"]


def test_a_statement_prints_its_rows(here: Railhil, runs: Path) -> None:
    statement = "select law, count(*) as number, max(made) as newest from runs group by law order by law"
    assert "tpfc1" in here("query", statement, runs).out
    assert [one["number"] for one in here("query", statement, runs, "--json").json] == [1, 1]
    assert here("query", "select 'nan'::double as x", runs, "--json").json == [{"x": None}]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("runs", "{}", "--where", "verdict"), "allowed KEY=PATTERN"),
        (("runs", "{}", "--where", "verdct=FAIL"), "did you mean verdict"),
        (("runs", "{}", "--group", "lw"), "did you mean law"),
        (("runs", "{}", "--since", "soon"), "12h, 3d, 2w ago"),
        (("query", "selct 1", "{}"), "railhil query: SQL: Parser Error"),
    ],
)
def test_bad_input_is_refused_in_a_line(here: Railhil, runs: Path, words: tuple[str, ...], said: str) -> None:
    assert said in complaint(here(*(word.format(runs) for word in words)))


@pytest.mark.slow
def test_a_recorded_run_stands_in_the_index_as_it_was_judged(here: Railhil, tmp_path: Path) -> None:
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    run = here(
        "run", tmp_path / "short.toml", "--bus", "local", "--no-report", "--out", tmp_path / "runs" / "x", "--json"
    )
    (row,) = here("runs", tmp_path / "runs", "--json").json
    assert (row["verdict"], row["problem"]) == (run.json["verdict"], "")
    certificate = json.loads((tmp_path / "runs" / "x" / "certificate.json").read_text())
    assert {key: row[key] for key in ("frames_sha256", "command", "code_sha256")}.items() <= certificate.items()
    for key, value in run.json["scores"].items():
        assert row.get(key) == value
