"""A missing library: one line with a command for this kind of installation."""

from __future__ import annotations

import importlib.metadata
import re
import shlex
import sys
import tomllib
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT
from railhil.common import extras
from railhil.common.exit_codes import USAGE, run_guarded
from railhil.common.extras import install_command, missing_library

_EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]


def _names(words: list[str]) -> list[str]:
    return sorted(word.split(">")[0] for word in words)


@pytest.mark.parametrize("extra", ["report", "campaign", "dask"])
def test_a_clone_and_a_wheel_install_into_the_python_that_runs(extra: str) -> None:
    words = shlex.split(install_command(extra))
    assert words[:4] == [sys.executable, "-m", "pip", "install"]
    assert _names(words[4:]) == _names(_EXTRAS[extra])


def test_dev_has_what_a_test_is_skipped_without() -> None:
    asked = {
        name
        for file in (ROOT / "hil_tests").rglob("test_*.py")
        for name in re.findall(r"importorskip\(\"(\w+)\"", file.read_text(encoding="utf-8"))
    }
    assert asked
    assert asked <= set(_names(_EXTRAS["dev"]))
    assert [word for word in _EXTRAS["dev"] if ">=" not in word] == []


def test_pipx_injects(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    (tmp_path / "pipx_metadata.json").touch()
    words = shlex.split(install_command("campaign"))
    assert words[:3] == ["pipx", "inject", "railhil"]
    assert _names(words[3:]) == _names(_EXTRAS["campaign"])


def test_an_environment_without_pip_is_one_of_uv(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras.importlib.util, "find_spec", lambda name: None)
    assert shlex.split(install_command("report"))[:5] == ["uv", "pip", "install", "--python", sys.executable]


def test_a_library_that_cannot_be_used_is_told_from_one_that_is_not_there() -> None:
    absent = str(missing_library("x", ModuleNotFoundError("No module named 'numba'", name="numba"), "campaign"))
    assert absent.startswith("x: numba is not installed; install it with ")
    assert absent.endswith(" install 'numba>=0.61' (the extra [campaign])")
    broken = str(missing_library("x", ImportError("Numba needs NumPy 2.3 or less", name="numba"), "campaign"))
    assert "numba is not installed, or cannot be used (Numba needs NumPy 2.3 or less); install it with " in broken


def test_all_that_is_missing_is_named_at_once_with_one_command(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of several extras; what is there is not named."""

    def only_pyarrow(name: str) -> object:
        if name not in ("pyarrow", "railhil"):
            raise importlib.metadata.PackageNotFoundError(name)
        return found(name)

    found = importlib.metadata.distribution

    monkeypatch.setattr(importlib.metadata, "distribution", only_pyarrow)
    error = ModuleNotFoundError("No module named 'numba'", name="numba")
    line = str(missing_library("railhil campaign", error, "campaign", "dask", "parquet"))
    assert line.startswith("railhil campaign: numba, cmaes, dask and distributed are not installed; install them with ")
    assert line.count(" install ") == 2
    words = shlex.split(line.partition(" -m pip install ")[2].partition(" (the extras [campaign], [dask], ")[0])
    assert _names(words) == ["cmaes", "dask", "distributed", "numba"]


@pytest.mark.parametrize("name", ["railhil", "railhil panel"])
def test_the_line_names_the_command_once(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    def work() -> int:
        error = ModuleNotFoundError("No module named 'websockets'", name="websockets")
        raise missing_library("railhil panel", error, "panel")

    assert run_guarded(name, work) == USAGE
    assert capsys.readouterr().err.startswith("railhil panel: websockets is not installed")
