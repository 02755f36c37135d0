"""A run folder is self-contained evidence: it is judged without other files, on any machine, by this version and by
later ones."""

from __future__ import annotations

import dataclasses
import json
import lzma
import shutil
from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.paths import ROOT, TEST_DATA
from hil_tests.support.recordings import recorded_folder
from railhil.common.errors import InputError
from railhil.dbc import ContractError, recorded_contract, wire_contract
from railhil.judge.record import checked_record
from railhil.record.hash_list import write_hash_list
from railhil.record.run_folder import write_inputs
from railhil.scenarios.layers import DATA
from railhil.scenarios.load import load
from railhil.scenarios.scenario_documents import find_earlier_scenario, read_scenario, sha256_0_1_0
from railhil.systems.ato.judge.score import score
from railhil.systems.ato.scenario import model
from railhil.systems.ato.scenario.canonical import judged_sha256, scenario_sha256
from railhil.systems.ato.scenario.kind import document, scenario_of
from railhil.systems.ato.scenario.model import Scenario

_FOLDERS = sorted(path.parent for path in TEST_DATA.glob("runs_*/*/frames.log.xz"))
_FROM_THE_LOG = ("verdict", "scores", "signed", "overspeed_mps", "failures", "ended")
_EARLIER = json.loads((DATA / "history" / "railhil_0.1.0.json").read_text())


@pytest.fixture(params=_FOLDERS, ids=lambda path: path.name)
def earlier(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A run folder as an earlier version left it: of 0.1.0 without scenario and port table, later without a list of
    hashes."""
    folder = tmp_path / request.param.name
    shutil.copytree(request.param, folder)
    (folder / "frames.log").write_bytes(lzma.decompress((folder / "frames.log.xz").read_bytes()))
    (folder / "frames.log.xz").unlink()
    return folder


def test_folders_of_earlier_versions_are_kept() -> None:
    assert [path.parent.name for path in _FOLDERS] == ["runs_0.1.0"] * 3 + ["runs_without_list"]


@pytest.mark.parametrize("earlier", [_FOLDERS[-1]], indirect=True)
def test_a_port_table_of_wire_version_5_is_kept(earlier: Path) -> None:
    """For folders that have none: in version 6 the plant repeats PLT_IDENT."""
    wanted = json.loads((earlier / "score.json").read_text())
    (earlier / "ports.toml").unlink()
    (earlier / "railhil.dbc").unlink()
    assert checked_record(str(earlier), None).score.verdict == wanted["verdict"]
    assert json.loads((earlier / "certificate.json").read_text())["dbc_sha256"] != wire_contract().sha256


def test_a_folder_of_an_earlier_version_has_the_same_scores_to_the_digit(earlier: Path) -> None:
    wanted = json.loads((earlier / "score.json").read_text())
    found = checked_record(str(earlier), None).score.as_json()
    assert {key: found[key] for key in _FROM_THE_LOG} == {key: wanted[key] for key in _FROM_THE_LOG}


@pytest.mark.long_after(1)
def test_a_folder_of_an_earlier_version_gets_its_report(earlier: Path) -> None:
    done = railhil("report", earlier)
    assert done.exit_code == 0, done.err
    assert (earlier / "report.html").stat().st_size > 50_000


@pytest.mark.parametrize("sha256", _EARLIER)
def test_scenarios_of_version_0_1_0_have_the_hash_that_they_are_found_by(sha256: str) -> None:
    found = find_earlier_scenario(sha256)
    assert found is not None
    assert sha256_0_1_0(_EARLIER[sha256]) == sha256 == found.sha256


def _judged(folder: Path) -> tuple[Scenario, object]:
    record = checked_record(str(folder), None)
    return record.scenario, record.trace


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run whose scenario is a file of the user's, which is then gone."""
    folder = tmp_path_factory.mktemp("own")
    file = folder / "mine.toml"
    file.write_text('extends = "yizhuang_12_ciqu_nan_ciqu"\nname = "mine"\ntitle = "Mine"\n')
    run = recorded_folder(load(str(file)), folder / "run")
    file.unlink()
    assert run.verdict in ("PASS", "FAIL")
    return folder / "run"


@pytest.fixture
def mine(own: Path, tmp_path: Path) -> Path:
    """A copy of that folder, as on another machine."""
    return Path(shutil.copytree(own, tmp_path / "elsewhere"))


@pytest.mark.slow
def test_the_folder_alone_is_enough(mine: Path) -> None:
    wanted = json.loads((mine / "score.json").read_text())
    found = score(*_judged(mine)).as_json()
    assert {key: found[key] for key in _FROM_THE_LOG} == {key: wanted[key] for key in _FROM_THE_LOG}
    assert railhil("report", mine).exit_code == 0


@pytest.mark.slow
def test_also_when_ports_have_come_since(mine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another wire contract than today's: one port more, and one signal elsewhere."""
    wanted = score(*_judged(mine))
    today = wire_contract()
    added = dataclasses.replace(today.port("SIM_TRUTH"), name="SIM_TRUTH", address=0x3F0)
    ports = tuple(added if port.name == added.name else port for port in today.ports)
    later = dataclasses.replace(today, ports=ports, sha256="0" * 64)
    monkeypatch.setattr("railhil.scenarios.system.system_contract", lambda table: later)
    assert load("yizhuang_05").installed_system.contract is later
    assert score(*_judged(mine)) == wanted


def test_limits_changed_in_the_folder_are_noticed(mine: Path) -> None:
    fields = json.loads((mine / "scenario.json").read_text())
    fields["plan"]["stop_error_max_m"] = 100.0
    (mine / "scenario.json").write_text(json.dumps(fields))
    write_hash_list(mine)
    with pytest.raises(
        InputError, match=r"scenario.json: judged_sha256: found '[0-9a-f]+', allowed [0-9a-f]+ .*nobody changed"
    ):
        checked_record(str(mine), None)


def test_a_run_changed_in_the_folder_is_noticed(mine: Path) -> None:
    fields = json.loads((mine / "scenario.json").read_text())
    fields["train"]["mass_kg"] *= 1.001
    (mine / "scenario.json").write_text(json.dumps(fields))
    write_hash_list(mine)
    with pytest.raises(InputError, match=r"scenario.json: sha256: "):
        checked_record(str(mine), None)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "cannot be read"),
        ("[]", "has no JSON object"),
        ("{}", "name: Field required"),
        ('{"a": ' * 5000, "cannot be read"),
    ],
)
def test_a_damaged_scenario_gives_one_line(mine: Path, text: str, words: str) -> None:
    (mine / "scenario.json").write_text(text)
    write_hash_list(mine)
    with pytest.raises(InputError, match=words):
        checked_record(str(mine), None)


def test_an_unknown_key_is_refused(lvshun: Scenario, tmp_path: Path) -> None:
    fields = json.loads(json.dumps(document(lvshun)))
    fields["train"]["colour"] = "red"
    with pytest.raises(InputError, match=r"train.colour: a key that no scenario has"):
        scenario_of(fields, tmp_path / "scenario.json")


def test_another_dbc_in_the_folder_is_noticed(mine: Path) -> None:
    (mine / "railhil.dbc").write_text((mine / "railhil.dbc").read_text() + "\n")
    write_hash_list(mine)
    with pytest.raises(ContractError, match=r"railhil.dbc: sha256: found \w+, allowed \w+, as in the certificate"):
        checked_record(str(mine), None)


def test_a_contract_that_no_version_had_gives_one_line(mine: Path) -> None:
    certificate = json.loads((mine / "certificate.json").read_text())
    certificate["dbc_sha256"] = "0" * 64
    (mine / "certificate.json").write_text(json.dumps(certificate))
    (mine / "ports.toml").unlink()
    write_hash_list(mine)
    with pytest.raises(ContractError, match=r"DBC: found sha256 0+, allowed one of a version of railhil"):
        checked_record(str(mine), None)


@pytest.mark.parametrize("name", ["lvshun_tieshan", "yizhuang_05_yizhuang_qiao_yizhuang_wenhuayuan"])
def test_a_scenario_comes_back_as_it_was(name: str, tmp_path: Path) -> None:
    scenario = load(name)
    write_inputs(tmp_path, scenario, None)
    assert read_scenario(tmp_path / "scenario.json") == scenario


def test_the_hash_covers_what_the_run_uses(lvshun: Scenario) -> None:
    plan = dataclasses.replace(lvshun.plan, stop_error_max_m=1.0)
    judged = dataclasses.replace(lvshun, plan=plan)
    said = dataclasses.replace(lvshun, title="Another", assumptions=())
    moved = dataclasses.replace(lvshun, plan=dataclasses.replace(lvshun.plan, distance_m=2941.0))
    assert scenario_sha256(judged) == scenario_sha256(said) == scenario_sha256(lvshun) != scenario_sha256(moved)
    assert judged_sha256(said) == judged_sha256(lvshun) != judged_sha256(judged)


#: A default is no part of the hash: it must never change. A field that is to mean something else gets another name.
_DEFAULTS = {
    "Effort": {"power_max_w": None, "curve": ()},
    "Train": {"notch_max": 7.0, "speed_limit_mps": 1000.0, "service_braking_mps2": 1.0, "gravity_mps2": 9.81},
    "Line": {"balises": ()},
    "RunPlan": {"overtime_max_s": 10.0},
    "Timing": {
        "base_tick_ns": 10_000_000,
        "control_period_ns": 500_000_000,
        "loop_delay_s": 0.04,
        "port_period_ns": {},
    },
    "Sensors": {"wheel_factor": 1.0},
    "WatchLimits": {
        "hold_ms": 20,
        "traction_cut_ms": 64,
        "service_brake_ms": 256,
        "emergency_ms": 1000,
        "overspeed_margin_mps": 5 / 3.6,
    },
}


@pytest.mark.parametrize("name", _DEFAULTS)
def test_defaults_stay(name: str) -> None:
    found = {}
    for field in dataclasses.fields(getattr(model, name)):
        if field.default is not dataclasses.MISSING:
            found[field.name] = field.default
        elif field.default_factory is not dataclasses.MISSING:
            found[field.name] = field.default_factory()
    assert {key: found[key] for key in _DEFAULTS[name]} == _DEFAULTS[name]


def test_port_tables_of_earlier_versions_can_be_read(tmp_path: Path) -> None:
    kept = sorted((ROOT / "dbc" / "history").glob("*.toml"))
    assert kept
    for path in kept:
        contract = recorded_contract(tmp_path, path.stem, wire_contract())
        assert contract.sha256 == path.stem
        assert {"SIM_TRUTH", "RUN_EVENT", "NOTCH_CMD", "PLT_IDENT"} <= {port.name for port in contract.ports}
