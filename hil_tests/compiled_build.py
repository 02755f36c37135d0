"""Hashes of every law with the compiled build and without it: ``python -m hil_tests.compiled_build [SYSTEM ...]``

Builds the wheel with mypyc (gcc; some minutes), unpacks it beside this environment's libraries and makes the runs of
:mod:`hil_tests.hashes` with it and with these sources; a line that differs is printed and fails. ``RAILHIL_PURE=1`` is
tried with it, and a campaign in two processes, which pass compiled objects to each other.

Exit code: 0 if all lines are equal, 1 if not; 77 without a compiler (one line says why).
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path
from subprocess import PIPE, Popen

from hil_tests.support.same_lines import HASHES, differences, wheel
from railhil.machines import debian

_BUILD = "import railhil.common.build as build; print(build.railhil_build())"
_CAMPAIGN = "import sys; from railhil.cli import main; sys.exit(main())"
_CAMPAIGN_WORDS = ["campaign", "yizhuang_05", "--runs", "6", "--laws", "ipfc", "--arithmetic", "float64", "--json"]


class _Environment:
    """This environment's libraries with the compiled railhil before them."""

    def __init__(self, site: Path) -> None:
        # A path file of its own would come after the checkout's.
        self._variables = {**os.environ, "PYTHONPATH": f"{site}{os.pathsep}{sysconfig.get_path('purelib')}"}

    def start(self, words: list[str], cwd: Path, **variables: str) -> Popen[str]:
        return Popen([sys.executable, *words], env={**self._variables, **variables}, cwd=cwd, stdout=PIPE, text=True)

    def said(self, words: list[str], cwd: Path, **variables: str) -> str:
        with self.start(words, cwd, **variables) as process:
            text, _ = process.communicate(timeout=600)
        if process.returncode != 0:
            raise debian.MachineError(f"{words[-1]} ended with {process.returncode}")
        return text.strip()


def compared(systems: list[str]) -> int:
    """Build, run and compare; returns the exit code.

    Raises:
        CapabilityError: there is no compiler.
    """
    debian.install_compilers()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        debian.say("compiled build: mypyc and gcc, some minutes")
        with zipfile.ZipFile(wheel(folder / "wheel", {"RAILHIL_COMPILED": "1"})) as archive:
            archive.extractall(folder / "site")
        environment = _Environment(folder / "site")
        builds = [environment.said(["-c", _BUILD], folder), environment.said(["-c", _BUILD], folder, RAILHIL_PURE="1")]
        print(f"build: {builds[0]}, with RAILHIL_PURE=1: {builds[1]}")
        campaigns = [_campaign(environment.said(words, folder)) for words in (_words("a"), _words("b", "--jobs", "2"))]
        print(f"campaign in one process and in two: {'equal' if campaigns[0] == campaigns[1] else 'different'}")
        code = differences(environment.start([HASHES, *systems], folder), "compiled", systems)
    return code if builds == ["compiled", "pure"] and campaigns[0] == campaigns[1] else 1


def _words(out: str, *options: str) -> list[str]:
    return ["-c", _CAMPAIGN, *_CAMPAIGN_WORDS, "--out", out, *options]


def _campaign(text: str) -> object:
    return json.loads(text)["laws"]


def main(systems: list[str]) -> int:
    """As :func:`compared`; a build that fails is one line."""
    try:
        return compared(systems)
    except subprocess.SubprocessError as error:
        debian.say(f"compiled build: {error}")
        return 1


if __name__ == "__main__":
    sys.exit(debian.guarded("compiled build", lambda: main(sys.argv[1:])))
