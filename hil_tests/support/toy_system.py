"""Distributions of laws and systems, including the toy system, each installed into a separate folder."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import Any

from hil_tests.support.cli import railhil_process
from hil_tests.support.warm import run_module

SOURCE = Path(__file__).parents[1] / "data" / "toy_system"
SCENARIO = SOURCE / "two_carts_2m.toml"
_BUILD = "import sys; from setuptools import build_meta; build_meta.build_wheel(sys.argv[1])"


def install_toy(folder: Path) -> Path:
    """:func:`install` of the toy system."""
    return install(SOURCE, folder)


def install(source: Path, folder: Path) -> Path:
    """Build a distribution's wheel offline and unpack it like an installer; returns the folder for PYTHONPATH."""
    copy, wheels, site = folder / "source", folder / "wheels", folder / "site"
    shutil.copytree(source, copy)
    wheels.mkdir()
    subprocess.run(
        [sys.executable, "-c", _BUILD, str(wheels)], cwd=copy, check=True, capture_output=True, text=True, timeout=120
    )
    (wheel,) = wheels.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    return site


def railhil(
    site: Path, *words: str | Path, cwd: Path | None = None, anew: bool = False
) -> subprocess.CompletedProcess[str]:
    """A railhil command of an environment in which the toy system is installed; ``anew`` as in
    :func:`hil_tests.support.cli.railhil`."""
    return railhil_process(*words, cwd=cwd, environment={**os.environ, "PYTHONPATH": str(site)}, anew=anew)


def python(site: Path, program: str, *words: str) -> list[Any]:
    """Output of a program in such an environment, one JSON document per line."""
    with tempfile.TemporaryDirectory(prefix="railhil-program-") as folder:
        (Path(folder) / "program_of_a_test.py").write_text(program, encoding="utf-8")
        environment = {**os.environ, "PYTHONPATH": f"{site}{os.pathsep}{folder}"}
        done = run_module("program_of_a_test", words, environment=environment)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def certificate(folder: Path) -> dict[str, object]:
    """The certificate of a run folder."""
    found: dict[str, object] = json.loads((folder / "certificate.json").read_text(encoding="utf-8"))
    return found
