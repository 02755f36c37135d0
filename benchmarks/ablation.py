"""Contribution of each element of IPFC+: ``python -m benchmarks.ablation`` switches them off one by one.

Every row uses the same perturbed runs, so a difference is due to the element.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from railhil.batch import Batch, Case
from railhil.common.command_line import SEED_MAX, OneLineParser, parse, whole_number
from railhil.common.exit_codes import run_guarded
from railhil.controller_node.arithmetic import names as arithmetics
from railhil.scenarios.load import load
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.batch import run_batch
from railhil.systems.ato.scenario.model import Scenario

LAW = "ipfc_plus"
#: Elements that are switched off or replaced, and the parameters that do it.
ELEMENTS: dict[str, Mapping[str, Any]] = {
    "IPFC+": {},
    "no balises": {"wheel_error_max": 0.0, "balise_error_max_m": 0.0},
    "no position error": {"position_error_max_m": 0.0},
    "no feed-forward of the drag": {"drag_fed_forward": False},
    "no disturbance": {"disturbance_max_mps2": 0.0},
    "no force gain": {"gain_sigma": 0.0},
    "no lag": {"lag_sigma_s": 0.0},
    "no re-planning at the end": {"replan_min_s": 10.0},
    "no loop delay": {"loop_delay_s": 0.001},
    "step alone": {"basis": "step"},
    "step and wavelets of IPFC, its fitting points": {"basis": "wavelets", "fit_points_s": (1.5, 2.5, 4.0, 4.5)},
    "step and ramp, fitting points of IPFC": {"fit_points_s": (1.5, 2.5, 4.0, 4.5)},
}


@dataclass(frozen=True, slots=True)
class Figures:
    """Median and 95th percentile over the runs; a run that did not stop counts as infinitely bad."""

    stop_error_m: tuple[float, float]
    punctuality_s: tuple[float, float]
    itae: float
    comfort: tuple[float, float]
    passed: int

    @classmethod
    def of(cls, result: Batch) -> Figures:
        """Figures of a batch."""

        def both(values: Any) -> tuple[float, float]:
            worst = np.nan_to_num(values, nan=np.inf)
            return float(np.median(worst)), float(np.percentile(worst, 95, method="higher"))

        return cls(
            both(result.values["stop_error_m"]),
            both(result.values["punctuality_s"]),
            both(result.values["itae"])[0],
            both(result.values["comfort"]),
            int(np.count_nonzero(result.passed)),
        )


def without(scenario: Scenario, element: str, runs: int, first_seed: int, arithmetic: str = "float64") -> Figures:
    """Perturbed runs with one of :data:`ELEMENTS`."""
    changed = ParameterSet(LAW, ELEMENTS[element], Path(element)) if ELEMENTS[element] else None
    case = Case(scenario, LawSpec(LAW, arithmetic, parameters=changed))
    return Figures.of(run_batch(case, range(first_seed, first_seed + runs)))


def main() -> int:
    """Print the table."""
    parser = OneLineParser(prog="python -m benchmarks.ablation", description=__doc__.splitlines()[0])
    parser.add_argument("scenario", nargs="?", default="lvshun_tieshan_worn_wheels", help="shipped name or TOML file")
    parser.add_argument("--runs", type=whole_number(1, 100_000), default=200, metavar="N", help="(default 200)")
    parser.add_argument("--seed", type=whole_number(0, SEED_MAX - 100_000), default=1000, help="(default 1000)")
    parser.add_argument("--arithmetic", choices=arithmetics(), default="float64", help="(default float64)")
    namespace = parse(parser)
    scenario = load(namespace.scenario)
    title = f"{scenario.name}, {namespace.runs} perturbed runs from seed {namespace.seed}, {namespace.arithmetic}"
    table = Table(title=title, box=SIMPLE_HEAD, show_edge=False, pad_edge=False)
    table.add_column("law")
    for column in ("stop error m", "time error s", "comfort m/s2/km"):
        table.add_column(f"{column}\nmedian / p95", justify="right")
    table.add_column("ITAE\nmedian", justify="right")
    table.add_column("PASS", justify="right")
    for element in ELEMENTS:
        figures = without(scenario, element, namespace.runs, namespace.seed, namespace.arithmetic)
        table.add_row(
            element,
            "{:.3f} / {:.3f}".format(*figures.stop_error_m),
            "{:.3f} / {:.3f}".format(*figures.punctuality_s),
            "{:.2f} / {:.2f}".format(*figures.comfort),
            f"{figures.itae:.0f}",
            str(figures.passed),
        )
    console = Console(markup=False, emoji=False, highlight=False)
    if not console.is_terminal:
        console.width = 120
    console.print(table)
    return 0


if __name__ == "__main__":
    sys.exit(run_guarded("python -m benchmarks.ablation", main))
