"""The train: one base tick, and whole runs with plant and controller coupled directly."""

from __future__ import annotations

from time import process_time

from benchmarks.figures import Figure, MeasurementError, Setting
from benchmarks.recording import Recording, record
from railhil.bench import direct_run
from railhil.plant_sim.ato.plant import Plant
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario

TITLE = "plant"
METHOD = (
    "Plant.advance replays the notch commands of a nominal run (every 20 ms), without and with all readings that the "
    "telegrams use on every tick. Direct run: plant, law and score coupled by wire integers, no telegrams. All in CPU "
    "time of one process, best of five passes."
)


def _pass_us(scenario: Scenario, recording: Recording, with_readings: bool) -> float:
    """CPU time per tick of one replay."""
    plant = Plant(scenario, seed=0)
    codes, command_ticks, control_ticks = recording.notch_codes, recording.command_ticks, recording.control_ticks
    start_s = process_time()
    for tick in range(recording.ticks):
        if tick % command_ticks == 0:
            plant.command(codes[tick // control_ticks], False)
        plant.advance()
        if with_readings:
            _readings(plant)
    taken_s = process_time() - start_s
    if plant.position_01mm != recording.final_position_01mm:
        raise MeasurementError("plant: the replay does not end where the recorded run ended")
    return taken_s / recording.ticks * 1e6


def _readings(plant: Plant) -> tuple[float, ...]:
    return (
        plant.speed_01mmps,
        plant.odometer_mm,
        plant.effort_fraction,
        plant.notch_acting,
        plant.position_01mm,
        plant.true_speed_01mmps,
        plant.accel_mps2,
        plant.traction_n,
        plant.brake_n,
        plant.grade_permil,
    )


def _run_s(scenario: Scenario, arithmetic: str) -> float:
    """CPU time of a direct run with its score."""
    start_s = process_time()
    direct_run(scenario, RunSpec(law=LawSpec(arithmetic=arithmetic)))
    return process_time() - start_s


def measure(setting: Setting) -> list[Figure]:
    """Tick, then runs per second of both arithmetics.

    :raises MeasurementError: the replay differs from the recorded run.
    """
    scenario = setting.scenario
    recording = record(scenario)
    passes = range(setting.count(5, 1))
    bare_us = min([_pass_us(scenario, recording, False) for _ in passes])
    read_us = min([_pass_us(scenario, recording, True) for _ in passes])
    tick_us = scenario.timing.base_tick_ns / 1000
    sim_s = recording.ticks * scenario.timing.base_tick_ns / 1e9
    figures = [
        Figure("advance, per tick", bare_us, "us"),
        Figure("advance and all readings, per tick", read_us, "us", tick_us / read_us, "base tick to CPU time"),
    ]
    for arithmetic in ("iq", "float64"):
        run_s = min([_run_s(scenario, arithmetic) for _ in passes])
        figures.append(
            Figure(
                f"direct run with {arithmetic}, per core", 1 / run_s, "runs/s", sim_s / run_s, "timetable to CPU time"
            )
        )
    return figures
