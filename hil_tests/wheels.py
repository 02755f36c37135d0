"""The files of a release: ``python -m hil_tests.wheels [--compiled] [--aarch64] [--out FOLDER]``.

Of what is committed: the source archive and the pure wheel, which runs everywhere; with ``--compiled`` also the wheel
that mypyc and gcc make for this machine's processor and Python, with ``--aarch64`` the one that a cross compiler makes
for a Raspberry Pi (some minutes each).

Exit code: 0, 1 when a build fails or makes another kind of wheel than it should; 77 without a compiler.
"""

from __future__ import annotations

import argparse
import hashlib
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

from hil_tests.machines import tools
from hil_tests.machines.arm64 import cross_build
from hil_tests.support.paths import ROOT
from hil_tests.support.same_lines import source_archive, wheel
from railhil.machines import debian


def fits(name: str, processor: str) -> bool:
    """Whether the name of a wheel is that of a build for this processor; empty: of a pure one."""
    if processor:
        return name.endswith(f"_{processor}.whl") and "-none-" not in name
    return name.endswith("-py3-none-any.whl")


def keep(built: Path, out: Path) -> None:
    """Move a file into ``out``; print its SHA-256 and its name."""
    content = built.read_bytes()
    (out / built.name).write_bytes(content)
    print(f"{hashlib.sha256(content).hexdigest()}  {built.name}", flush=True)


def made(out: Path, processor: str, variables: dict[str, str]) -> bool:
    """Build one wheel with these variables into ``out``; print its name and SHA-256, and return whether it is for this
    processor."""
    with tempfile.TemporaryDirectory() as scratch:
        built = wheel(Path(scratch), {**variables, "RAILHIL_COMPILED": "1" if processor else "0"})
        keep(built, out)
    return fits(built.name, processor)


def main(words: list[str]) -> int:
    """Build them.

    Raises:
        CapabilityError: there is no compiler.
    """
    parser = argparse.ArgumentParser(
        prog="python -m hil_tests.wheels", description="the source archive and the wheels of a release"
    )
    parser.add_argument("--compiled", action="store_true", help="also the compiled wheel of this processor")
    parser.add_argument("--aarch64", action="store_true", help="also the compiled wheel for aarch64 (Python 3.11)")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder (default dist)")
    options = parser.parse_args(words)
    options.out.mkdir(parents=True, exist_ok=True)
    # For each processor, the variables of its build.
    wanted: dict[str, dict[str, str]] = {"": {}}
    if options.compiled:
        tools.install_compilers()
        wanted[platform.machine()] = {}
    if options.aarch64:
        wanted["aarch64"] = cross_build()
    try:
        with tempfile.TemporaryDirectory() as scratch:
            keep(source_archive(Path(scratch)), options.out)
        right = [made(options.out, processor, variables) for processor, variables in wanted.items()]
    except (subprocess.SubprocessError, debian.MachineError) as error:
        debian.say(f"wheels: {error}")
        return 1
    return 0 if all(right) else 1


if __name__ == "__main__":
    sys.exit(debian.guarded("wheels", lambda: main(sys.argv[1:])))
