"""Laws of a test, registered as a user registers one: an entry point of a distribution on the path."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import pytest

from railhil.controller_node.laws import GROUP
from railhil.controller_node.laws.base import Law


def plug_in(folder: Path, patch: pytest.MonkeyPatch, **laws: type[Law[Any, Any]]) -> None:
    """Make laws, classes at the top of a test's module, known by these names until the end of the test.

    :param folder: where the distribution is written.
    """
    package = folder / "plug" / "laws_of_a_test-1.dist-info"
    package.mkdir(parents=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: laws-of-a-test\nVersion: 1\n")
    lines = [f"{name} = {law.__module__}:{law.__qualname__}" for name, law in laws.items()]
    (package / "entry_points.txt").write_text("\n".join((f"[{GROUP}]", *lines, "")))
    patch.syspath_prepend(str(package.parent))
    importlib.invalidate_caches()
