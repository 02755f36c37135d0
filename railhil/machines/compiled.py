"""Python modules compiled on this host for a machine that sees its files.

An emulated machine needs half a minute to compile what a host compiles in two seconds, in each process again where the
environment forbids to write compiled modules, and it keeps nothing of it.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Sequence

from railhil.machines import debian

_TIMEOUT_S = 300.0


def compile_by(command: Sequence[str]) -> subprocess.CompletedProcess[str]:
    """Run a Python command that imports what a machine will import; its modules are left in the cache.

    From then on this process's environment makes all Python processes started from it look there.
    """
    os.environ["PYTHONPYCACHEPREFIX"] = str(debian.cache_dir() / "pycache")
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    return subprocess.run(
        command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=_TIMEOUT_S, check=False
    )
