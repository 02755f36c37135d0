"""The wheels of a release: ``python -m hil_tests.wheels [--compiled] [--out FOLDER]`` (``make wheels``).

Of what is committed: the pure wheel, which runs everywhere; with ``--compiled`` also the one that mypyc and gcc make
for this machine's processor and Python (some minutes).

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

from hil_tests.support.paths import ROOT
from hil_tests.support.same_lines import wheel
from railhil.machines import debian


def fits(name: str, compiled: bool) -> bool:
    """Whether the name of a wheel is that of this build: of any Python and processor, or of this processor."""
    if compiled:
        return name.endswith(f"_{platform.machine()}.whl") and "-none-" not in name
    return name.endswith("-py3-none-any.whl")


def made(out: Path, compiled: bool) -> bool:
    """Build one wheel into ``out``; print its name and SHA-256, and whether it is what was asked for."""
    with tempfile.TemporaryDirectory() as scratch:
        built = wheel(Path(scratch), {"RAILHIL_COMPILED": "1" if compiled else "0"})
        content = built.read_bytes()
    (out / built.name).write_bytes(content)
    print(f"{hashlib.sha256(content).hexdigest()}  {built.name}", flush=True)
    return fits(built.name, compiled)


def main(words: list[str]) -> int:
    """Build them.

    Raises:
        CapabilityError: there is no compiler.
    """
    parser = argparse.ArgumentParser(prog="python -m hil_tests.wheels", description="the wheels of a release")
    parser.add_argument("--compiled", action="store_true", help="also the compiled wheel of this processor")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder (default dist)")
    options = parser.parse_args(words)
    options.out.mkdir(parents=True, exist_ok=True)
    if options.compiled:
        debian.install_compilers()
    try:
        right = [made(options.out, compiled) for compiled in ((False, True) if options.compiled else (False,))]
    except (subprocess.SubprocessError, debian.MachineError) as error:
        debian.say(f"wheels: {error}")
        return 1
    return 0 if all(right) else 1


if __name__ == "__main__":
    sys.exit(debian.guarded("wheels", lambda: main(sys.argv[1:])))
