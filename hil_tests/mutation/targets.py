"""Which tests judge the mutants of a module, and the survivors that are explained."""

from __future__ import annotations

import tomllib
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parent.parent


def modules() -> list[str]:
    """The modules whose mutants are all noticed or explained."""
    return list(_table("targets.toml")["modules"])


def tests_of(module: str) -> list[str]:
    """Test files of a module: those of targets.toml, else all tests that import it."""
    listed: dict[str, list[str]] = _table("targets.toml")["modules"]
    if module in listed:
        return listed[module]
    package, _, name = module.rpartition(".")
    words = (f"from {module} import", f"import {module}", f"from {package} import {name}")
    files = sorted((ROOT / "hil_tests").rglob("test_*.py"))
    return [str(path.relative_to(ROOT)) for path in files if any(word in path.read_text("utf-8") for word in words)]


def explained(module: str) -> dict[str, str]:
    """The survivors of a module that no test can notice (:attr:`hil_tests.mutation.operators.Mutant.key`), and why."""
    found: dict[str, list[str]] = _table("survivors.toml").get(module, {})
    return {key: why for why, keys in found.items() for key in keys}


def _table(name: str) -> dict[str, dict]:  # type: ignore[type-arg]
    return tomllib.loads((HERE / name).read_text("utf-8"))
