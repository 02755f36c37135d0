"""One control period of the law: a single train, a thousand trains at once, and the estimate for the chip."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from benchmarks.figures import Figure, MeasurementError, Setting, median, p99
from benchmarks.recording import Recording, record
from hil_tests.support.batch_controller import BatchController
from railhil.controller_node.arithmetic import make
from railhil.controller_node.ato.control_loop import ControlLoop
from railhil.controller_node.ato.controller import WIRE, Controller
from railhil.controller_node.compiled_law import compile_law
from railhil.controller_node.cost import CPU_MHZ
from railhil.controller_node.laws.base import NOTCH_Q
from railhil.controller_node.program.ranges import analyse_law
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario

TITLE = "controller step"
METHOD = (
    "Controller.step of law ipfc on the speeds and positions of a nominal run, telemetry included, every step timed by "
    "itself on the wall clock. Without telemetry: law and set-points alone (ControlLoop.step), in turns with it, "
    "written out as the node runs them, and interpreted. Batch: BatchController with speeds spread by "
    "+-0.5 m/s around them. C28x cycles: counted operations of one step times the cycles of TI's guides (program in "
    "RAM); an estimate, not measured on the chip."
)
_ARITHMETICS = ("iq", "iq-portable", "float32", "float64")
#: The arithmetics that the chip supports.
_ON_CHIP = ("iq", "float32")
_TRAINS = 1000
_SPREAD_01MMPS = 5000


def _scalar_us(
    scenario: Scenario, arithmetic: str, recording: Recording, passes: int
) -> tuple[list[float], list[float], list[float]]:
    """Time of each step with telemetry, of the law and its set-points alone, and of these interpreted."""
    taken_us: list[float] = []
    bare_us: list[float] = []
    interpreted_us: list[float] = []
    for _ in range(passes):
        controller = Controller(scenario, LawSpec(arithmetic=arithmetic))
        number = make(arithmetic)
        loop: ControlLoop[Any] = ControlLoop(scenario, LawSpec(), number)
        ranges = None if number.wide else analyse_law(controller.program, loop.law.state_bounds(), WIRE)
        loop.compiled = compile_law(controller.program, loop.law, number, ranges)
        interpreted: ControlLoop[Any] = ControlLoop(scenario, LawSpec(), make(arithmetic))
        for k, (speed, position) in enumerate(zip(recording.speeds_01mmps, recording.positions_01mm, strict=True)):
            start_ns = time.perf_counter_ns()
            output = controller.step(k, speed, position)
            taken_us.append((time.perf_counter_ns() - start_ns) / 1000)
            start_ns = time.perf_counter_ns()
            _, outputs = loop.step(k, speed, position)
            bare_us.append((time.perf_counter_ns() - start_ns) / 1000)
            start_ns = time.perf_counter_ns()
            _, same = interpreted.step(k, speed, position)
            interpreted_us.append((time.perf_counter_ns() - start_ns) / 1000)
            if arithmetic == "iq" and output.notch_code != recording.notch_codes[k]:
                raise MeasurementError("controller step: the notches are not those of the recorded run")
            if number.raw(outputs.notch, NOTCH_Q) != output.notch_code:
                raise MeasurementError(f"controller step: telemetry changes a notch in {arithmetic}")
            if same != outputs:
                raise MeasurementError(f"controller step: the law written out is another in {arithmetic}")
    return taken_us, bare_us, interpreted_us


def _batch_us(scenario: Scenario, arithmetic: str, recording: Recording) -> list[float]:
    """Time per train of each step of ``_TRAINS`` trains."""
    controller = BatchController(scenario, _TRAINS, LawSpec(arithmetic=arithmetic))
    spread = np.linspace(-_SPREAD_01MMPS, _SPREAD_01MMPS, _TRAINS).astype(np.int64)
    taken_us = []
    for k, (speed, position) in enumerate(zip(recording.speeds_01mmps, recording.positions_01mm, strict=True)):
        speeds, positions = speed + spread, np.full(_TRAINS, position, dtype=np.int64)
        start_ns = time.perf_counter_ns()
        controller.step(k, speeds, positions)
        taken_us.append((time.perf_counter_ns() - start_ns) / 1000 / _TRAINS)
    return taken_us


def measure(setting: Setting) -> list[Figure]:
    """Figures of every arithmetic, then the cycles.

    :raises MeasurementError: the measured steps do not give the notches of the recorded run, or give others without
        telemetry.
    """
    scenario = setting.scenario
    recording = record(scenario)
    period_us = scenario.timing.control_period_ns / 1000
    figures: list[Figure] = []
    for arithmetic in _ARITHMETICS:
        single_us, bare_us, interpreted_us = _scalar_us(scenario, arithmetic, recording, setting.count(5, 1))
        train_us = median(_batch_us(scenario, arithmetic, recording))
        single = median(single_us)
        figures += [
            Figure(f"{arithmetic}: step, median", single, "us", period_us / single, "control period to step"),
            Figure(f"{arithmetic}: step, p99", p99(single_us), "us"),
            Figure(
                f"{arithmetic}: step without telemetry, median",
                median(bare_us),
                "us",
                single / median(bare_us),
                "with to without",
            ),
            Figure(
                f"{arithmetic}: the same interpreted, median",
                median(interpreted_us),
                "us",
                median(interpreted_us) / median(bare_us),
                "interpreted to written out",
            ),
            Figure(
                f"{arithmetic}: step of {_TRAINS} trains, per train, median",
                train_us,
                "us",
                single / train_us,
                "single step to batch step per train",
            ),
        ]
    for arithmetic in _ON_CHIP:
        cost = Controller(scenario, LawSpec(arithmetic=arithmetic)).cost
        figures += [
            Figure(f"{arithmetic}: estimated C28x cycles per step", cost.cycles, "cycles"),
            Figure(
                f"{arithmetic}: the same at {CPU_MHZ} MHz",
                cost.ram_us,
                "us",
                period_us / cost.ram_us,
                "control period to estimated step",
            ),
        ]
    return figures
