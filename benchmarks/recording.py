"""Inputs for the benchmarks of single parts: the inputs of controller and train in a nominal run."""

from __future__ import annotations

from dataclasses import dataclass

from railhil.controller_node.ato.controller import Controller
from railhil.plant_sim.ato.plant import Plant
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd


@dataclass(frozen=True, slots=True)
class Recording:
    """One run up to the end of its timetable; the lists have one entry per control period.

    ``command_ticks``: base ticks from one notch command to the next.
    """

    speeds_01mmps: list[int]
    positions_01mm: list[int]
    notch_codes: list[int]
    ticks: int
    control_ticks: int
    command_ticks: int
    final_position_01mm: int


def record(scenario: Scenario) -> Recording:
    """Run the IPFC law in IQ arithmetic against the plant, seed 0."""
    tick_ns = scenario.timing.base_tick_ns
    ticks = round(scenario.plan.running_time_s * 1e9) // tick_ns
    control_ticks = scenario.timing.control_period_ns // tick_ns
    command_ticks = NotchCmd.port().period_ns // tick_ns
    plant, controller = Plant(scenario, seed=0), Controller(scenario)
    speeds, positions, codes = [], [], []
    for tick in range(ticks):
        if tick % control_ticks == 0:
            speeds.append(plant.speed_01mmps)
            positions.append(plant.odometer_mm * 10)
            codes.append(controller.step(tick // control_ticks, speeds[-1], positions[-1]).notch_code)
        if tick % command_ticks == 0:
            plant.command(codes[-1], False)
        plant.advance()
    return Recording(speeds, positions, codes, ticks, control_ticks, command_ticks, plant.position_01mm)
