"""A controller in Python of the user in campaigns: beside laws, through the nodes, loaded only where it is named."""

from __future__ import annotations

import json
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import pytest

import railhil
from hil_tests.support.cli import railhil as command
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.common.errors import InputError

CODE = """
from pathlib import Path

Path(__file__).with_name("loaded").touch()

def step(reading):
    return 3.6 * (reading.set_point_mps - reading.speed_mps)

def local():
    return lambda reading: 0
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("given")
    (made / "mine.py").write_text(CODE, encoding="utf-8")
    (made / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    done = command("campaign", "short.toml", "--laws", "ipfc,mine.py:step", *SHORT, "--out", "made", cwd=made)
    assert done.exit_code == 0, done.err
    return made


SHORT = ("--runs", "2", "--chunk", "1", "--jobs", "2", "--engine", "processes")


def laws_of(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["laws"]
    return found


def test_it_stands_beside_a_law_and_its_file_has_a_hash(folder: Path) -> None:
    ipfc, mine = laws_of(folder / "made")
    assert (ipfc, mine.partition("@")[0]) == ("ipfc", "mine-step")
    manifest = json.loads((folder / "made" / "campaign.json").read_text(encoding="utf-8"))
    assert list(manifest["given_controllers"][mine]["files"]) == ["mine.py"]
    assert manifest["campaign"]["laws"][1]["law_sha256"] == manifest["given_controllers"][mine]["sha256"]


def test_the_bench_gives_the_same_runs_and_the_file_is_named_again(folder: Path) -> None:
    refused = command("campaign", "--verify", "made", cwd=folder)
    assert (refused.exit_code, "code, which no file can load" in refused.one_line()) == (2, True)
    laws = "ipfc,mine.py:step"
    again = command("campaign", "--verify", "made", "--laws", laws, "--runs", "4", cwd=folder)
    assert (again.exit_code, "4 of 4 runs are the same" in again.out) == (0, True), again.out + again.err
    for words in (("--resume", "made"), ("--resume", "made", "--laws", "ipfc,other.py:step")):
        (folder / "other.py").write_text(CODE.replace("3.6", "3.7"), encoding="utf-8")
        refused = command("campaign", *words, cwd=folder)
        assert refused.exit_code == 2
        assert refused.one_line()
    assert command("campaign", "--resume", "made", "--laws", laws, cwd=folder).exit_code == 0


def test_the_report_loads_no_code(folder: Path) -> None:
    (folder / "loaded").unlink(missing_ok=True)
    assert command("report", "made", cwd=folder).exit_code == 0
    assert not (folder / "loaded").exists()
    assert "mine-step@" in (folder / "made" / "report.html").read_text(encoding="utf-8")


def test_functions_of_a_file_are_laws_in_a_call(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = spec_from_file_location("mine_of_a_test", folder / "mine.py")
    assert found is not None
    assert found.loader is not None
    module = module_from_spec(found)
    monkeypatch.setitem(sys.modules, found.name, module)
    found.loader.exec_module(module)
    for law in (module.local(), 3):
        with pytest.raises(InputError, match=r"a name, FILE.py:NAME, or a function or class at the top of a file"):
            railhil.campaign(folder / "short.toml", laws=[law])
    outcome = railhil.campaign(folder / "short.toml", laws=module.step, runs=2, out=folder / "called")
    (mine,) = outcome.laws
    assert laws_of(outcome.folder)[mine]["scores"] == laws_of(folder / "made")[mine]["scores"]


def test_another_arithmetic_is_refused(folder: Path) -> None:
    refused = command("campaign", "short.toml", "--laws", "mine.py:step", "--arithmetic", "iq", *SHORT, cwd=folder)
    assert (refused.exit_code, "allowed float64, that of mine.py:step" in refused.one_line()) == (2, True)
