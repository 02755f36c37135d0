"""Precise stopping: what the sensors allow, IPFC+, its end phase, and each element of the end phase switched off.

``python -m benchmarks.stopping [SCENARIO] --runs 2000``. The first two rows are no controllers: a train that stops
exactly where it takes the stopping point to be, from all balises that it passed 1 m or more before. "Fit" is the least
squares fit of IPFC+; "bounds" the middle of the positions that agree with every balise within the survey tolerance. For
survey errors spread evenly over the tolerance, as in the shipped scenarios, no estimate has a smaller median or 95th
percentile than the second. "Of the law": root mean square of what is left of a stop error without the second row's.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from railhil.batch import Batch, Case
from railhil.common.command_line import SEED_MAX, OneLineParser, parse, whole_number
from railhil.common.exit_codes import run_guarded
from railhil.controller_node.arithmetic import names as arithmetics
from railhil.controller_node.ato.ipfc_plus_stop_constants import IpfcPlusStopParameters
from railhil.scenarios.load import load
from railhil.scenarios.options import add_option
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.batch import run_batch
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.perturb import perturb

LAW = "ipfc_plus_stop"
#: Elements that are switched off, and the parameters that do it.
ELEMENTS: dict[str, Mapping[str, Any]] = {
    "without the end phase": {"handover_kmh": 0.0},
    "one lag, no delay": {"delay_sigma_s": 0.0},
    "disturbance of IPFC+": {"disturbance_walk_mps2": 0.002, "drag_sigma": 0.0},
    "without the bounds of the wheel": {"survey_tolerance_m": 0.0},
    "without the wheel on forces": {"wheel_on_forces": False},
    "re-planning of IPFC+ before (10 s)": {"replan_max_s": 10.0},
}
#: A balise nearer to the stopping point than this changes nothing any more.
LAST_M = 1.0


def floors_m(scenario: Scenario, seeds: Sequence[int]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Stop errors (m) of trains that stop where they take the stopping point to be: by the fit, and by the bounds.

    Shapes (runs,). If the bounds leave no position, the fit is used.
    """
    given, distance_m = IpfcPlusStopParameters(), scenario.plan.distance_m
    fitted, bounded = np.empty(len(seeds)), np.empty(len(seeds))
    weight = (given.balise_sigma_m / given.wheel_sigma) ** 2
    for run, seed in enumerate(seeds):
        actual = perturb(scenario, seed)
        wheel = actual.sensors.wheel_factor
        passed = [balise for balise in actual.line.balises if 1.0 < balise.surveyed_m <= distance_m - LAST_M]
        surveyed_m = np.array([balise.surveyed_m for balise in passed])
        odometer_m = np.array([round(balise.true_m * wheel * 1000) / 1000 for balise in passed])
        fit = float(odometer_m @ (surveyed_m - odometer_m)) / (weight + float(odometer_m @ odometer_m))
        low = float(np.max((surveyed_m - given.survey_tolerance_m) / odometer_m)) - 1
        high = float(np.min((surveyed_m + given.survey_tolerance_m) / odometer_m)) - 1
        fitted[run] = distance_m / (1 + fit) / wheel - distance_m
        bounded[run] = distance_m / (1 + (fit if low > high else (low + high) / 2)) / wheel - distance_m
    return fitted, bounded


def both(values: NDArray[np.float64], digits: int) -> str:
    """Median and 95th percentile; a run without a value counts as infinitely bad."""
    worst = np.nan_to_num(np.abs(values), nan=np.inf)
    median, high = np.median(worst), np.percentile(worst, 95, method="higher")
    return f"{median:.{digits}f} / {high:.{digits}f}"


def row(result: Batch, bounded_m: NDArray[np.float64]) -> tuple[str, ...]:
    """The cells of a batch.

    :param bounded_m: the second result of :func:`floors_m`.
    """
    assert result.commands is not None
    steps = [np.abs(np.diff(codes.astype(np.int64), prepend=0)) for codes in result.commands]
    travel = np.array([run.sum() / 256 for run in steps])
    largest = np.array([run[-20:].max() / 256 for run in steps])
    return (
        both(result.values["stop_error_m"], 4),
        f"{1000 * np.sqrt(np.mean((result.signed['stop_error_m'] - bounded_m) ** 2)):.1f}",
        both(result.values["punctuality_s"], 4),
        both(result.values["comfort"], 3),
        f"{np.median(travel):.2f}",
        f"{np.median(largest):.2f}",
        f"{np.median(result.values['energy_kj']):.0f}",
        str(int(np.count_nonzero(result.passed))),
        str(int(result.wraps.sum())),
    )


def batch(scenario: Scenario, law: str, arithmetic: str, seeds: range, changed: Mapping[str, Any]) -> Batch:
    """The runs of a law with some parameters changed."""
    parameters = ParameterSet(law, changed, Path(law)) if changed else None
    return run_batch(Case(scenario, LawSpec(law, arithmetic, parameters=parameters)), seeds, keep_notches=True)


def main() -> int:
    """Print the table."""
    parser = OneLineParser(prog="python -m benchmarks.stopping", description=__doc__.splitlines()[0])
    parser.add_argument("scenario", nargs="?", default="lvshun_tieshan_worn_wheels", help="shipped name or TOML file")
    parser.add_argument("--runs", type=whole_number(1, 100_000), default=2000, metavar="N", help="(default 2000)")
    parser.add_argument("--seed", type=whole_number(0, SEED_MAX - 100_000), default=1000, help="(default 1000)")
    parser.add_argument("--arithmetic", choices=arithmetics(), default="float64", help="(default float64)")
    parser.add_argument("--elements", action="store_true", help="also with one element off at a time")
    add_option(parser, "--set")
    namespace = parse(parser)
    scenario = load(namespace.scenario, namespace.set)
    seeds = range(namespace.seed, namespace.seed + namespace.runs)
    title = f"{scenario.name}, {namespace.runs} perturbed runs from seed {namespace.seed}, {namespace.arithmetic}"
    table = Table(title=title, box=SIMPLE_HEAD, show_edge=False, pad_edge=False)
    table.add_column("law")
    for column in ("stop error m\nmedian / p95", "of the law\nmm rms"):
        table.add_column(column, justify="right")
    for column in ("time error s", "comfort m/s2/km"):
        table.add_column(f"{column}\nmedian / p95", justify="right")
    for column in ("notch\ntravel", "step in\nlast 10 s", "energy\nkJ", "\nPASS", "\nwraps"):
        table.add_column(column, justify="right")
    fitted, bounded = floors_m(scenario, seeds)
    table.add_row("least possible: fit", both(fitted, 4))
    table.add_row("least possible: bounds", both(bounded, 4))
    laws: list[tuple[str, str, Mapping[str, Any]]] = [("ipfc_plus", "ipfc_plus", {}), (LAW, LAW, {})]
    if namespace.elements:
        laws += [(element, LAW, changed) for element, changed in ELEMENTS.items()]
    for label, law, changed in laws:
        table.add_row(label, *row(batch(scenario, law, namespace.arithmetic, seeds, changed), bounded))
    console = Console(markup=False, emoji=False, highlight=False)
    if not console.is_terminal:
        console.width = 140
    console.print(table)
    return 0


if __name__ == "__main__":
    sys.exit(run_guarded("python -m benchmarks.stopping", main))
