"""A controller and a plant coupled by their wire integers, step by step."""

from __future__ import annotations

from typing import Any

from railhil.bench import direct_run
from railhil.controller_node.arithmetic.base import Counters
from railhil.controller_node.ato.controller import Controller
from railhil.plant_sim.ato.plant import Plant
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.perturb import perturb

#: The published scenario.
SCENARIO = load("lvshun_tieshan")


def stops_in_fixed_point(law: str, scenario: str, indexing: str, within_m: float) -> None:
    """The law stops the train within this distance of the stopping point, without overspeed or a wrap."""
    done = direct_run(load(scenario), RunSpec(law=LawSpec(law, indexing=indexing)))
    assert done.score.values["stop_error_m"] is not None
    assert done.score.values["stop_error_m"] < within_m
    assert done.score.extras["overspeed_mps"] == 0
    assert done.arithmetic == Counters()


def flat(value: Any) -> list[Any]:
    return [leaf for item in value for leaf in flat(item)] if isinstance(value, tuple | list) else [value]


def closed_loop(seed: int, controllers: list[Controller], ticks: int = 20_500) -> tuple[Plant, list[list[Any]], Any]:
    """Run the plant under the first controller; the others get the same inputs and the notch that was sent."""
    plant = Plant(perturb(SCENARIO, seed) if seed else SCENARIO, seed)
    answers: list[list[Any]] = []
    code = 0
    while plant.tick < ticks:
        if plant.tick % 50 == 0:
            k, speed, position = plant.tick // 50, plant.speed_01mmps, plant.odometer_mm * 10
            answers.append([controller.step(k, speed, position) for controller in controllers])
            code = answers[-1][0].notch_code
            for controller in controllers[1:]:
                controller.sent(code)
        if plant.tick % 2 == 0:
            plant.command(code, False)
        plant.advance()
        for event in plant.drain_events():
            if event.kind == "stopped":
                return plant, answers, event
    return plant, answers, None
