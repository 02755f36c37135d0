"""A short scenario, and a law with a memory that every process knows."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.paths import ROOT
from hil_tests.support.plug import plug_in
from hil_tests.support.remembering import Learning


@pytest.fixture
def short(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The scenario; the law is called ``learning``."""
    plug_in(tmp_path, monkeypatch, learning=Learning)
    # The law is in a module of the tests, which other processes do not find by themselves.
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join((str(tmp_path / "plug"), str(ROOT))))
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    return path
