"""``python -m benchmarks.published``: checks whether the figures of the paper's Table 2 can belong to one run of this
train.

IPFC drives the nominal train while an alternating notch, increasing from run to run, is added to its output: comfort
(sum of the changes of acceleration) rises towards the published value, and energy rises with it. ITAE is also printed
in m/s.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass

from rich.console import Console
from rich.table import Table

from railhil.bench import coupled_run
from railhil.common.command_line import OneLineParser, parse
from railhil.common.exit_codes import run_guarded
from railhil.controller_node.ato.controller import Controller
from railhil.controller_node.laws.base import NOTCH_Q, BaliseReading
from railhil.judge.score import Score
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario

_SCENARIO = "lvshun_tieshan"
#: Amplitudes of the alternating notch.
_NOTCHES = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
_KMH = 3.6


@dataclass(frozen=True, slots=True)
class Alternating:
    """Score of a run with an alternating notch of this amplitude added to the law's."""

    notches: float
    score: Score


def alternating_run(scenario: Scenario, notches: float) -> Alternating:
    """One run of IPFC in float64; the sum stays in the notch range."""
    controller = Controller(scenario, LawSpec("ipfc", "float64"))
    amplitude = round(notches * 2**NOTCH_Q)
    largest = round(scenario.train.notch_max * 2**NOTCH_Q)

    def law(k: int, speed_01mmps: int, position_01mm: int, balise: BaliseReading[int]) -> int:
        code = controller.step(k, speed_01mmps, position_01mm, balise).notch_code
        return min(max(code + (amplitude if k % 2 else -amplitude), -largest), largest)

    return Alternating(notches, coupled_run(scenario, law).score)


def _cell(value: float | None, digits: int) -> str:
    return "not stopped" if value is None else f"{value:.{digits}f}"


def _row(table: Table, name: str, itae: float | None, *others: tuple[float | None, int]) -> None:
    itae_mps = None if itae is None else itae / _KMH
    cells = [_cell(itae, 0), _cell(itae_mps, 0), *(_cell(value, digits) for value, digits in others)]
    table.add_row(name, *cells)


def tabulated(scenario: Scenario, runs: Sequence[Alternating]) -> Table:
    """Runs, then the published row of IPFC."""
    table = Table(title=scenario.title, title_justify="left")
    table.add_column("run")
    for column in ("ITAE km/h s2", "ITAE m/s s2", "energy kJ", "time s", "stop m", "comfort m/s2/km"):
        table.add_column(column, justify="right")
    for run in runs:
        name = f"ipfc +-{run.notches:g} notch, alternating" if run.notches else "ipfc"
        found = run.score
        others = (
            (found.values["energy_kj"], 0),
            (found.values["punctuality_s"], 3),
            (found.values["stop_error_m"], 3),
            (found.values["comfort"], 2),
        )
        _row(table, name, found.values["itae"], *others)
    for row in scenario.published:
        if row.controller == "ipfc":
            cells = (
                f"{row.values['energy_kj']:.0f}",
                f"{row.values['punctuality_s']:.3f}",
                f"{row.values['stop_error_m']:.3f}",
                f"{row.values['comfort']:.2f}",
            )
            table.add_row(
                "ipfc, published (unit of ITAE not stated)",
                f"{row.values['itae']:.0f}",
                f"{row.values['itae']:.0f}",
                *cells,
            )
    return table


def main() -> int:
    """Run and print."""
    parser = OneLineParser(prog="python -m benchmarks.published", description="Plausibility of the published table.")
    parse(parser)
    scenario = load(_SCENARIO)
    console = Console(markup=False, emoji=False, highlight=False, width=None if sys.stdout.isatty() else 130)
    console.print(tabulated(scenario, [alternating_run(scenario, notches) for notches in _NOTCHES]))
    return 0


if __name__ == "__main__":
    sys.exit(run_guarded("published", main))
