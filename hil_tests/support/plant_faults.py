"""Faults of the plant for tests, and trains that have them."""

from __future__ import annotations

from typing import Any

from railhil.faults.model import Fault, Place, Trigger, Value
from railhil.plant_sim.ato.faults.train import FaultyTrain
from railhil.plant_sim.ato.plant import Plant, PlantEvent
from railhil.plant_sim.faults.injections import Injections
from railhil.scenarios.fault_list import draw_values
from railhil.scenarios.load import load
from railhil.systems.ato.scenario.model import Scenario

SCENARIO = load("lvshun_tieshan")
TICK_NS = SCENARIO.timing.base_tick_ns


def fault(
    where: str, what: str, at: float | Trigger = 0.0, /, values: dict[str, Value] | None = None, **more: Any
) -> Fault:
    """A fault at ``level.name``.

    :param at: simulation time in s, or another trigger.
    :param more: fields of :class:`Fault`.
    """
    level, _, name = where.partition(".")
    trigger = at if isinstance(at, Trigger) else Trigger("time", at)
    return Fault(Place(level, name), what, trigger, values=values or {}, **more)


def faulty(*faults: Fault, scenario: Scenario = SCENARIO, seed: int = 0) -> FaultyTrain:
    """A train with these faults, in their order."""
    return FaultyTrain(scenario, seed, False, 0.0, [(n, draw_values(one, n, seed)) for n, one in enumerate(faults, 1)])


def commanded(plant: Plant, code: int, ticks: int) -> list[PlantEvent]:
    """Advance with commands polled every 20 ms.

    :param code: notch code in 1/256.
    """
    events = plant.drain_events()
    for _ in range(ticks):
        if plant.tick % 2 == 0:
            plant.command(code, False)
        plant.advance()
        events += plant.drain_events()
    return events


def moving(plant: Plant, code: int = 1200, ticks: int = 1000) -> Plant:
    """The train under way: 10 s of traction."""
    commanded(plant, code, ticks)
    assert plant.true_speed_01mmps > 30_000
    return plant


def shown(plant: FaultyTrain) -> list[tuple[int, float, str, str]]:
    """The hits of a train's faults: number, time in s, before, after."""
    return [(hit.fault, hit.time_ns / 1e9, hit.before, hit.after) for hit in plant.injections.log.hits]


def made(*faults: Fault) -> Injections:
    """These faults without a train, numbered from 4."""
    return Injections(list(enumerate(faults, 4)), 0, TICK_NS)


def said(injections: Injections) -> list[tuple[int, str, str]]:
    """The hits of faults: number, before, after."""
    return [(hit.fault, hit.before, hit.after) for hit in injections.log.hits]
