"""The plugin for users' tests: a list of requirements, and the verdict of each."""

from __future__ import annotations

import pytest

from hil_tests.support.requirement_lists import attribute, reqif_text
from hil_tests.support.user_suite import run_suite
from railhil.testing import requirements

pytest_plugins = "pytester"


def test_a_list_of_requirements_gets_its_results(pytester: pytest.Pytester) -> None:
    listed = pytester.path / "train.reqif"
    listed.write_text(reqif_text([("R-1", "One.", ""), ("R-2", "Two.", ""), ("R-3", "Three.", "")]), encoding="utf-8")
    pytester.makepyfile(
        test_suite="""
        import pytest
        @pytest.mark.requirement("R-2")
        def test_two(): pass
        @pytest.mark.requirement("R-2", "R-3")
        def test_three(): assert False
        """
    )
    done = run_suite(pytester.path, "--railhil-requirements", "train.reqif", "--railhil-runs", "kept")
    done.stdout.fnmatch_lines(
        [
            "R-1  NO TEST    no test names it", "R-2  FAILED     1 of 2 tests passed", "R-3  FAILED     0 of 1 tests*",
            "list with results: *kept/train_results.reqif",
        ]
    )  # fmt: skip
    copy = pytester.path / "kept/train_results.reqif"
    verdicts = [attribute(copy, name, "RAILHIL_VERDICT") for name in ("R-1", "R-2", "R-3")]
    assert verdicts == ["NO TEST", "FAILED", "FAILED"]
    said = attribute(copy, "R-2", "RAILHIL_EVIDENCE")
    assert said.startswith("1 of 2 tests passed: test_suite.py::test_")
    assert "test_suite.py::test_three: failed" in said
    rows = (pytester.path / "kept/requirements.csv").read_text().splitlines()
    assert [row.partition(",")[0] for row in rows] == ["requirement", "R-2", "R-2", "R-3"]


def test_a_marker_names_a_requirement_of_the_list(pytester: pytest.Pytester) -> None:
    (pytester.path / "train.reqif").write_text(reqif_text([("ATO-12", "Stop.", "")]), encoding="utf-8")
    pytester.makepyfile(test_suite="import pytest\n@pytest.mark.requirement('ATO-21')\ndef test_it(): pass\n")
    done = run_suite(pytester.path, "--railhil-requirements", "train.reqif")
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    done.stderr.fnmatch_lines(["*marker requirement: ATO-21 is not in the list of requirements (*ATO-12*)"])
    done = run_suite(pytester.path, "--railhil-requirements", "none.reqif")
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    done.stderr.fnmatch_lines(["*none.reqif: does not exist*"])


def test_a_requirement_is_as_good_as_its_worst_test() -> None:
    def report(outcome: str, test: str, *names: str) -> tuple[str, str, list[tuple[str, object]]]:
        return outcome, test, [("requirement", name) for name in names]

    found = requirements.requirements(
        [report("passed", "a", "R1", "R2"), report("error", "a", "R1"), report("skipped", "b", "R2", "R3"),
         report("", "a", "R9"), report("xfailed", "c", "R4")]
    )  # fmt: skip
    assert [(one.name, one.verdict) for one in found] == [
        ("R1", "FAILED"), ("R2", "PASSED"), ("R3", "NOT SHOWN"), ("R4", "FAILED"),
    ]  # fmt: skip
    assert requirements.lines(found)[:2] == ["R1  FAILED     0 of 1 tests passed", "    error: a"]
