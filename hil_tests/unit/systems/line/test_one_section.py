"""One section of a line as a run of ato: by the key ``section``, by ``--section``, and commands that take only that."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.support.cli import complaint, railhil
from hil_tests.support.paths import TEST_DATA
from railhil.cli.commands import parser
from railhil.cli.run import spec_of
from railhil.common.command_line import parse
from railhil.common.errors import InputError
from railhil.controller_node.command import main
from railhil.scenarios.layers import DATA
from railhil.scenarios.load import load, load_any
from railhil.systems.ato.scenario.canonical import scenario_sha256
from railhil.systems.ato.scenario.model import Scenario


def test_a_section_of_a_line_is_a_scenario_of_ato() -> None:
    section, run = load("yizhuang_out", settings=["section=5"]), load("yizhuang_05")
    assert type(section) is Scenario
    assert (section.line, section.target, section.train) == (run.line, run.target, run.train)
    assert section.name == "yizhuang_out_section_5"


def test_a_section_is_run_by_the_law_of_its_line_when_none_is_asked_for() -> None:
    def law_of(*more: str) -> str:
        given = ["run", "four_stops", "--section", "1", *more]
        return spec_of(parse(parser(given), given), {}).law.controller

    assert load("four_stops", settings=["section=1"]).usual_law == load_any("four_stops").usual_law == "ipfc_plus"
    assert load("yizhuang_05").usual_law == "ipfc"
    assert law_of() == "ipfc_plus"
    assert law_of("--controller", "tdmc") == "tdmc"


def test_a_node_that_is_started_by_hand_has_the_law_of_the_line_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["four_stops", "--set", "section=1", "--check"]) == 0
    assert '"ipfc_plus"' in capsys.readouterr().out


def test_the_law_of_a_section_changes_no_hash() -> None:
    section = load("yizhuang_out", settings=["section=5"])
    assert scenario_sha256(replace(section, law="")) == section.sha256


def test_a_section_claims_no_train_protection() -> None:
    section = " ".join(load("four_stops", settings=["section=1"]).assumptions)
    assert "train protection" not in section
    assert "not the real timetable" in section


def test_a_section_has_its_own_hash_and_a_document_that_restores_it() -> None:
    first, second = (load("four_stops", settings=[f"section={number}"]) for number in (1, 2))
    assert first.sha256 != second.sha256
    kind = first.installed_system.scenario_kind
    assert kind.restore(kind.document(first), Path("scenario.json")) == first


def test_a_section_between_served_stops_runs_through_the_passed_one() -> None:
    section = load("four_stops", settings=["section=2"])
    assert section.plan.distance_m == 2220.0
    assert [balise.surveyed_m for balise in section.line.balises if balise.surveyed_m < 1200.0] != []


def test_the_faults_of_a_section_are_those_of_ato() -> None:
    section = load_any("four_stops", ["section=1"], ["TRN_SPEED loss 30% @20s for 5s"])
    assert section.faults == ("TRN_SPEED loss 30% @20s for 5s",)


def test_a_file_can_name_a_section(tmp_path: Path) -> None:
    file = tmp_path / "own.toml"
    file.write_text('extends = "yizhuang_back"\nname = "own"\nsection = 13\n')
    assert load(file).plan.distance_m == 2631.0


def test_a_section_that_there_is_not_is_refused() -> None:
    with pytest.raises(InputError, match=r"^--set: section: found 3, allowed 1 to 2, a section of four_stops$"):
        load_any("four_stops", settings=["section=3"])


@pytest.mark.parametrize(
    "words", [["tune", "ipfc", "four_stops"], ["audit", "four_stops"], ["export-c", "ipfc", "four_stops", "--out", "c"]]
)
def test_a_command_that_takes_a_section_only_names_it(words: list[str], tmp_path: Path) -> None:
    message = complaint(railhil(*words, cwd=tmp_path))
    assert "one of its sections" in message
    assert "railhil run four_stops --section 1 runs it" in message


def test_the_command_that_is_named_instead_takes_the_file_that_was_given(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text((DATA / "runs" / "four_stops.toml").read_text())
    message = complaint(railhil("audit", "mine.toml", cwd=tmp_path))
    assert "railhil run mine.toml --section 1 runs it" in message


def test_the_option_names_the_section_in_the_list_of_scenarios() -> None:
    assert "four_stops_section_2" in railhil("scenarios", "four_stops", "--section", "2").out


@pytest.mark.slow
def test_the_run_of_a_section_is_repeated_from_its_folder(tmp_path: Path) -> None:
    run = ("run", TEST_DATA / "tiny_line.toml", "--section", "1", "--bus", "local")
    done = railhil(*run, "--no-report", "--out", "run", cwd=tmp_path)
    assert done.exit_code in (0, 1), done.err
    again = railhil("rerun", "run", cwd=tmp_path)
    assert again.exit_code == 0, again.err
    assert "same bytes" in again.out
