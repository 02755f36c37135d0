"""A short scenario, and the command in an empty folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.campaign_command import Campaign, campaign_here


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(QUICK_TOML)
    return path


@pytest.fixture
def campaign(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Campaign:
    """The command, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return campaign_here(capsys)
