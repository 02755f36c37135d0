"""``railhil replay``: one node driven by a record, its frames compared with the recorded ones."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from hil_tests.support.cli import Railhil, complaint, railhil
from hil_tests.support.recordings import certified, tampered
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil import library
from railhil.bench import local_run
from railhil.record.framelog import read_log
from railhil.run.replay import replay
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.scenario_documents import read_scenario
from railhil.wire.ato import NotchCmd, TrnSpeed


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run folder of 2 m, perturbed, with the scenario's file beside it."""
    folder = tmp_path_factory.mktemp("short")
    (folder / "short.toml").write_text(RUN_2M_TOML)
    return library.run(folder / "short.toml", seed=3, perturbed=True, out=folder / "run").folder


@pytest.fixture
def copy(short: Path, tmp_path: Path) -> Path:
    """A copy of that folder that a test may change."""
    return shutil.copytree(short, tmp_path / "copy")


@pytest.mark.parametrize("node", ["controller", "plant"])
@pytest.mark.parametrize("certificate", [True, False])
def test_a_node_gives_what_is_recorded(here: Railhil, copy: Path, node: str, certificate: bool) -> None:
    """Without a certificate, seed and perturbation are those of the handshake."""
    asked = []
    if not certificate:
        (copy / "certificate.json").unlink()
        asked = ["--scenario", copy.parent / "short.toml"]
        asked[1].write_text(RUN_2M_TOML)
    done = here("replay", copy, "--node", node, "--json", *asked)
    assert done.exit_code == 0, done.err
    found = done.json
    assert found["same"]
    assert found["difference"] is None
    assert found["speed_factor"] > 0
    assert found["ports"].keys() >= ({"NOTCH_CMD", "CTL_STAT"} if node == "controller" else {"TRN_SPEED", "polls"})
    assert all(row["recorded"] == row["equal"] > 0 for row in found["ports"].values())


def test_another_answer_of_the_recorded_controller_is_decoded(here: Railhil, copy: Path) -> None:
    """As with a board whose notch differs once from that of our controller."""
    line = tampered(copy, NotchCmd.port().address, 40, 0)
    certified(copy, foreign=True)
    done = here("replay", copy, "--node", "controller")
    assert done.exit_code == 1
    said = done.out.splitlines()
    assert "times real time" in said[0]
    assert any(text.startswith("CTL_STAT: ") for text in said)
    assert f"first difference: line {line}, " in said[-1]
    assert "NOTCH_CMD (controller): NotchCmd " in said[-1]
    assert here("replay", copy, "--node", "controller", "--port", "CTL_STAT").exit_code == 0


def test_another_law_and_arithmetic_are_compared_with_the_record(here: Railhil, short: Path) -> None:
    other = here("replay", short, "--node", "controller", "--controller", "tdmc", "--json")
    assert other.exit_code == 1
    assert other.json["difference"]["frame"].startswith("CTL_IDENT")
    floating = here("replay", short, "--node", "controller", "--arithmetic", "float64", "--json").json
    assert floating["ports"]["NOTCH_CMD"]["recorded"] == other.json["ports"]["NOTCH_CMD"]["recorded"]


def test_the_plant_ends_where_it_no_longer_does_what_is_recorded(here: Railhil, copy: Path) -> None:
    """A changed reading is compared on; a frame of another kind ends the comparison."""
    line = tampered(copy, TrnSpeed.port().address, 40, 3)
    done = here("replay", copy, "--node", "plant", "--json")
    assert done.exit_code == 1
    assert (done.json["difference"]["line"], done.json["difference"]["frame"]) == (line, "TRN_SPEED (plant)")
    assert done.json["ports"]["TRN_SPEED"]["equal"] == done.json["ports"]["TRN_SPEED"]["recorded"] - 1
    record = list(read_log(copy / "frames.log"))
    del record[line - 1]
    found = replay("plant", record, read_scenario(copy / "scenario.json"), RunSpec(seed=3, perturbed=True))
    first = found.first(found.ports)
    assert first is not None
    assert first.line == line
    assert found.ports["TRN_SPEED"].recorded <= 41


@pytest.mark.parametrize("node", ["controller", "plant"])
def test_a_record_of_can_fd_is_replayed_in_that_form(tmp_path: Path, node: str) -> None:
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    scenario = load(tmp_path / "short.toml")
    run = local_run(scenario, tmp_path, fd=True)
    assert run.log is not None
    found = replay(node, list(read_log(run.log)), scenario, RunSpec())
    assert found.same(["NOTCH_CMD"] if node == "controller" else ["TRN_SPEED", "SIM_TRUTH"])


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    "fault", ["TRN_SPEED loss 30% @0s", "NOTCH_CMD delay 20ms jitter 20ms @1s", "controller kill @2s"]
)
def test_a_run_with_faults_is_repeated_and_replayed(here: Railhil, tmp_path: Path, fault: str) -> None:
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    folder = library.run(tmp_path / "short.toml", faults=[fault], out=tmp_path / "run").folder
    assert here("rerun", folder).exit_code == 0
    for node in ("controller", "plant"):
        done = here("replay", folder, "--node", node)
        assert done.exit_code == 0, done.out


def test_an_answer_that_is_not_recorded_is_counted(short: Path) -> None:
    """A recorded controller that missed a poll; ours answers it, and the next answers are compared with their own."""
    record = list(read_log(short / "frames.log"))
    answers = [place for place, (_, frame) in enumerate(record) if frame.can_id == NotchCmd.port().address]
    del record[answers[40]]
    found = replay("controller", record, read_scenario(short / "scenario.json"), RunSpec()).ports["NOTCH_CMD"]
    assert (found.unrecorded, found.equal, found.recorded) == (1, len(answers) - 1, len(answers) - 1)
    assert found.same


def test_a_record_that_goes_on_after_the_end_differs(short: Path) -> None:
    record = list(read_log(short / "frames.log"))
    scenario, spec = read_scenario(short / "scenario.json"), RunSpec(seed=3, perturbed=True)
    assert replay("plant", record[:2000], scenario, spec).same(["TRN_SPEED", "polls"]), "a record that was cut off"
    found = replay("plant", [*record, record[0]], scenario, spec)
    first = found.first(found.ports)
    assert first is not None
    assert (first.line, first.repeated) == (len(record) + 1, "")
    assert first.sentence.endswith("now the run has ended")


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--node", "controller", "--port", "NOTCH_CMB"], "did you mean NOTCH_CMD?"),
        (["--node", "controller", "--controller", "pfc"], "--controller: found 'pfc'"),
        (["--node", "supervisor"], "--node"),
    ],
)
def test_what_cannot_be_replayed_is_refused(here: Railhil, short: Path, words: list[str], line: str) -> None:
    assert line in complaint(here("replay", short, *words))


@pytest.mark.slow
def test_the_plant_of_a_run_in_real_time_is_refused(here: Railhil, tmp_path: Path) -> None:
    """Made by the command: a run in real time locks the memory of its process, which is large in the tests."""
    (tmp_path / "short.toml").write_text(RUN_2M_TOML)
    run = tmp_path / "run"
    words = ("--pace", "realtime", "--rate", "40", "--quiet", "--no-report", "--out", run)
    assert railhil("run", tmp_path / "short.toml", *words).exit_code in (0, 1, 3)
    assert "which answers came in time is not in the record" in complaint(here("replay", run, "--node", "plant"))
    assert here("replay", run, "--node", "controller").exit_code == 0
