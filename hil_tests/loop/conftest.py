"""Fixtures for tests of the whole loop, and a check of the bus after each of them."""

from __future__ import annotations

import pytest

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
