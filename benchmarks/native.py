"""The C loop, compiled if there is a compiler."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from benchmarks.figures import MeasurementError, Missing

_SOURCE = Path(__file__).parent / "c" / "loop.c"
_COMPILERS = ("cc", "gcc", "clang")
_COMPILE_S = 60.0


def compiler() -> str | None:
    """Path of the first C compiler found."""
    return next(filter(None, map(shutil.which, _COMPILERS)), None)


def c_loop(folder: Path, source: Path = _SOURCE) -> Path | Missing:
    """The loop, ``c/loop.c``, compiled into ``folder`` with -O2, or the reason that there is no compiler.

    :raises MeasurementError: it does not compile.
    """
    found = compiler()
    if found is None:
        return Missing("the plain C loop", f"no C compiler ({', '.join(_COMPILERS)}): no ratio to C below")
    program = folder / "loop"
    command = [found, "-O2", "-std=c99", "-Wall", "-Wextra", "-Werror", "-o", str(program), str(source)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=_COMPILE_S, check=False)
    if done.returncode != 0:
        said = [line for line in done.stderr.splitlines() if "error" in line] or ["no message"]
        raise MeasurementError(f"{source.name} does not compile: {said[0]}")
    return program
