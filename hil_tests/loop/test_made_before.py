"""What ``railhil new`` of commit 9f2e9f48 (version 0.1.0) wrote still runs, or one line says what to change."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from hil_tests.support.cli import railhil_process
from hil_tests.support.toy_system import certificate, install
from hil_tests.support.warm import run_module

pytestmark = pytest.mark.loop

MADE = Path(__file__).parents[1] / "data" / "made_by_0.1.0"
#: What its users are told to change: PLT_IDENT is repeated since version 6 of the wire.
_OLD = 'name = "PLT_IDENT"\naddress = 0x168\nf_code = 3\nperiod_ms = 0\n'
#: Their tests; the run in fixed point is made by the command here.
_OF_USERS = ("-q", "-p", "no:cacheprovider", "-k", "not iq")
_NEW = _OLD.replace("period_ms = 0", "period_ms = 1280")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of all that was made, with both distributions installed below ``site``."""
    folder = tmp_path_factory.mktemp("made") / "made"
    shutil.copytree(MADE, folder)
    return folder


def _installed(made: Path, name: str, folder: Path) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(install(made / name, folder))}


@pytest.mark.slow
def test_law(made: Path, tmp_path: Path) -> None:
    environment = _installed(made, "old_law", tmp_path / "law")
    words = ("run", "--controller", "old_law", "--bus", "local", "--no-report", "--out", tmp_path / "run")
    done = railhil_process(*words, environment=environment)
    assert done.returncode == 0, done.stderr
    assert certificate(tmp_path / "run")["frames_sha256"] == (
        "cc65101a590776762df818cc66e9e6f72fc7ce32fab9e57675d7564de029da48"
    )
    done = run_module("pytest", [*_OF_USERS, "test_old_law.py"], environment=environment, cwd=made / "old_law")
    assert done.returncode == 0, done.stdout


@pytest.mark.slow
def test_system(made: Path, tmp_path: Path) -> None:
    folder = made / "old_system"
    words = ("run", folder / "old_system.toml", "--bus", "local", "--no-report", "--out", tmp_path / "run")
    done = railhil_process(*words, environment=_installed(made, "old_system", tmp_path / "before"))
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert line.endswith("ports.toml: PLT_IDENT.period_ms: found 0, allowed 1280, as in every system")
    table = folder / "src" / "old_system" / "ports.toml"
    text = table.read_text(encoding="utf-8")
    assert text.count(_OLD) == 1
    table.write_text(text.replace(_OLD, _NEW), encoding="utf-8")
    environment = _installed(made, "old_system", tmp_path / "after")
    done = railhil_process(*words, environment=environment)
    assert done.returncode == 0, done.stderr
    done = run_module("pytest", [*_OF_USERS, "test_old_system.py"], environment=environment, cwd=folder)
    assert done.returncode == 0, done.stdout


@pytest.mark.slow
def test_scenario(made: Path, tmp_path: Path) -> None:
    """Its train passes the stop by 1.3 m with the usual law, then as now."""
    words = ("run", made / "old_scenario.toml", "--bus", "local", "--no-report", "--out", tmp_path / "run")
    done = railhil_process(*words, environment=os.environ)
    assert done.returncode == 1, done.stderr
    assert certificate(tmp_path / "run")["frames_sha256"] == (
        "aebbe4c64b385df72519a92c16904ce02a817c9f294f4131ebcf7c5c5d029637"
    )
