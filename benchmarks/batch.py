"""The vectorised batch: runs per second of one core, and the time of its parts."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from time import process_time
from typing import Any

import numpy as np

from benchmarks.figures import Figure, MeasurementError, Setting
from railhil.batch import Case
from railhil.bench import direct_run
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.streams import chain_of
from railhil.systems.ato.batch import CHUNK, lanes, run_batch
from railhil.systems.ato.batch.engine import Engine
from railhil.systems.ato.batch.kernel import run_period
from railhil.systems.ato.batch.noise import standard_noise
from railhil.systems.ato.batch.setup import trains

TITLE = "batch"
METHOD = (
    f"Perturbed runs of one scenario under IPFC, {CHUNK} together, in CPU time of one process, best of three passes "
    "with seeds of their own; the machine code is there already. Parts: in float64, each alone, the plant with the "
    "notch codes of the whole run. Memory: peak of what Python and numpy have allocated."
)


def _best_s(passes: range, work: Callable[[int], Any]) -> float:
    """Minimum CPU time of a pass; each pass gets its number."""
    taken = []
    for number in passes:
        start_s = process_time()
        work(number)
        taken.append(process_time() - start_s)
    return min(taken)


def _parts_s(setting: Setting, runs: int) -> dict[str, float]:
    """CPU time per run of the parts in float64.

    :raises MeasurementError: the plant does not end where the original run ended.
    """
    engine = Engine(Case(setting.scenario))
    seeds, times = range(runs), engine.times
    chunk = engine.run(seeds)
    passes = range(setting.count(3, 1))
    fleets = [trains(setting.scenario, seeds, True, times, len(engine.grid.counts)) for _ in passes]
    noise = standard_noise(list(map(chain_of, seeds)), times.steps)
    codes = chunk.codes.astype(np.int64)
    periods = list(zip(times.steps.tolist(), times.ends.tolist(), strict=True))

    def plant(number: int) -> None:
        fleet = fleets[number]
        run_period(engine.common, fleet.tables, codes[0], noise[0], -1, 0)
        for i, (tick, end) in enumerate(periods):
            run_period(engine.common, fleet.tables, codes[i], noise[i], tick, end)

    def draws(number: int) -> None:
        standard_noise([chain_of((number + 1) * 1_000_000 + seed) for seed in seeds], times.steps)

    parts = {
        "plant and sums of the score": _best_s(passes, plant),
        "noise of the speed sensor": _best_s(passes, draws),
        "perturbations": _best_s(
            passes, lambda _: trains(setting.scenario, seeds, True, times, len(engine.grid.counts))
        ),
    }
    scores = [chunk.scores[place] for place in fleets[0].tables.order]
    stops = [score.signed["stop_error_m"] for score in scores if score.signed["stop_error_m"] is not None]
    stop_01mm, stop_tick = fleets[0].column(lanes.STOP_01MM), fleets[0].column(lanes.STOP_TICK)
    found = stop_01mm[stop_tick >= 0] * 0.0001 - setting.scenario.plan.distance_m
    if stops != found.tolist():
        raise MeasurementError("batch: the plant alone does not stop where it has stopped")
    return {name: taken_s / runs for name, taken_s in parts.items()}


def _peak_mb(case: Case, runs: int) -> float:
    tracemalloc.start()
    try:
        run_batch(case, range(runs))
        return tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()


def measure(setting: Setting) -> list[Figure]:
    """Rates of three arithmetics, the parts of a run, memory.

    :raises MeasurementError: a part does not reproduce its run.
    """
    scenario, runs = setting.scenario, setting.count(CHUNK, 4)
    passes = range(setting.count(3, 1))
    run_batch(Case(scenario), [0])
    start_s = process_time()
    direct_run(scenario, RunSpec(law=LawSpec(arithmetic="float64"), seed=1, perturbed=True))
    single_s = process_time() - start_s
    figures = []
    per_run_s = {}
    for arithmetic in ("float64", "iq", "float32"):
        case = Case(scenario, LawSpec(arithmetic=arithmetic))
        # Different seeds in every pass, because the noise of known seeds is cached.
        first = len(per_run_s) * 1_000_000

        def work(number: int, case: Case = case, first: int = first) -> None:
            run_batch(case, range(first + number * runs, first + (number + 1) * runs))

        per_run_s[arithmetic] = _best_s(passes, work) / runs
    for arithmetic, taken_s in per_run_s.items():
        against = ("direct run to batch", single_s / taken_s) if arithmetic == "float64" else ("", None)
        figures.append(Figure(f"{arithmetic}: runs of one core", 1 / taken_s, "runs/s", against[1], against[0]))
    for name, taken_s in _parts_s(setting, runs).items():
        figures.append(Figure(f"{name}, per run", taken_s * 1e6, "us", taken_s / per_run_s["float64"], "of the run"))
    peak_mb = _peak_mb(Case(scenario), runs)
    return [*figures, Figure(f"memory of {runs} runs together", peak_mb, "MB", peak_mb / runs * 1000, "MB per 1000")]
