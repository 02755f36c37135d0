"""Hashes of every law on a Raspberry Pi's processor.

``python -m hil_tests.arm64 [--compiled] [WORD ...]``: an emulated aarch64 makes the runs of :mod:`hil_tests.hashes`,
whose words these are; a line that differs from the list is printed and fails. With ``--compiled`` the
emulator has the compiled build, which a cross compiler makes here, and makes each run with it and with its sources.

Exit code: 0 if all lines are equal, 1 if not; 77 when this host cannot emulate aarch64, or compile for it (one line
says why).
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from hil_tests.machines.arm64 import Arm64Python, cross_build
from hil_tests.support.paths import ROOT
from hil_tests.support.same_lines import HASHES, compare_hashes, wheel
from railhil.machines import debian

_TELLS = "import platform; from railhil.common.build import railhil_build; print(platform.machine(), railhil_build())"


def compared(words: list[str], compiled: bool) -> int:
    """Make the runs of these words of :mod:`hil_tests.hashes` and compare them with the list; returns the exit code.

    :param compiled: with the compiled build on aarch64, too.

    Raises:
        CapabilityError: aarch64 cannot be emulated here, or not compiled for.
    """
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    requirements = [*project["dependencies"], *extras["qp"], *extras["parquet"]]
    variables = {**cross_build(), "RAILHIL_COMPILED": "1"} if compiled else {}
    if compiled:
        debian.say("compiled build for aarch64: mypyc and gcc, some minutes")
    with tempfile.TemporaryDirectory() as scratch:
        python = Arm64Python(requirements, [wheel(Path(scratch, "wheel"), variables)], Path(scratch, "site"))
        # Each build says which one it is: a compiled one that cannot be loaded would pass as its sources.
        builds = {"compiled": "", "pure": "1"} if compiled else {"pure": ""}
        wrong = 0
        for build, pure in builds.items():
            with python.start(["-P", "-c", _TELLS], RAILHIL_PURE=pure) as told:
                said, _ = told.communicate()
            wrong += said.split() != ["aarch64", build]
            print(f"emulated: {said.strip()}, expected aarch64 {build}")
        # A program that it starts would not be emulated.
        words = ["--one-process", *words]
        runs = {build: python.start([HASHES, *words], RAILHIL_PURE=pure) for build, pure in builds.items()}
        wrong += sum(compare_hashes(run, f"aarch64, {build}", "--sample" in words) for build, run in runs.items())
    return 1 if wrong else 0


def main(words: list[str]) -> int:
    """As :func:`compared`; a build that fails is one line."""
    others = [word for word in words if word != "--compiled"]
    try:
        return compared(others, others != words)
    except subprocess.SubprocessError as error:
        debian.say(f"arm64: {error}")
        return 1


if __name__ == "__main__":
    sys.exit(debian.guarded("arm64", lambda: main(sys.argv[1:])))
