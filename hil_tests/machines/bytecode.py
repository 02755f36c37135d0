"""Compiles Python modules on this host for a machine that uses its files.

An emulated machine needs half a minute to compile what a host compiles in two seconds, repeats this in each process if
the environment forbids writing compiled modules, and keeps none of them.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Sequence

from railhil.machines import debian

_TIMEOUT_S = 300.0


def compile_by(command: Sequence[str]) -> subprocess.CompletedProcess[str]:
    """Run a Python command with the imports that a machine will need; the compiled modules stay in the cache.

    From then on this process's environment makes all Python processes started from it use that cache.
    """
    os.environ["PYTHONPYCACHEPREFIX"] = str(debian.cache_dir() / "pycache")
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    return subprocess.run(
        command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=_TIMEOUT_S, check=False
    )
