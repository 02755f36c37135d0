"""Hashes of every law on a Raspberry Pi's processor and on this one: ``python -m hil_tests.arm64 [SYSTEM ...]``

Both make the runs of :mod:`hil_tests.hashes`, aarch64 in an emulator; a line that differs is printed and fails.

Exit code: 0 if all lines are equal, 1 if not; 77 when this host cannot emulate aarch64 (one line says why).
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from pathlib import Path

from hil_tests.support.paths import ROOT
from railhil.machines import debian
from railhil.machines.arm64 import Arm64Python

_PROGRAM = ROOT / "hil_tests" / "hashes.py"


def _wheel(folder: Path) -> Path:
    debian.run_tool([sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", str(folder), str(ROOT)])
    return next(folder.glob("*.whl"))


def compared(systems: Sequence[str]) -> int:
    """Run both and compare; returns the exit code.

    Raises:
        CapabilityError: aarch64 cannot be emulated here.
    """
    requirements = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        python = Arm64Python(requirements, [_wheel(folder)], folder / "site")
        with (
            python.start([str(_PROGRAM), *systems]) as there,
            subprocess.Popen([sys.executable, str(_PROGRAM), *systems], stdout=subprocess.PIPE, text=True) as here,
        ):
            assert there.stdout is not None
            assert here.stdout is not None
            equal = different = 0
            for ours, theirs in zip(here.stdout, there.stdout, strict=True):
                if ours == theirs:
                    equal += 1
                else:
                    different += 1
                    print(f"here    {ours}aarch64 {theirs}", end="", flush=True)
    failed = different or not equal or here.returncode or there.returncode
    print(f"{equal} equal, {different} different on aarch64 and here")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(debian.guarded("arm64", lambda: compared(sys.argv[1:])))
