"""Two programs that must print the same lines."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from subprocess import PIPE, Popen

from hil_tests.support.paths import ROOT
from railhil.machines import debian

#: Prints the hashes of every law; needs only an installed railhil.
HASHES = str(ROOT / "hil_tests" / "hashes.py")
#: Prints what users do; needs the distributions that it names, too.
USES = str(ROOT / "hil_tests" / "uses.py")


def wheel(folder: Path, variables: dict[str, str] | None = None) -> Path:
    """A wheel of what is committed here, built with these variables into the empty ``folder``."""
    words = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", str(folder), "."]
    # setuptools leaves what it has compiled beside the sources.
    with tempfile.TemporaryDirectory() as scratch:
        debian.run_tool(["git", "clone", "-q", str(ROOT), scratch])
        debian.run_tool(words, cwd=Path(scratch), environment_too=variables)
    return next(folder.glob("*.whl"))


def differences(
    there: Popen[str],
    what: str,
    words: list[str],
    *,
    program: str = HASHES,
    environment: Mapping[str, str] | None = None,
) -> int:
    """Compare what the other process prints with what this Python prints for ``program``; returns the exit code.

    :param environment: of this Python; None: that of this process.
    """
    equal = different = 0
    with there, Popen([sys.executable, program, *words], env=environment, stdout=PIPE, text=True) as here:
        assert there.stdout is not None
        assert here.stdout is not None
        for ours, theirs in zip(here.stdout, there.stdout, strict=True):
            equal += ours == theirs
            if "--sample" in words:
                print(f"sample, here and {what}: {ours}", end="", flush=True)
            if ours != theirs:
                different += 1
                print(f"here  {ours}{what} {theirs}", end="", flush=True)
    print(f"{equal} equal, {different} different: here and {what}")
    return 1 if different or not equal or here.returncode or there.returncode else 0
