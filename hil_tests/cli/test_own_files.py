"""No command writes over the record that it reads, nor over a list of requirements."""

from __future__ import annotations

from pathlib import Path

import pytest

import railhil
from hil_tests.support.cli import Railhil, complaint
from hil_tests.support.requirement_lists import reqif_text
from hil_tests.support.short_runs import RUN_2M_TOML


@pytest.fixture
def run(tmp_path: Path) -> Path:
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    return railhil.run(tmp_path / "short.toml", out=tmp_path / "run").folder


@pytest.mark.parametrize(
    ("words", "option"),
    [
        (("export", "RUN", "--csv", "--out", "RUN/signals.csv"), "--out"),
        (("export", "RUN", "--asc", "--out", "RUN/frames.log"), ""),
        (("report", "RUN", "--out", "RUN/certificate.json"), "--out"),
        (("report", "RUN", "--out", "RUN/SHA256SUMS"), "--out"),
        (("ports", "--write-dbc", "RUN/railhil.dbc"), "--write-dbc"),
    ],
)
def test_a_file_of_a_record_is_not_written_over(here: Railhil, run: Path, words: tuple[str, ...], option: str) -> None:
    before = {path.name: path.read_bytes() for path in run.iterdir()}
    done = here(*(word.replace("RUN", str(run)) for word in words))
    assert done.exit_code == (2 if option else done.exit_code)
    assert f"{option}: " in done.err
    assert {name: (run / name).read_bytes() for name in before} == before
    assert here("verify", run).exit_code == 0


def test_pages_and_new_files_of_a_record_are_written(here: Railhil, run: Path) -> None:
    for _ in range(2):
        for name in ("report.html", "own.html", "OWN.HTM"):
            assert here("report", run, "--out", run / name).exit_code == 0
        assert here("export", run, "--csv").exit_code == 0
    assert here("verify", run).exit_code == 0


def test_a_list_of_something_else_beside_the_file_is_nobodys(here: Railhil, run: Path, tmp_path: Path) -> None:
    (tmp_path / "SHA256SUMS").write_text("SHA256 (a.iso) = abc\n")
    for _ in range(2):
        assert here("export", run, "--csv", "--out", tmp_path / "a.csv").exit_code == 0
        assert here("report", run, "--out", tmp_path / "a.html").exit_code == 0


@pytest.mark.parametrize("name", ["train.reqif", "./train.reqif", "linked.reqif"])
def test_results_do_not_replace_their_list(here: Railhil, run: Path, name: str) -> None:
    pytest.importorskip("reqif", reason="MISSING CAPABILITY reqif (extra requirements)")
    text = reqif_text([("R-1", "It never goes back.", "never true_speed &lt; 0 km/h")])
    Path("train.reqif").write_text(text)
    Path("linked.reqif").symlink_to("train.reqif")
    said = complaint(here("score", run, "--requirements", "train.reqif", "--results", name))
    assert "--results" in said
    assert "another file than the one that is read" in said
    assert Path("train.reqif").read_text() == text


def test_two_lists_of_one_name_are_refused_before_the_dossier(here: Railhil, run: Path, tmp_path: Path) -> None:
    pytest.importorskip("reqif", reason="MISSING CAPABILITY reqif (extra requirements)")
    for place in "ab":
        (tmp_path / place).mkdir()
        (tmp_path / place / "l.reqif").write_text(reqif_text([(f"R-{place}", "Slow.", "never true_speed &lt; 0 km/h")]))
    lists = [word for place in "ab" for word in ("--requirements", tmp_path / place / "l.reqif")]
    assert "two lists of one name" in complaint(here("dossier", run, *lists, "--out", tmp_path / "out"))
    assert not (tmp_path / "out").exists()
