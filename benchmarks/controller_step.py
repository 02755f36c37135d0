"""One control period of the law: a single train, a thousand trains at once, and the estimate for the chip."""

from __future__ import annotations

import time

import numpy as np

from benchmarks.figures import Figure, MeasurementError, Setting, median, p99
from benchmarks.recording import Recording, record
from controller_node.controller import BatchController, Controller
from controller_node.program.cycles import CPU_MHZ, estimated_cycles
from controller_node.program.record import record as record_law
from scenarios.model import Scenario

TITLE = "controller step"
METHOD = (
    "Controller.step of law ipfc on the speeds and positions of a nominal run, every step timed by itself on the wall "
    "clock. Batch: BatchController with speeds spread by +-0.5 m/s around them. C28x cycles: counted operations of one "
    "step times the cycles of the IQmath guide (program in RAM); an estimate, not measured on the chip."
)
_ARITHMETICS = ("iq", "float64")
_TRAINS = 1000
_SPREAD_01MMPS = 5000


def _scalar_us(scenario: Scenario, arithmetic: str, recording: Recording, passes: int) -> list[float]:
    taken_us = []
    for _ in range(passes):
        controller = Controller(scenario, arithmetic=arithmetic)
        codes = []
        for k, (speed, position) in enumerate(zip(recording.speeds_01mmps, recording.positions_01mm, strict=True)):
            start_ns = time.perf_counter_ns()
            output = controller.step(k, speed, position)
            taken_us.append((time.perf_counter_ns() - start_ns) / 1000)
            codes.append(output.notch_code)
        if arithmetic == "iq" and codes != recording.notch_codes:
            raise MeasurementError("controller step: the notches are not those of the recorded run")
    return taken_us


def _batch_us(scenario: Scenario, arithmetic: str, recording: Recording) -> list[float]:
    """Time per train of each step of ``_TRAINS`` trains."""
    controller = BatchController(scenario, _TRAINS, arithmetic=arithmetic)
    spread = np.linspace(-_SPREAD_01MMPS, _SPREAD_01MMPS, _TRAINS).astype(np.int64)
    taken_us = []
    for k, (speed, position) in enumerate(zip(recording.speeds_01mmps, recording.positions_01mm, strict=True)):
        speeds, positions = speed + spread, np.full(_TRAINS, position, dtype=np.int64)
        start_ns = time.perf_counter_ns()
        controller.step(k, speeds, positions)
        taken_us.append((time.perf_counter_ns() - start_ns) / 1000 / _TRAINS)
    return taken_us


def measure(setting: Setting) -> list[Figure]:
    """Figures of both arithmetics, then the cycles.

    :raises MeasurementError: the steps measured do not give the notches of the recorded run.
    """
    scenario = setting.scenario
    recording = record(scenario)
    period_us = scenario.timing.control_period_ns / 1000
    figures: list[Figure] = []
    for arithmetic in _ARITHMETICS:
        single_us = _scalar_us(scenario, arithmetic, recording, setting.count(5, 1))
        train_us = median(_batch_us(scenario, arithmetic, recording))
        single = median(single_us)
        figures += [
            Figure(f"{arithmetic}: step, median", single, "us", period_us / single, "control period to step"),
            Figure(f"{arithmetic}: step, p99", p99(single_us), "us"),
            Figure(
                f"{arithmetic}: step of {_TRAINS} trains, per train, median",
                train_us,
                "us",
                single / train_us,
                "single step to batch step per train",
            ),
        ]
    cycles = estimated_cycles(record_law(scenario, "ipfc").step_counts())
    chip_us = cycles / CPU_MHZ
    return [
        *figures,
        Figure("iq: estimated C28x cycles per step", cycles, "cycles"),
        Figure(
            f"iq: the same at {CPU_MHZ} MHz", chip_us, "us", period_us / chip_us, "control period to estimated step"
        ),
    ]
