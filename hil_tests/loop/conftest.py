"""Fixtures for tests of the whole loop, and a check of the bus after each of them."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from railhil.bench import BenchRun
from railhil.plant_sim.command_watch import CommandWatchLevel
from railhil.plant_sim.plant import Plant
from railhil.scenarios.load import load
from railhil.scenarios.model import Scenario


@pytest.fixture(scope="module")
def short() -> Scenario:
    """A short run between two stations."""
    return load("yizhuang_04_jiugong_yizhuang_qiao")


@pytest.fixture
def train(monkeypatch: pytest.MonkeyPatch) -> list[tuple[CommandWatchLevel, float]]:
    """Level of the train's own watch and traction force at every tick of every run of the test."""
    seen: list[tuple[CommandWatchLevel, float]] = []
    advance = Plant.advance

    def recorded(plant: Plant) -> None:
        advance(plant)
        seen.append((plant.watch_level, plant.traction_n))

    monkeypatch.setattr(Plant, "advance", recorded)
    return seen


@pytest.fixture(scope="session", autouse=True)
def _runs() -> Iterator[list[BenchRun]]:
    """Every run in this process, from any fixture."""
    runs: list[BenchRun] = []
    make = BenchRun.__init__

    def noted(run: BenchRun, *given: object, **named: object) -> None:
        make(run, *given, **named)  # type: ignore[arg-type]
        runs.append(run)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(BenchRun, "__init__", noted)
        yield runs


@pytest.fixture(autouse=True)
def healthy(_runs: list[BenchRun], request: pytest.FixtureRequest) -> Iterator[None]:
    """After every test except those of such faults: none of its runs has lost, refused or reordered anything."""
    yield
    found = [run.refused for run in _runs]
    _runs.clear()
    if request.node.get_closest_marker("faults") is None:
        assert not any(found), found
