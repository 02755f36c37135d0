"""Paths of the source tree and the tests' data."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

#: Root of the checkout.
ROOT = Path(__file__).parents[2]
TEST_DATA = ROOT / "hil_tests" / "data"


def make_tree(folder: Path, root: Path = ROOT) -> None:
    """Make links to all packages of the checkout ``root`` in ``folder``, for tools that read no package-dir."""
    subprocess.run([sys.executable, "setup.py", "tree", folder], cwd=root, check=True, timeout=100)
