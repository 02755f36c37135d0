"""``railhil dossier``: each requirement with its evidence, and each gap of it."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import railhil
from hil_tests.support.browser import chromium_or_skip
from hil_tests.support.cli import Railhil, complaint
from hil_tests.support.paths import ROOT
from hil_tests.support.requirement_lists import reqif_text
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.common.version import full_version
from railhil.dossier.claims import NONE, NOT_SHOWN, SHOWN
from railhil.dossier.dossier import Dossier, make_dossier
from railhil.dossier.junit import read_validation
from railhil.dossier.page import page
from railhil.judge.folder import code_sha256
from railhil.judge.requirements.requirement import named_requirements
from railhil.judge.requirements.sentence import VIOLATED
from railhil.record.hash_list import read_hash_list, write_hash_list
from railhil.record.signature import sign_list

RULES = """
[[requirement]]
id = "R-1"
says = "never true_speed > 20 km/h"
title = "slow"
source = "chosen"
[[requirement]]
id = "R-2"
says = "whenever age(TRN_SPEED) > 64 ms, within 20 ms notch_command <= 0"
"""
BROKEN = '[[requirement]]\nid = "R-1"\nsays = "never true_speed > 0.1 km/h"\n'
#: Copies the run into a folder and returns its place.
Copied = Callable[..., Path]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A run that keeps its requirements, and one that violates one; read-only."""
    folder = tmp_path_factory.mktemp("dossier")
    (folder / "short.toml").write_text(RUN_2M_TOML)
    found = {}
    for name, text in (("kept", RULES), ("broken", BROKEN)):
        (sentences := folder / f"{name}.toml").write_text(text)
        railhil.run(folder / "short.toml", bus="local", requirements=sentences, out=folder / name)
        found[name] = folder / name
    return found


@pytest.fixture
def copied(made: dict[str, Path], tmp_path: Path) -> Copied:
    def copy(name: str, place: str = "") -> Path:
        return Path(shutil.copytree(made[name], tmp_path / "runs" / (place or name)))

    return copy


@pytest.fixture
def rules(tmp_path: Path) -> Path:
    path = tmp_path / "rules.toml"
    path.write_text(RULES)
    return path


def _of(folder: Path, rules: Path | None = None, key: Path | None = None, validation: Path | None = None) -> Dossier:
    listed = () if rules is None else named_requirements([rules], prose=True)
    return make_dossier([folder], listed, key, validation)


def _verdicts(found: Dossier) -> dict[str, str]:
    return {one.id: one.verdict for one in found.claims}


def test_a_run_that_keeps_a_sentence_shows_it_and_what_is_missing_is_said(
    here: Railhil, copied: Copied, tmp_path: Path
) -> None:
    run = copied("kept")
    done = here("dossier", run.parent, "--out", tmp_path / "out", "--json")
    assert done.exit_code == 1, "R-2 is not shown"
    assert {one["id"]: one["verdict"] for one in done.json["claims"]} == {"R-1": SHOWN, "R-2": NOT_SHOWN}
    said = "\n".join(done.json["gaps"])
    assert "R-2 not shown: says nothing in 1 run (its antecedent was never met): E1" in said
    assert "1 of 1 folder without a signature" in said
    assert "no results of railhil's own tests are here" in said
    (row,) = done.json["claims"][0]["runs"]
    assert row["outcome"]["margin"] == json.loads((run / "score.json").read_text())["requirements"][0]["margin"]
    (evidence,) = done.json["evidence"]
    certificate = json.loads((run / "certificate.json").read_text())
    assert evidence["frames_sha256"] == certificate["frames_sha256"]
    page = (tmp_path / "out" / "report.html").read_text()
    assert certificate["frames_sha256"] in page
    assert "claims no conformity with any standard" in page
    assert here("verify", tmp_path / "out").exit_code == 0
    (tmp_path / "out" / "dossier.json").write_text("{}")
    assert here("verify", tmp_path / "out").exit_code == 1


def test_all_is_shown_by_evidence_that_checks(here: Railhil, made: dict[str, Path], tmp_path: Path) -> None:
    (tmp_path / "one.toml").write_text(RULES.partition('[[requirement]]\nid = "R-2"')[0])
    short = made["kept"].with_name("short.toml")
    railhil.run(short, bus="local", requirements=tmp_path / "one.toml", out=tmp_path / "run")
    done = here("dossier", tmp_path / "run", "--out", tmp_path / "out")
    assert done.exit_code == 0, done.out
    assert done.out.splitlines()[0].split() == ["R-1", "shown", "slow"]
    assert "1 requirement: 1 shown. 1 folder of evidence, 1 as listed." in done.out
    # A dossier is made again in its folder.
    (tmp_path / "run" / "junit.xml").unlink()
    assert here("dossier", tmp_path / "run", "--out", tmp_path / "out").exit_code == 1


def test_a_violation_counts_whatever_else_is_shown(copied: Copied) -> None:
    copied("kept")
    runs = copied("broken").parent
    found = _of(runs)
    assert _verdicts(found)["R-1"] == VIOLATED
    (claim,) = (one for one in found.claims if one.id == "R-1")
    assert {run.verdict for run in claim.runs} == {"kept", VIOLATED}
    assert claim.gaps[0] == "violated in 1 run: E1"
    assert "judged by another sentence of this id" in claim.gaps[1]


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_an_edited_byte_of_any_file_is_said_and_shows_nothing(made: dict[str, Path], data: st.DataObject) -> None:
    folder = made["kept"]
    name = data.draw(st.sampled_from(sorted(read_hash_list(folder) or {})))
    path = folder / name
    content = path.read_bytes()
    place = data.draw(st.integers(0, len(content) - 1))
    try:
        path.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
        found = _of(folder)
    finally:
        path.write_bytes(content)
    assert SHOWN not in _verdicts(found).values()
    assert not found.is_complete
    assert any(name in problem for problem in found.evidence[0].problems)


def test_an_edited_folder_that_says_violated_still_speaks_against(copied: Copied, rules: Path) -> None:
    copied("kept")
    run = copied("broken")
    (run / "signals.csv").write_text("")
    found = _of(run.parent)
    assert _verdicts(found)["R-1"] == VIOLATED
    assert [one.name for one in found.evidence if one.problems] == ["E1"]


def test_a_record_that_stands_twice_counts_once(copied: Copied) -> None:
    copied("kept")
    found = _of(copied("kept", "again").parent)
    assert [run.counts for run in found.claims[0].runs] == [True, False]
    assert "E2 " in "".join(found.gaps)
    assert "the record of E1 again" in "".join(found.gaps)


def test_a_requirement_that_fits_no_run_has_no_evidence(copied: Copied, tmp_path: Path) -> None:
    listed = tmp_path / "listed.toml"
    listed.write_text('[[requirement]]\nid = "X-1"\nsays = "never no_such_signal > 1 m"\n')
    found = _of(copied("kept").parent, listed)
    assert _verdicts(found)["X-1"] == NONE
    assert "does not fit the scenario" in " ".join(found.claims[0].gaps)


def test_the_sentence_of_the_list_counts_and_the_other_one_is_said(copied: Copied, tmp_path: Path) -> None:
    listed = tmp_path / "listed.toml"
    listed.write_text('[[requirement]]\nid = "R-1"\nsays = "never true_speed > 0.1 km/h"\n')
    found = _of(copied("kept").parent, listed)
    assert _verdicts(found)["R-1"] == VIOLATED
    assert "when it was made, R-1 was another sentence: never true_speed > 20 km/h" in found.claims[0].deviations


def test_a_listed_requirement_is_judged_on_runs_that_did_not_have_it(copied: Copied, tmp_path: Path) -> None:
    listed = tmp_path / "listed.toml"
    listed.write_text('[[requirement]]\nid = "X-1"\nsays = "never true_speed > 0.1 km/h"\n')
    assert _verdicts(_of(copied("kept").parent, listed))["X-1"] == VIOLATED


def _table(folder: Path, *rows: str) -> None:
    (folder / "requirements.csv").write_text("\n".join(["requirement,verdict,test,outcome", *rows, ""]))


def _junit(path: Path, outcome: str, requirement: str, *hashes: str) -> None:
    properties = [("requirement", requirement), *(("frames_sha256", one) for one in hashes)]
    listed = "".join(f'<property name="{name}" value="{value}"/>' for name, value in properties)
    path.write_text(
        f'<testsuites><testsuite><testcase classname="test_a" name="test_b">{outcome}<properties>{listed}</properties>'
        "</testcase></testsuite></testsuites>"
    )


def test_a_list_in_reqif_names_the_requirements_and_gets_the_results(
    here: Railhil, copied: Copied, tmp_path: Path
) -> None:
    pytest.importorskip("reqif", reason="MISSING CAPABILITY reqif (extra requirements)")
    rows = [("R-1", "It is slow.", "never true_speed &gt; 20 km/h"), ("A-1", "It is green.", "")]
    (tmp_path / "train.reqif").write_text(reqif_text(rows))
    run = copied("kept")
    done = here("dossier", run, "--requirements", tmp_path / "train.reqif", "--out", tmp_path / "out", "--json")
    verdicts = {one["id"]: one["verdict"] for one in done.json["claims"]}
    assert verdicts == {"R-1": SHOWN, "A-1": NONE, "R-2": NOT_SHOWN}
    assert "A-1 no evidence: no run, no test and no search is about it" in done.json["gaps"]
    assert "It is green." in (tmp_path / "out" / "report.html").read_text()
    copy = (tmp_path / "out" / "train_results.reqif").read_text()
    assert (copy.count("RAILHIL_VERDICT") > 1, "no evidence" in copy) == (True, True)
    assert here("verify", tmp_path / "out").exit_code == 0


def test_a_passed_test_shows_its_requirement_if_its_runs_are_there_and_check(copied: Copied) -> None:
    run = copied("kept", "test_a.test_b")
    _table(run.parent, "T-1,PASSED,test_a.py::test_b,passed", "T-2,PASSED,test_a.py::test_c,passed")
    found = _of(run.parent)
    assert (_verdicts(found)["T-1"], _verdicts(found)["T-2"]) == (SHOWN, NOT_SHOWN)
    assert "test test_a.py::test_c: none of its runs is here" in "".join(found.gaps)
    (run / "signals.csv").write_text("")
    assert _verdicts(_of(run.parent))["T-1"] == NOT_SHOWN


def test_outcomes_of_tests_in_no_list_are_told_and_an_edited_listed_file_does_not_count(copied: Copied) -> None:
    runs = copied("kept", "test_a.test_b").parent
    _table(runs, "T-1,PASSED,test_a.py::test_b,passed")
    gaps = " ".join(_of(runs).gaps)
    assert f"no list of hashes has (an edit is not noticed): {runs / 'requirements.csv'}" in gaps
    assert "1 test without a JUnit report: a table does not tell how many runs" in gaps
    write_hash_list(runs)
    found = _of(runs)
    assert _verdicts(found)["T-1"] == SHOWN
    assert "no list of hashes has" not in " ".join(found.gaps)
    _table(runs, "T-2,PASSED,test_a.py::test_b,passed")
    found = _of(runs)
    assert _verdicts(found)["T-2"] == NOT_SHOWN
    assert "not as listed, and does not count" in " ".join(found.gaps)


@pytest.mark.parametrize("name", ["requirements.csv", "junit.xml", "JUNIT.XML"])
def test_a_failed_test_counts_beside_a_list_of_hashes_too(copied: Copied, name: str) -> None:
    runs = copied("kept", "test_a.test_b").parent
    if name == "requirements.csv":
        _table(runs, "T-1,FAILED,test_a.py::test_b,failed")
    else:
        _junit(runs / name, '<failure message="no"/>', "T-1")
    assert _verdicts(_of(runs))["T-1"] == VIOLATED
    write_hash_list(runs)
    assert _verdicts(_of(runs))["T-1"] == VIOLATED


def test_requirements_of_a_list_without_a_sentence_rest_on_tests_or_are_gaps(copied: Copied, tmp_path: Path) -> None:
    listed = tmp_path / "train.reqif"
    rows = [("T-1", "It stops.", ""), ("T-2", "It is green.", ""), ("R-1", "Slow.", "never true_speed &gt; 20 km/h")]
    listed.write_text(reqif_text(rows), encoding="utf-8")
    run = copied("kept", "test_a.test_b")
    _table(run.parent, "T-1,PASSED,test_a.py::test_b,passed")
    found = _of(run.parent, listed)
    assert _verdicts(found) == {"T-1": SHOWN, "T-2": NONE, "R-1": SHOWN, "R-2": NOT_SHOWN}
    gaps = {one.id: " ".join(one.gaps) for one in found.claims}
    assert "no sentence: it rests on the assertions of its tests" in gaps["T-1"]
    assert "no run, no test and no search is about it" in gaps["T-2"]
    text = page(found, tmp_path)
    assert "It is green." in text
    assert "Slow." in text


def test_a_junit_report_names_the_runs_of_a_test_by_their_frames(copied: Copied) -> None:
    run = copied("kept")
    sha256 = json.loads((run / "certificate.json").read_text())["frames_sha256"]
    report = run.parent / "junit.xml"
    _junit(report, "", "T-1", sha256)
    assert _verdicts(_of(run.parent))["T-1"] == SHOWN
    _junit(report, "", "T-1", sha256, "0" * 64)
    found = _of(run.parent)
    assert _verdicts(found)["T-1"] == NOT_SHOWN
    assert "1 run of it not here" in "".join(found.gaps)
    _junit(report, '<failure message="no"/>', "T-1", sha256)
    _table(run.parent, "T-1,PASSED,test_a.py::test_b,passed")
    assert _verdicts(_of(run.parent))["T-1"] == VIOLATED, "the worst of table and report counts"


def test_a_hunt_speaks_against_a_requirement_and_alone_not_for_one(copied: Copied, tmp_path: Path) -> None:
    run, hunt = copied("kept"), tmp_path / "runs" / "hunt"
    hunt.mkdir()
    row = {"says": "never true_speed > 20 km/h", "runs": 9, "antecedent_met": 9, "margin": 0.1, "unit": "m/s"}
    rows = [{**row, "id": "R-1", "violations": 1}, {**row, "id": "H-1", "violations": 0}]
    (hunt / "hunt.json").write_text("{}")
    (hunt / "summary.json").write_text(json.dumps({"seed": 3, "requirements": rows}))
    write_hash_list(hunt)
    found = _of(run.parent)
    assert (_verdicts(found)["R-1"], _verdicts(found)["H-1"]) == (VIOLATED, NOT_SHOWN)
    assert "only searched for: not found is not absence" in "".join(found.gaps)
    rows[1]["violations"] = "many"
    (hunt / "summary.json").write_text(json.dumps({"seed": 3, "requirements": rows}))
    write_hash_list(hunt)
    assert "summary.json: other keys than railhil writes" in "".join(_of(run.parent).gaps)


def test_a_probability_tells_how_often_and_shows_nothing(copied: Copied, tmp_path: Path) -> None:
    copied("kept")
    folder = tmp_path / "runs" / "p"
    folder.mkdir()
    summary = {"p": 1e-5, "low": 5e-6, "high": 2e-5, "runs": 900, "requirement": {"id": "P-1", "says": "never true"}}
    (folder / "probability.json").write_text("{}")
    (folder / "summary.json").write_text(json.dumps(summary))
    write_hash_list(folder)
    found = _of(tmp_path / "runs")
    (claim,) = (one for one in found.claims if one.id == "P-1")
    assert claim.verdict == NOT_SHOWN
    assert claim.searches[0][1].said == "a drawn run violates it with P = 1e-05, 95 % interval 5e-06 to 2e-05"


def _validation(folder: Path, code: str, outcome: str = "") -> Path:
    folder.mkdir(exist_ok=True)
    properties = f'<properties><property name="code_sha256" value="{code}"/></properties>'
    (folder / "unit.xml").write_text(
        '<testsuite timestamp="2026-11-28T00:00:00" hostname="h"><testcase classname="a" name="b">'
        f"{properties}{outcome}</testcase></testsuite>"
    )
    return folder


def test_the_tool_is_validated_by_results_of_its_own_code_alone(copied: Copied, tmp_path: Path) -> None:
    run = copied("kept")
    code = json.loads((run / "certificate.json").read_text())["code_sha256"]
    (tool,) = _of(run, validation=_validation(tmp_path / "v", code)).tools
    assert (tool.validated, tool.said) == (True, "its own tests: 1 passed")
    (tool,) = _of(run, validation=_validation(tmp_path / "v", "0" * 64)).tools
    assert not tool.validated
    failed = _of(run, validation=_validation(tmp_path / "v", code, "<failure/>"))
    assert not failed.tools[0].validated
    assert "a test of railhil itself failed: a.b" in failed.gaps


@pytest.mark.slow
def test_a_report_of_railhils_own_tests_names_the_code_under_test(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "pytest", "-q", f"--junitxml={tmp_path / 'here.xml'}", "-n", "2"]
    subprocess.run([*command, "hil_tests/unit/common/test_digits.py"], cwd=ROOT, check=True, timeout=300)
    found = read_validation(tmp_path)
    assert (found.codes, found.versions) == ((code_sha256(),), (full_version(),))
    assert (*found.outcomes,) == ("passed",)


def _sign(folder: Path, key: Path) -> Path:
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", str(key)], check=True)
    sign_list(folder, key)
    return key.with_suffix(".pub")


@pytest.mark.skipif(shutil.which("ssh-keygen") is None, reason="MISSING CAPABILITY ssh-keygen")
def test_the_signature_of_a_folder_above_covers_its_runs_until_one_is_listed_anew(
    copied: Copied, tmp_path: Path
) -> None:
    run = copied("kept")
    (run.parent / "learn.json").write_text("{}")
    write_hash_list(run.parent)
    key = _sign(run.parent, tmp_path / "key")
    found = _of(run.parent, key=key)
    assert [one.problems for one in found.evidence] == [(), ()]
    assert found.evidence[1].signature.endswith(", in the list of E1")
    (run / "junit.xml").unlink()
    write_hash_list(run)
    outer, inner = _of(run.parent, key=key).evidence
    assert outer.problems[0].startswith("kept/SHA256SUMS: sha256 ")
    assert inner.problems == ("unsigned",)
    assert _verdicts(_of(run.parent, key=key))["R-1"] == NOT_SHOWN


def test_bad_folders_are_refused_in_a_line(here: Railhil, copied: Copied, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert "has no evidence, expected " in complaint(here("dossier", tmp_path / "empty"))
    run = copied("kept")
    assert "an empty or new folder" in complaint(here("dossier", run, "--out", run))
    (tmp_path / "empty" / "junit.xml").write_text("<testsuites>")
    shutil.copytree(run, tmp_path / "empty" / "run")
    assert "cannot be read, expected a JUnit report" in complaint(here("dossier", tmp_path / "empty"))
    (tmp_path / "empty" / "junit.xml").write_text('<testcase><property name="requirement.A" value="[]"/></testcase>')
    assert "cannot be read, expected a JUnit report" in complaint(here("dossier", tmp_path / "empty"))
    said = complaint(here("dossier", run, "--validation", run / "none"))
    assert "does not exist, expected the folder of what" in said


@pytest.mark.slow
def test_the_page_is_without_findings_of_axe(here: Railhil, copied: Copied, tmp_path: Path) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="MISSING CAPABILITY axe").Axe()
    copied("kept")
    here("dossier", copied("broken").parent, "--out", tmp_path / "out")
    with chromium_or_skip() as chromium:
        page = chromium.new_page(viewport={"width": 400, "height": 900})
        page.goto((tmp_path / "out" / "report.html").as_uri())
        found = axe.run(page)
        assert found.violations_count == 0, found.generate_report()
        assert page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth") == 0
