"""A controller of somebody else that does not say what it is: unknown wherever its run is told, or as it is named."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.recordings import row_of
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bench import local_run
from railhil.bus.frame import Frame
from railhil.bus.ident import CtlIdent
from railhil.dbc import wire_contract
from railhil.judge.folder import write_folder
from railhil.judge.result import Result
from railhil.record.documents import read_certificate
from railhil.record.framelog import log_line
from railhil.record.run_folder import write_inputs
from railhil.record.telemetry import reported
from railhil.record.trace import Trace
from railhil.report.facts import facts_of
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec, StartUp
from railhil.systems.ato.scenario.model import Scenario


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    path = tmp_path_factory.mktemp("unknown") / "short.toml"
    path.write_text(RUN_2M_TOML)
    return load(path)


@pytest.fixture(scope="module")
def run(scenario: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Result:
    return local_run(scenario, tmp_path_factory.mktemp("run"))


def saying(run: Result, **values: int) -> Trace:
    """The record with another CTL_IDENT."""
    said, trace = run.trace.ident(CtlIdent), Trace(wire_contract())
    assert said is not None
    trace.add(CtlIdent.PORT, 0, replace(said, **values).encode())
    return trace


ZEROS = {"law": 0, "arithmetic": 0, "indexing": 0}
UNKNOWN = dict.fromkeys(("controller", "arithmetic", "indexing"), "unknown")


@pytest.mark.parametrize(
    ("how", "said", "expected"),
    [
        (StartUp(), ZEROS, {}),
        (StartUp(foreign=True), {}, {}),
        (StartUp(foreign=True), {"arithmetic": 0}, {"arithmetic": "unknown"}),
        (StartUp(foreign=True), ZEROS, UNKNOWN),
        (StartUp(attach=True), ZEROS, UNKNOWN),
        (StartUp(foreign=True, controller_name="ATO 3"), ZEROS, UNKNOWN | {"controller": "ATO 3"}),
        (StartUp(foreign=True, controller_name="ATO 3"), {}, {"controller": "ATO 3"}),
    ],
)
def test_what_is_not_confirmed_is_unknown(
    run: Result, how: StartUp, said: dict[str, int], expected: dict[str, str]
) -> None:
    assert reported(how, saying(run, **said)) == expected


def test_a_controller_that_was_never_heard_is_unknown() -> None:
    assert reported(StartUp(foreign=True), Trace(wire_contract())) == UNKNOWN


@pytest.mark.parametrize("name", ["", "ATO 3"])
def test_it_stands_in_certificate_score_junit_report_and_table(
    scenario: Scenario, run: Result, tmp_path: Path, name: str
) -> None:
    how = StartUp(foreign=True, controller_name=name)
    write_inputs(tmp_path, scenario, None)
    (tmp_path / "frames.log").write_text(log_line(0, Frame(0x7E0, b"")))
    spec = RunSpec(str(scenario.name), start_up=how)
    result = Result(
        scenario, spec, run.trace, run.score, exit_code=1, frames=1, frames_sha256=run.frames_sha256, first_frame_s=0.5,
        transport="railhil:hub", reported=reported(how, saying(run, **ZEROS)), folder=tmp_path,
    )  # fmt: skip
    write_folder(result)
    shown = name or "unknown"
    document = json.loads((tmp_path / "certificate.json").read_text())
    score = json.loads((tmp_path / "score.json").read_text())["run"]
    for place in (document, score):
        assert (place["controller"], place["arithmetic"], place["indexing"]) == (shown, "unknown", "unknown")
        assert place["asked"] == {"controller": "ipfc", "arithmetic": "iq", "indexing": "time"}
    assert document["arithmetic_profile"] is None
    assert ("--controller-name" in document["command"]) is bool(name)
    suite = ET.parse(tmp_path / "junit.xml").getroot()
    told = {one.get("name"): one.get("value") for one in suite.findall("properties/property")}
    assert (told["controller"], told["arithmetic"]) == (shown, "unknown")
    assert str(suite.get("name")).endswith(f".{shown}")
    found = row_of(tmp_path, read_certificate(tmp_path) or {}, scenario, run.trace, run.score)
    assert (found.label, found.published) == (shown, None)
    facts = dict(facts_of(found))
    assert (facts["Controller"], facts["Arithmetic"], facts["Set-point over"]) == (shown, "unknown", "unknown")
    assert facts["Other controller"].endswith("controller ipfc, arithmetic iq, indexing time")
    # What was asked for can be read again.
    assert RunSpec.from_json(document, tmp_path / "certificate.json") == spec


def test_a_name_is_only_for_a_controller_of_somebody_else(tmp_path: Path) -> None:
    done = railhil("run", "--bus", "local", "--controller-name", "mine", "--out", tmp_path / "run")
    assert done.exit_code == 2
    assert "--controller-name: used only with --no-controller" in done.one_line()


@pytest.mark.parametrize(("name", "folder"), [("", "other"), ("ATO 3/b", "ATO_3_b")])
def test_a_run_folder_has_a_name_that_is_no_law(name: str, folder: str) -> None:
    assert RunSpec(start_up=StartUp(foreign=True, controller_name=name)).folder_controller == folder
    assert RunSpec().folder_controller == "ipfc"
