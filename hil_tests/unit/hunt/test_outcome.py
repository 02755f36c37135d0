"""A hunt as a function, and in a test of a user."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import railhil
from hil_tests.support.cli import railhil as railhil_command
from hil_tests.support.short_runs import RUN_2M_TOML
from hil_tests.support.user_suite import properties, run_suite
from railhil.hunt.oracle import run_case
from railhil.hunt.outcome import HuntOutcome
from railhil.judge.requirements.requirement import Requirement, read_requirements
from railhil.scenarios.run_spec import RunSpec

pytest_plugins = "pytester"

#: Faults can violate the first one, not the second one.
SENTENCES = (
    '[[requirement]]\nid = "CUT"\nsays = "never controller_level >= traction_cut"\n'
    '[[requirement]]\nid = "BACK"\nsays = "never true_speed < -1 km/h"\n'
)


def write_short(folder: Path) -> None:
    (folder / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    (folder / "mine.toml").write_text(SENTENCES, encoding="utf-8")


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> HuntOutcome:
    folder = tmp_path_factory.mktemp("hunt")
    write_short(folder)
    return railhil.hunt(
        folder / "short.toml", requirements=folder / "mine.toml", runs=8, seed=3, shrink=False, tighten=True,
        out=folder / "hunt",
    )  # fmt: skip


@pytest.mark.slow
def test_what_was_found_stands_in_its_attributes(found: HuntOutcome) -> None:
    assert found.violated == ("CUT",)
    case = found.cases[0]
    assert case.requirement == "CUT"
    assert case.file.is_file()
    assert (case.folder / "certificate.json").is_file()
    assert repr(found).startswith(f"<violated: CUT by {case.faults[0]}")
    kept = found.requirements["BACK"]
    assert (kept.verdict, kept.violated, kept.unit) == ("not found", False, "m/s")
    assert kept.margin is not None
    assert kept.margin > 0
    assert "CUT  VIOLATED in " in found._repr_html_()


@pytest.mark.slow
def test_the_tightest_bound_that_held_is_a_sentence_that_the_nearest_case_keeps(found: HuntOutcome) -> None:
    (tight,) = found.summary["tight"]
    assert (tight["id"], tight["was"], tight["is_confirmed"]) == ("BACK", "-1 km/h", True)
    (requirement,) = read_requirements(found.folder / "tight.toml")
    assert requirement.says == tight["says"] == f"never true_speed < {tight['bound']}"
    limit_kmh = float(tight["bound"].removesuffix(" km/h"))
    assert limit_kmh == pytest.approx(-1 + 3.6 * found.requirements["BACK"].margin, abs=1e-3)


@pytest.mark.slow
def test_the_page_is_written_again_from_the_folder(found: HuntOutcome, tmp_path: Path) -> None:
    written = (found.folder / "report.html").read_bytes()
    recorded = json.loads((found.folder / "hunt.json").read_text())["recorded"]
    assert f"UTC on {recorded['host']} by {recorded['operator']} with railhil " in written.decode()
    done = railhil_command("report", found.folder, "--out", tmp_path / "again.html")
    assert done.exit_code == 0, done.err
    assert (tmp_path / "again.html").read_bytes() == written
    listed = railhil_command("verify", found.folder)
    assert listed.exit_code == 0, listed.err


@pytest.mark.slow
def test_the_file_of_a_case_is_a_scenario_of_railhil_run(found: HuntOutcome, tmp_path: Path) -> None:
    case = found.cases[0]
    mine = found.folder.parent / "mine.toml"
    again = railhil.run(case.file, seed=case.seed, requirements=mine, out=tmp_path / "run")
    assert again.frames_sha256 == case.frames_sha256
    assert again.requirements["CUT"].violated
    assert not again.requirements["CUT"].kept
    assert again.requirements["BACK"].kept
    assert again.requirements["BACK"].unit == "m/s"


def test_a_sentence_about_faults_sees_those_of_the_case(tmp_path: Path) -> None:
    write_short(tmp_path)
    sentence = Requirement("F", "whenever fault, within 1 s train_level >= hold")
    base = RunSpec(str(tmp_path / "short.toml"), bus="local")
    judged = run_case(base, [sentence], ("TRN_SPEED loss @1s for 30ms",), 0)
    assert [(one.antecedent_met, one.trigger_s) for one in judged.outcomes] == [(1, 1.0)]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"runs": 0}, "railhil.hunt: runs: found 0"),
        ({"strategy": "best"}, "railhil.hunt: strategy: found 'best'"),
        ({"requirements": 5}, "railhil.hunt: requirements: found 5, allowed a file"),
        ({"only": "XY"}, "railhil.hunt: only: found 'XY'"),
        ({"controller": "nobody"}, "railhil.hunt: controller: found 'nobody'"),
        ({"jobs": 0}, "railhil.hunt: jobs: found 0"),
    ],
)
def test_bad_arguments_are_refused_in_the_words_of_the_call(arguments: dict[str, object], said: str) -> None:
    with pytest.raises(railhil.InputError) as refused:
        railhil.hunt("yizhuang_05", **arguments)  # type: ignore[arg-type]
    assert str(refused.value).startswith(said)


@pytest.mark.slow
@pytest.mark.long
def test_a_test_that_hunts_tells_and_attaches_the_least_case(pytester: pytest.Pytester) -> None:
    write_short(pytester.path)
    pytester.makepyfile(
        test_suite="""
        import pytest
        pytestmark = pytest.mark.railhil(scenario="short.toml")

        def test_hunt(bench):
            assert not bench.hunt(runs=7, seed=3, requirements="mine.toml", only="CUT").violated

        @pytest.mark.railhil(faults=["TRN_SPEED loss @1s for 1s"])
        def test_has_no_faults_of_its_own(bench):
            bench.hunt()
        """
    )
    done = run_suite(pytester.path, "--junit-xml=report.xml", "--railhil-runs=kept")
    done.assert_outcomes(failed=2)
    text = "\n".join(done.outlines)
    assert "<violated: CUT by " in text
    assert "bench.hunt: faults: found ('TRN_SPEED loss @1s for 1s',)" in text.replace("[", "(").replace("]", ",)")
    attached, *_ = {line for line in done.outlines if "[[ATTACHMENT|" in line and line.endswith("CUT-1.toml]]")}
    assert Path(attached.strip()[len("[[ATTACHMENT|") : -2]).is_file()
    facts = dict(properties(pytester.path / "report.xml")["test_hunt"])
    assert facts["hunt"].startswith("<violated: CUT by ")
    assert len(facts["hunt.frames_sha256"]) == 64
