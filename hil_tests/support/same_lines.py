"""What two builds must print alike: the hashes of their runs, and what users do."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from subprocess import Popen

from hil_tests.support.paths import ROOT
from railhil.machines import debian

#: Prints the hashes of every law; needs only an installed railhil.
HASHES = str(ROOT / "hil_tests" / "hashes.py")
#: Prints what users do; needs the distributions that it names, too.
USES = str(ROOT / "hil_tests" / "uses.py")
#: What :data:`HASHES` prints, from the version that last meant to change a frame log.
FRAMES_SHA256 = ROOT / "hil_tests" / "data" / "frames_sha256.txt"


def wheel(folder: Path, variables: dict[str, str] | None = None) -> Path:
    """A wheel of what is committed here, built with these variables into the empty ``folder``."""
    words = ["-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", str(folder), "."]
    return _built(words, folder, variables)


def source_archive(folder: Path) -> Path:
    """The source archive of what is committed here, made in the empty ``folder``."""
    return _built(["-c", f"from setuptools import build_meta; build_meta.build_sdist({str(folder)!r})"], folder, None)


def _built(words: list[str], folder: Path, variables: dict[str, str] | None) -> Path:
    """The one file that Python, started with these words in a clone, leaves in the folder."""
    # setuptools leaves what it has compiled beside the sources.
    with tempfile.TemporaryDirectory() as scratch:
        debian.run_tool(["git", "clone", "-q", str(ROOT), scratch])
        debian.run_tool([sys.executable, *words], cwd=Path(scratch), environment_too=variables)
    (built,) = folder.iterdir()
    return built


def known_hashes() -> dict[str, str]:
    """SHA-256 of the frame log, or ``refused``, by the name of the run (:mod:`hil_tests.hashes`)."""
    lines = FRAMES_SHA256.read_text(encoding="utf-8").splitlines()
    return {name: found for name, _, found in (line.rpartition(" ") for line in lines)}


def compare_hashes(there: Popen[str], what: str, shown: bool = False) -> int:
    """Compare the hashes that the other process prints with those of the list; returns the exit code.

    :param shown: print every line, not only those that differ.
    """
    known = known_hashes()
    equal = different = 0
    with there:
        assert there.stdout is not None
        for line in there.stdout:
            name, _, found = line.rstrip("\n").rpartition(" ")
            same = found == known.get(name)
            equal, different = equal + same, different + (not same)
            if shown or not same:
                print(f"{what}: {name} {found}{'' if same else f', in the list {known.get(name)}'}", flush=True)
    print(f"{equal} equal, {different} different: {what} and {FRAMES_SHA256.name}")
    return 1 if different or not equal or there.returncode else 0


def compare_lines(there: Popen[str], here: Popen[str], what: str) -> int:
    """Compare what two processes print line by line; returns the exit code."""
    equal = different = 0
    with there, here:
        assert there.stdout is not None
        assert here.stdout is not None
        for ours, theirs in zip(here.stdout, there.stdout, strict=True):
            equal += ours == theirs
            if ours != theirs:
                different += 1
                print(f"here  {ours}{what} {theirs}", end="", flush=True)
    print(f"{equal} equal, {different} different: here and {what}")
    return 1 if different or not equal or here.returncode or there.returncode else 0
