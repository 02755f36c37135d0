"""A tree without its symbolic links, as an archive of a hosting site has it, cannot be built into anything."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT

_HOOK = "import setuptools.build_meta as build, sys; getattr(build, 'build_' + sys.argv[1])(sys.argv[2])"


def links() -> dict[str, str]:
    """The links of the package, with what they lead to."""
    return {path.name: os.readlink(path) for path in (ROOT / "railhil").iterdir() if path.is_symlink()}


@pytest.mark.parametrize("kind", ["wheel", "sdist", "editable"])
@pytest.mark.parametrize("left", ["text", "nothing"])
def test_a_tree_without_its_links_is_refused_in_one_line(tmp_path: Path, kind: str, left: str) -> None:
    source, out = tmp_path / "source", tmp_path / "out"
    (source / "railhil").mkdir(parents=True)
    out.mkdir()
    for name in ("setup.py", "pyproject.toml", "README.md", "LICENSE", "railhil/__init__.py"):
        shutil.copy(ROOT / name, source / name)
    if left == "text":
        for name, target in links().items():
            (source / "railhil" / name).write_text(target)
    words = [sys.executable, "-c", _HOOK, kind, str(out)]
    done = subprocess.run(words, cwd=source, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode != 0
    assert not any(out.iterdir())
    (line,) = (line for line in done.stderr.splitlines() if "cannot be built" in line)
    assert all(f"railhil/{name}" in line for name in links())
    assert "Traceback" not in done.stderr
