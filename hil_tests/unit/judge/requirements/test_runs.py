"""Runs that are judged by requirements: what a violated one changes, and what the record alone gives."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.paths import ROOT
from railhil.cli.score import further_required
from railhil.common.errors import InputError
from railhil.judge.folder import junit
from railhil.judge.record import checked_record
from railhil.judge.requirements.outcome import with_requirements
from railhil.judge.requirements.requirement import named_requirements, requirements_from_json
from railhil.judge.result import Result
from railhil.record.hash_list import write_hash_list
from railhil.report.page import page
from railhil.run.make import record_run
from railhil.run.report import as_recorded
from railhil.run.spec import with_requirements as spec_with_requirements
from railhil.scenarios.run_spec import LawSpec, RunSpec

_KEPT = 'id = "A-1"\nsays = "never true_speed < 0 km/h"'
_VIOLATED = 'id = "A-2"\nsays = "always true_speed <= 10 km/h"'
_SILENT = 'id = "A-3"\nsays = "whenever true_speed > 200 km/h, within 1 s notch_command <= 0"'
_HOP = RunSpec(str(ROOT / "hil_tests" / "data" / "pairs.toml"), law=LawSpec("ipfc_plus"), bus="local")


def file_of(folder: Path, *tables: str) -> Path:
    path = folder / "mine.toml"
    path.write_text("".join(f"[[requirement]]\n{table}\n" for table in tables))
    return path


def tables_of(*paths: Path) -> tuple[dict[str, Any], ...]:
    return tuple(one.as_json() for one in named_requirements(paths))


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> Result:
    """A run with a violated requirement."""
    folder = tmp_path_factory.mktemp("judged")
    tables = tables_of(file_of(folder, _KEPT, _VIOLATED, _SILENT))
    return record_run(replace(_HOP, requirements=tables, out=folder / "run"))


def test_a_violated_requirement_fails_the_run_and_its_frames_are_those_without(judged: Result, tmp_path: Path) -> None:
    plain = record_run(replace(_HOP, out=tmp_path / "plain"))
    assert (plain.verdict, judged.verdict, judged.exit_code) == ("PASS", "FAIL", 1)
    assert judged.frames_sha256 == plain.frames_sha256
    assert [one.verdict for one in judged.score.requirements] == ["kept", "violated", "says nothing"]
    violated = judged.score.requirements[1]
    assert judged.line == violated.line
    assert violated.margin is not None
    short = f"{violated.id} violated at {violated.instant_s:.2f} s, margin {violated.margin:.4g} {violated.unit}"
    assert violated.short_line == short
    assert violated.says not in short
    assert "requirements" not in json.loads((tmp_path / "plain" / "score.json").read_text())


def test_the_folder_alone_gives_the_same_outcomes(judged: Result) -> None:
    record = checked_record(str(judged.folder), None)
    written = json.loads((judged.place / "score.json").read_text())
    assert [one.as_json() for one in record.score.requirements] == written["requirements"]
    assert (record.verdict, record.notes) == ("FAIL", ())
    assert record.score.requirements == judged.score.requirements


def test_an_edited_sentence_of_a_certificate_is_refused(judged: Result) -> None:
    certificate = judged.place / "certificate.json"
    text = certificate.read_text()
    try:
        certificate.write_text(text.replace("<= 10 km/h", "<= 99 km/h"))
        with pytest.raises(InputError, match="a file that nobody changed"):
            checked_record(str(judged.folder), None)
    finally:
        certificate.write_text(text)


def test_a_record_is_judged_later_as_during_the_run(judged: Result, tmp_path: Path) -> None:
    plain = as_recorded(record_run(replace(_HOP, out=tmp_path / "plain")))
    later = with_requirements(plain, requirements_from_json(judged.spec.requirements, tmp_path))
    assert later.requirements == judged.score.requirements
    assert later.verdict == "FAIL"


def test_junit_and_report_show_each_requirement(judged: Result) -> None:
    cases = junit(judged).getroot().findall("testcase")
    failed = [case.attrib["name"] for case in cases if case.find("failure") is not None]
    assert [case.attrib["name"] for case in cases][-3:] == [f"requirement A-{number}" for number in (1, 2, 3)]
    assert failed == ["requirement A-2"]
    shown = page([as_recorded(judged)])
    assert 'id="requirements"' in shown
    assert "always true_speed &lt;= 10 km/h" in shown


def test_a_sentence_that_does_not_fit_is_refused_before_the_run(tmp_path: Path) -> None:
    path = file_of(tmp_path, 'id = "A-1"\nsays = "never true_sped < 0 km/h"')
    spec = replace(_HOP, requirements=tables_of(path), out=tmp_path / "run")
    with pytest.raises(InputError, match=r"mine.toml: requirement A-1: .*true_sped.*column 7"):
        record_run(spec)
    assert not (tmp_path / "run").exists()


def test_a_repeated_run_has_the_sentences_of_the_certificate_when_their_file_is_gone(judged: Result) -> None:
    again = RunSpec.from_file(judged.place / "certificate.json")
    assert again == judged.spec
    assert again.requirements == judged.spec.requirements
    assert again.words.count("--requirements") == 1


def test_a_requirement_that_two_files_have_counts_once(judged: Result, tmp_path: Path) -> None:
    again = file_of(tmp_path, _KEPT, _VIOLATED, _SILENT)
    assert spec_with_requirements(judged.spec, [str(again)]).requirements == judged.spec.requirements
    record = checked_record(str(judged.folder), None)
    assert further_required(record, [str(again)]).score.requirements == record.score.requirements
    assert [one.id for one in named_requirements([again, again.parent / "." / "mine.toml"])] == ["A-1", "A-2", "A-3"]


def _relisted(judged: Result, folder: Path, name: str, old: str, new: str) -> str:
    """A copy of the folder in which a document and then the list of hashes were changed."""
    shutil.copytree(judged.place, folder)
    text = (folder / name).read_text()
    assert old in text
    (folder / name).write_text(text.replace(old, new))
    write_hash_list(folder)
    return str(folder)


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        ("score.json", '"verdict": "violated"', '"verdict": "kept"', "requirement A-2 failed"),
        ("junit.xml", 'name="requirement A-2"', 'name="requirement A-9"', "requirement A-9 failed"),
        ("certificate.json", '"id": "A-3"', '"id": "A-4"', "requirements: found"),
        ("certificate.json", '"requirements": [', '"requirements": 5, "other": [', "a list of tables"),
        ("certificate.json", '"requirements": [', '"other": [', "requirements: found"),
    ],
)
def test_documents_that_disagree_on_requirements_are_refused(
    judged: Result, tmp_path: Path, name: str, old: str, new: str, said: str
) -> None:
    folder = _relisted(judged, tmp_path / "copy", name, old, new)
    with pytest.raises(InputError, match=said):
        checked_record(folder, None)
