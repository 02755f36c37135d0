"""``make install``: a line for each step, and the exit code of pip."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from hil_tests import wheels
from hil_tests.support.paths import ROOT

_PIP = """#!/bin/sh
echo "$@" >"$0.arguments"
echo 'Collecting numpy>=1.26 (from railhil==0.1.0)'
echo 'Collecting rich'
echo '  Downloading rich.whl (2 MB)'
echo 'Building wheel for railhil (pyproject.toml): started'
echo 'Installing collected packages: numpy, rich, railhil'
exit "${PIP_EXIT:-0}"
"""


@pytest.mark.parametrize(
    ("name", "processor", "right"),
    [
        ("railhil-0.1.0-py3-none-any.whl", "", True),
        ("railhil-0.1.0-py3-none-any.whl", "x86_64", False),
        ("railhil-0.1.0-cp311-cp311-linux_x86_64.whl", "x86_64", True),
        ("railhil-0.1.0-cp311-cp311-linux_x86_64.whl", "", False),
        ("railhil-0.1.0-cp311-cp311-linux_x86_64.whl", "aarch64", False),
        ("railhil-0.1.0-cp311-cp311-linux_aarch64.whl", "aarch64", True),
    ],
)
def test_a_wheel_of_another_kind_than_asked_for_is_an_error(name: str, processor: str, right: bool) -> None:
    assert wheels.fits(name, processor) is right


@pytest.mark.parametrize(
    ("target", "wanted"),
    [(".installed", "-e .[report]"), (".installed-dev", "-e .[dev,report,campaign,dask]")],
)
def test_installing_says_what_it_does(tmp_path: Path, target: str, wanted: str) -> None:
    pip = tmp_path / "bin" / "pip"
    pip.parent.mkdir()
    pip.write_text(_PIP)
    pip.chmod(0o755)
    call = ["make", "--no-print-directory", f"VENV={tmp_path}", f"{tmp_path}/{target}"]
    done = subprocess.run(call, cwd=ROOT, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    first, *steps = done.stdout.splitlines()
    assert first.startswith("installing railhil ")
    assert steps == ["  fetching numpy>=1.26", "  fetching rich", "  building railhil", "  unpacking 3 packages"]
    assert (tmp_path / "bin" / "pip.arguments").read_text().rstrip().endswith(wanted)
    assert (tmp_path / target).exists()


def test_a_failed_installation_is_none(tmp_path: Path) -> None:
    pip = tmp_path / "bin" / "pip"
    pip.parent.mkdir()
    pip.write_text(_PIP)
    pip.chmod(0o755)
    call = ["make", "--no-print-directory", f"VENV={tmp_path}", f"{tmp_path}/.installed"]
    environment = {**os.environ, "PIP_EXIT": "3"}
    done = subprocess.run(call, cwd=ROOT, capture_output=True, text=True, check=False, timeout=60, env=environment)
    assert done.returncode == 2
    assert not (tmp_path / ".installed").exists()


def _setup(folder: Path, hook: str) -> subprocess.CompletedProcess[str]:
    """A hook of pip's for the compiled build, in an environment without mypyc."""
    shutil.copy(ROOT / "setup.py", folder)
    # It writes the stubs of the telegram classes.
    for name in ("bus", "railhil/wire"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    (folder / "railhil" / "__init__.py").touch()
    project = '[project]\nname = "railhil"\nversion = "0"\n[tool.setuptools.package-dir]\nrailhil = "railhil"\n'
    (folder / "pyproject.toml").write_text(project)
    program = f"import sys; sys.modules['mypyc'] = None; from setuptools import build_meta; print(build_meta.{hook})"
    variables = {**os.environ, "RAILHIL_COMPILED": "1", "RAILHIL_LABEL": ""}
    words = [sys.executable, "-c", program]
    return subprocess.run(words, cwd=folder, env=variables, capture_output=True, text=True, check=False, timeout=60)


@pytest.mark.slow
def test_the_compiled_build_asks_pip_for_mypy_and_is_never_pure_without_a_word(tmp_path: Path) -> None:
    """In pip's environment for builds, which has what a build asks for, and nothing else."""
    assert "'mypy>=1.11'" in _setup(tmp_path, "get_requires_for_build_wheel()").stdout
    refused = _setup(tmp_path, "build_wheel('.')")
    assert refused.returncode != 0
    assert "mypyc" in refused.stderr
    assert not list(tmp_path.glob("*.whl"))
