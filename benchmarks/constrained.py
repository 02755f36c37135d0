"""Constraints for a high-speed train: ``python -m benchmarks.constrained`` measures delay_qp beside other laws.

Normal running, emergency, mutation and a longer delay of one power unit, and normal running of three units without and
with couplers, each without a bus, with seeds from which no parameter was made. Means over the seeds. RMSE: of the speed
of all units, in an emergency from its trigger on, with a mutation inside its windows. Slope: of the mean command over
one second, root mean square and largest. Step: processor time of a control period of the law with its telemetry, median
of the first seed.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean, median
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from railhil.bench import direct_run
from railhil.common.command_line import SEED_MAX, OneLineParser, parse, whole_number
from railhil.common.exit_codes import run_guarded
from railhil.controller_node.vector.controller import VectorController
from railhil.reproduce.ngpc.runs import WINDOWS_S, compute_windows_rmse_kmh
from railhil.scenarios.load import load_any
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.high_speed.ride import Ride

#: Parameters of the law with constraints.
_QP = "delay_qp"
_ONE: tuple[tuple[str, Mapping[str, Any]], ...] = (
    ("pid", {}),
    ("elm_ngpc", {}),
    ("res_ngpc", {}),
    ("delay_gpc", {}),
    (_QP, {}),
    (_QP, {"jerk_max_mps3": 0.1}),
    (_QP, {"jerk_max_mps3": 10.0}),
    (_QP, {"energy_weight": 0.003}),
)
_TRAIN: tuple[tuple[str, Mapping[str, Any]], ...] = (
    ("pid", {"loop": "mean"}),
    ("elm_ngpc", {"loop": "mean"}),
    ("delay_gpc", {}),
    ("delay_gpc", {"loop": "mean"}),
    (_QP, {}),
    (_QP, {"loop": "mean"}),
    (_QP, {"loop": "train", "force_weight": 0.0, "force_max_kn": 1000.0}),
    (_QP, {"loop": "train", "force_max_kn": 1000.0}),
    (_QP, {"loop": "train"}),
)
_FREE: tuple[tuple[str, Mapping[str, Any]], ...] = tuple((law, {}) for law in ("pid", "elm_ngpc", "delay_gpc", _QP))
#: Name, title, scenario, faults in addition, laws with their parameters.
SITUATIONS = (
    ("normal", "one unit, normal", "jinan_xuzhou", (), _ONE),
    ("emergency", "one unit, emergency", "jinan_xuzhou_emergency", (), _ONE),
    ("mutation", "one unit, mutation", "jinan_xuzhou_mutation", (), _ONE),
    (
        "delay+1s",
        "one unit, delay 1 s longer at the times of the mutation",
        "jinan_xuzhou",
        tuple(f"train.delay longer 1000ms @{at}s for {length}s" for at, length in WINDOWS_S),
        _ONE,
    ),
    ("free", "three units without couplers, normal", "jinan_xuzhou_emu3", (), _FREE),
    ("coupled", "three units with couplers, normal", "jinan_xuzhou_emu3_coupled", (), _TRAIN),
)
_US_PER_NS = 1e-3


@dataclass(frozen=True)
class Measured:
    """One run; ``coupler_kn`` None: no couplers."""

    rmse_kmh: float
    max_error_kmh: float
    slope_mps3: float
    largest_slope_mps3: float
    energy_kwh: float
    coupler_kn: float | None
    step_us: float


class _Timed:
    """A controller whose steps are timed."""

    def __init__(self, controller: VectorController) -> None:
        self._controller = controller
        self.counters = controller.counters
        self.taken_ns: list[int] = []

    def step(self, raws: Sequence[int]) -> Any:
        begin_ns = time.process_time_ns()
        output = self._controller.step(raws)
        self.taken_ns.append(time.process_time_ns() - begin_ns)
        return output


def measured(scenario: Any, name: str, law: str, values: Mapping[str, Any], seed: int) -> Measured:
    """One run of a scenario with its faults."""
    parameters = ParameterSet(law, dict(values), Path("benchmark.toml")) if values else None
    spec = RunSpec(name, law=LawSpec(law, "float64", parameters=parameters), seed=seed)
    timed = _Timed(VectorController(scenario, spec.law))
    run = direct_run(scenario, spec, timed)
    ride, found = Ride.of(scenario, run.trace), run.score.values
    rmse_kmh = found.get("units_rmse_kmh") or found["rmse_kmh"]
    if scenario.task.emergency is not None:
        rmse_kmh = found["emergency_rmse_kmh"]
    elif scenario.faults:
        rmse_kmh = compute_windows_rmse_kmh(ride)
    every = round(1.0 / (ride.time_s[1] - ride.time_s[0]))
    largest = float(np.abs(np.diff(ride.command_mps2[::every])).max())
    wanted = [rmse_kmh, found["max_error_kmh"], found["slope_mps3"], largest, found["energy_kwh"]]
    step_us = median(timed.taken_ns) * _US_PER_NS
    return Measured(*(float(value or 0.0) for value in wanted), found.get("coupler_peak_kn"), step_us)


def _row(runs: Sequence[Measured]) -> list[str]:
    forces = [run.coupler_kn for run in runs if run.coupler_kn is not None]
    return [
        f"{fmean(run.rmse_kmh for run in runs):.4f}",
        f"{fmean(run.max_error_kmh for run in runs):.3f}",
        f"{fmean(run.slope_mps3 for run in runs):.4f}",
        f"{fmean(run.largest_slope_mps3 for run in runs):.3f}",
        f"{fmean(run.energy_kwh for run in runs):.1f}",
        f"{fmean(forces):.1f} ({max(forces):.1f})" if forces else "-",
        f"{runs[0].step_us:.0f}",
    ]


def main() -> int:
    """Print the tables."""
    parser = OneLineParser(prog="python -m benchmarks.constrained", description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=whole_number(1, 1000), default=5, metavar="N", help="seeds (default 5)")
    parser.add_argument("--seed", type=whole_number(0, SEED_MAX - 1000), default=301, help="(default 301)")
    parser.add_argument("--duration", type=whole_number(60, 10_000), metavar="S", help="only so much of each run")
    parser.add_argument("--only", choices=[name for name, *_ in SITUATIONS], help="only this situation")
    parser.add_argument("--law", choices=sorted({law for law, _ in _ONE}), help="only this law")
    given = parse(parser)
    seeds = range(given.seed, given.seed + given.runs)
    settings = [] if given.duration is None else [f"task.duration_s={given.duration}"]
    console = Console(markup=False, emoji=False, highlight=False)
    if not console.is_terminal:
        console.width = 130
    for situation, title, name, faults, laws in SITUATIONS:
        if given.only not in (None, situation):
            continue
        scenario = load_any(name, settings, faults)
        head = f"{title}: {name}, seeds {seeds[0]} to {seeds[-1]}"
        table = Table(title=head, title_justify="left", box=SIMPLE_HEAD, show_edge=False, pad_edge=False)
        table.add_column("law")
        table.add_column("parameters")
        for column in ("RMSE\nkm/h", "largest\nerror", "slope\nm/s3", "largest\nslope", "energy\nkWh",
                       "coupler kN\nmean (max)", "step\nus"):  # fmt: skip
            table.add_column(column, justify="right")
        for law, values in laws:
            if given.law not in (None, law):
                continue
            runs = [measured(scenario, name, law, values, seed) for seed in seeds]
            table.add_row(law, ", ".join(f"{key} = {value}" for key, value in values.items()), *_row(runs))
        console.print(table)
        console.print()
    return 0


if __name__ == "__main__":
    sys.exit(run_guarded("python -m benchmarks.constrained", main))
