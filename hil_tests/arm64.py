"""Hashes of every law on a Raspberry Pi's processor and on this one.

``python -m hil_tests.arm64 [--law LAW] [SYSTEM ...]``: both make the runs of
:mod:`hil_tests.hashes`, aarch64 in an emulator; a line that differs is printed and fails.

Exit code: 0 if all lines are equal, 1 if not; 77 when this host cannot emulate aarch64 (one line says why).
"""

from __future__ import annotations

import sys
import tempfile
import tomllib
from pathlib import Path

from hil_tests.support.paths import ROOT
from hil_tests.support.same_lines import HASHES, differences, wheel
from railhil.machines import debian
from railhil.machines.arm64 import Arm64Python


def compared(words: list[str]) -> int:
    """Run both with these words of :mod:`hil_tests.hashes` and compare; returns the exit code.

    Raises:
        CapabilityError: aarch64 cannot be emulated here.
    """
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    requirements = [*project["dependencies"], *project["optional-dependencies"]["qp"]]
    with tempfile.TemporaryDirectory() as scratch:
        python = Arm64Python(requirements, [wheel(Path(scratch, "wheel"))], Path(scratch, "site"))
        return differences(python.start([HASHES, *words]), "aarch64", words)


if __name__ == "__main__":
    sys.exit(debian.guarded("arm64", lambda: compared(sys.argv[1:])))
