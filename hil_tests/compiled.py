"""Compiles once what every worker of the tests would compile for itself, all at the same time:
``python -m hil_tests.compiled``

That is the bytecode of railhil and of its tests, and the machine code of the batches. A failure is left to the tests.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from hil_tests.support.paths import ROOT
from railhil.library import campaign

#: A short scenario of each system with compiled loops, and a law that is quickly made.
BATCHES = {"yizhuang_05": "ipfc", "hst_short": "pid", "yizhuang_stop": "ilc_stop"}
_COLLECT = [sys.executable, "-m", "pytest", "--collect-only", "-qq"]


def compile_batches(folder: Path) -> None:
    """One run of each batch, below a folder; the machine code stays in numba's cache."""
    for scenario, law in BATCHES.items():
        campaign(scenario, laws=[law], runs=1, out=folder / scenario)


def main() -> None:
    """Compile all; what is there already costs a few seconds."""
    subprocess.run(_COLLECT, cwd=ROOT, stdout=subprocess.DEVNULL, check=False)
    with tempfile.TemporaryDirectory(prefix="railhil-compiled-") as folder:
        compile_batches(Path(folder))


if __name__ == "__main__":
    main()
