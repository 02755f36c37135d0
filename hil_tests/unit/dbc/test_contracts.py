"""Project rules that can be checked automatically: imports, module size, swallowed exceptions."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT, make_tree

PACKAGES = (
    "dbc",
    "bus",
    "plant_sim",
    "controller_node",
    "railhil",
    "hil_tests",
    "benchmarks",
)
MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


@pytest.mark.slow
def test_import_contracts_of_the_project_file(tmp_path: Path) -> None:
    """The contracts in pyproject.toml, as import-linter sees them (indirect imports included)."""
    make_tree(tmp_path)
    program = "from importlinter.cli import lint_imports_command; lint_imports_command()"
    done = subprocess.run(
        [sys.executable, "-c", program, "--no-cache", ROOT / "pyproject.toml"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 broken" in done.stdout


def test_no_module_is_longer_than_one_sitting() -> None:
    lengths = {str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines()) for path in MODULES}
    assert len(lengths) > 100
    assert {name: length for name, length in lengths.items() if length > 400} == {}


@pytest.mark.slow
def test_no_exception_is_swallowed_in_silence() -> None:
    silent = []
    for path in MODULES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ExceptHandler):
                bare = node.type is None or getattr(node.type, "id", "") in ("Exception", "BaseException")
                empty = all(isinstance(item, (ast.Pass, ast.Constant)) for item in node.body)
                if node.type is None or (bare and empty):
                    silent.append(f"{path.relative_to(ROOT)}:{node.lineno}")
    assert silent == []
