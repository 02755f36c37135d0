"""Scenarios that the unit tests share."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Scenario


@pytest.fixture
def run_2m(tmp_path: Path) -> Scenario:
    """2 m in 4 s."""
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML, encoding="utf-8")
    return load(str(path))
