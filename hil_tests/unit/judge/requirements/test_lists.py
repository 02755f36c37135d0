"""Lists of requirements in ReqIF: what is read, and the results in a copy that other tools read."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from hil_tests.support.requirement_lists import attribute, reqif_text
from railhil.common.errors import InputError
from railhil.judge.requirements.lists import EVIDENCE, VERDICT, Listed, Result, read_list, write_results
from railhil.judge.requirements.requirement import read_requirements

ROWS = [
    ("ATO-5", "No traction <xhtml:b>without</xhtml:b> a speed.", "never true_speed &lt; 0 km/h"),
    ("ATO-12", "It stops within 0.3 m &amp; stays.", ""),
]


@pytest.fixture
def reqif(tmp_path: Path) -> Path:
    path = tmp_path / "train.ReqIF"
    path.write_text(reqif_text(ROWS), encoding="utf-8")
    return path


def test_a_requirement_of_a_reqif_has_an_id_and_a_text(reqif: Path) -> None:
    assert read_list(reqif) == (
        Listed("ATO-5", "No traction without a speed.", "", "never true_speed < 0 km/h"),
        Listed("ATO-12", "It stops within 0.3 m & stays."),
    )


def test_the_sentences_of_a_list_are_requirements(reqif: Path) -> None:
    (found,) = read_requirements(reqif)
    assert (found.id, found.says, found.file) == ("ATO-5", "never true_speed < 0 km/h", str(reqif))


def _valid(path: Path) -> None:
    command = [sys.executable, "-m", "reqif.cli.main", "validate", "--use-reqif-schema", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert "0 errors, 0 schema issues found, 0 semantic issues found" in done.stdout, done.stdout + done.stderr


@pytest.mark.slow
def test_results_are_attributes_of_a_copy_that_keeps_all_else(reqif: Path, tmp_path: Path) -> None:
    _valid(reqif)
    first, second = tmp_path / "first.reqif", tmp_path / "second.reqif"
    write_results(reqif, {"ATO-5": Result("PASSED", 'a < b & "c"')}, first)
    _valid(first)
    assert attribute(first, "ATO-5", VERDICT) == "PASSED"
    assert attribute(first, "ATO-5", EVIDENCE) == 'a < b & "c"'
    assert attribute(first, "ATO-12", VERDICT) == ""
    assert read_list(first) == read_list(reqif)
    # Those of an earlier copy are replaced, or taken out; nothing is declared twice.
    write_results(first, {"ATO-12": Result("FAILED", "x")}, second)
    _valid(second)
    assert (attribute(second, "ATO-5", VERDICT), attribute(second, "ATO-12", VERDICT)) == ("", "FAILED")
    assert second.read_text().count(f'LONG-NAME="{VERDICT}"') == 1
    for text in ('THE-VALUE="Stops"', "<xhtml:b>without</xhtml:b>", "<SPEC-OBJECT-REF>o-ATO-12</SPEC-OBJECT-REF>"):
        assert second.read_text().count(text) == 1


def test_an_attribute_of_another_type_is_not_written_to(reqif: Path, tmp_path: Path) -> None:
    write_results(reqif, {}, reqif)
    text = reqif.read_text(encoding="utf-8")
    (made,) = re.findall(rf"<ATTRIBUTE-DEFINITION-STRING [^>]*{VERDICT}.*?</ATTRIBUTE-DEFINITION-STRING>", text, re.S)
    reqif.write_text(text.replace(made, made.replace("STRING", "XHTML")), encoding="utf-8")
    with pytest.raises(InputError, match="cannot be written, expected RAILHIL_VERDICT of the type string"):
        write_results(reqif, {"ATO-5": Result("PASSED", "x")}, tmp_path / "out.reqif")
    assert not (tmp_path / "out.reqif").exists()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "train.reqif: cannot be read, expected a ReqIF file"),
        ("<REQ-IF>", "train.reqif: cannot be read, expected a ReqIF file"),
        ("<html/>", "train.reqif: (cannot be read|has no requirement)"),
        (reqif_text([]), "train.reqif: has no requirement, expected at least one with an id and a text"),
        (reqif_text([*ROWS, ROWS[0]]), "train.reqif: id: found 'ATO-5', allowed an id that no other requirement has"),
    ],
)
def test_what_is_no_list_is_one_line(tmp_path: Path, content: str, message: str) -> None:
    path = tmp_path / "train.reqif"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=message) as caught:
        read_list(path)
    assert "\n" not in str(caught.value)


def test_a_list_without_a_sentence_judges_no_run(tmp_path: Path) -> None:
    path = tmp_path / "train.reqif"
    path.write_text(reqif_text(ROWS[1:]), encoding="utf-8")
    with pytest.raises(InputError, match="RAILHIL_SAYS: is missing, expected a sentence in this attribute"):
        read_requirements(path)


def test_a_wrong_sentence_of_a_list_is_named(tmp_path: Path) -> None:
    path = tmp_path / "train.reqif"
    path.write_text(reqif_text([("ATO-5", "No.", "nevr fault")]), encoding="utf-8")
    with pytest.raises(InputError, match=r'train\.reqif: requirement ATO-5: "nevr"'):
        read_requirements(path)
