"""Fixtures for tests of the whole loop, and a check of the bus after each of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from hil_tests.support.foreign import export_node
from hil_tests.support.health import healthy, noted_runs, pytest_runtest_setup  # noqa: F401 - fixtures, hook
from railhil.plant_sim.ato.plant import Plant
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import WatchLevel


@pytest.fixture(scope="module")
def short() -> Scenario:
    """A short run between two stations."""
    return load("yizhuang_05")


@pytest.fixture
def train(monkeypatch: pytest.MonkeyPatch) -> list[tuple[WatchLevel, float]]:
    """Level of the train's own watch and traction force at every tick of every run of the test."""
    seen: list[tuple[WatchLevel, float]] = []
    advance = Plant.advance

    def recorded(plant: Plant) -> None:
        advance(plant)
        seen.append((plant.watch_level, plant.traction_n))

    monkeypatch.setattr(Plant, "advance", recorded)
    return seen


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Folder of an export, written once."""
    folders: dict[tuple[str, str, str], Path] = {}

    def get(scenario: Scenario, law: str = "ipfc", indexing: str = "time") -> Path:
        key = (scenario.sha256 + scenario.target.__repr__(), law, indexing)
        if key not in folders:
            folders[key] = tmp_path_factory.mktemp(law)
            export_node(scenario, folders[key], indexing, law)
        return folders[key]

    return get
