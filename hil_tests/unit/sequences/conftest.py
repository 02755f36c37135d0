"""A short scenario, and a law with a memory that every process knows."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.paths import ROOT
from hil_tests.support.plug import plug_in
from hil_tests.support.remembering import Learning


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The scenario; the law is called ``learning``."""
    path = tmp_path_factory.mktemp("learning") / "short.toml"
    path.write_text(QUICK_TOML)
    with pytest.MonkeyPatch.context() as patch:
        plug_in(path.parent, patch, learning=Learning)
        # The law is in a module of the tests, which other processes do not find by themselves.
        patch.setenv("PYTHONPATH", os.pathsep.join((str(path.parent / "plug"), str(ROOT))))
        yield path
