"""The wheel with every supported Python version: equal logs, and error messages of one line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support import venvs
from hil_tests.support.venvs import Environment
from hil_tests.wheel.conftest import Built
from railhil.bench import local_run
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec

_IN_PROCESS = """\
import json, pathlib, sys
from railhil.bench import local_run
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
scenario, folder = load("short.toml"), pathlib.Path("local")
for arithmetic in sys.argv[1:]:
    (folder / arithmetic).mkdir(parents=True)
    print(local_run(scenario, folder / arithmetic, RunSpec(law=LawSpec("ipfc_plus", arithmetic), seed=7)).frames_sha256)
"""
_OTHERS = [version for version in venvs.VERSIONS if version != venvs.RUNNING]
if venvs.debian_version() is not None:
    _OTHERS.append(venvs.DEBIAN)


# The newest differs most; the others are long.
@pytest.fixture(
    scope="module",
    params=[pytest.param(one, marks=[pytest.mark.long] if one != venvs.VERSIONS[-1] else []) for one in _OTHERS],
)
def other(built: Built, request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Environment:
    """The wheel in another Python's environment, with the dependencies that it names and nothing else."""
    if request.param == venvs.DEBIAN:
        python, version = venvs.DEBIAN, venvs.debian_version()
        assert version is not None
    else:
        python, version = venvs.python_of(request.param), request.param
    folder = tmp_path_factory.mktemp("python")
    environment = Environment.make(folder, python, venvs.libraries_of(python, version), built.wheel)
    (environment.folder / "short.toml").write_text(QUICK_TOML, encoding="utf-8")
    return environment


def test_logs_have_equal_hashes(other: Environment, tmp_path: Path) -> None:
    arithmetics = ("iq", "float64")
    here = []
    for arithmetic in arithmetics:
        (tmp_path / arithmetic).mkdir()
        scenario = load(str(other.folder / "short.toml"))
        run = local_run(scenario, tmp_path / arithmetic, RunSpec(law=LawSpec("ipfc_plus", arithmetic), seed=7))
        here.append(run.frames_sha256)
    assert len(set(here)) == 2
    assert other.run("python", "-c", _IN_PROCESS, *arithmetics).split() == here


@pytest.mark.long
def test_command_in_three_processes(other: Environment, tmp_path: Path) -> None:
    expected = local_run(load(str(other.folder / "short.toml")), tmp_path, RunSpec(seed=3))
    exit_code = 1 if expected.score.failures else 0
    other.run("railhil", "run", "short.toml", "--seed", "3", "--out", "run", exit_code=exit_code)
    certificate = json.loads((other.folder / "run" / "certificate.json").read_text(encoding="utf-8"))
    assert certificate["frames_sha256"] == expected.frames_sha256


def test_unknown_choice_is_one_line(other: Environment) -> None:
    """Each version of argparse has its own words for it."""
    (line,) = other.complaint("railhil", "run", "--arithmetic", "nix").splitlines()
    assert line.startswith("railhil run: ")
    assert "--arithmetic" in line
    assert "nix" in line
