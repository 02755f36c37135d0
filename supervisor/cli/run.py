"""``railhil run``: one scenario over the bus in three processes, recorded and scored."""

from __future__ import annotations

import argparse
import json
import shutil
import tempfile
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from can.cli import add_bus_arguments
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from bus.errors import BusUnavailable
from bus.select import BusChoice, choose_bus
from scenarios.errors import InputError
from scenarios.load import load
from scenarios.model import Scenario
from supervisor.cli.dbcfile import check_foreign_dbc
from supervisor.cli.show import print_result
from supervisor.folder import run_folder, score_json, write_folder
from supervisor.run import Run, RunOptions, RunResult

#: Seeds travel as 32 bit in the handshake.
SEED_MAX = 0xFFFF_FFFF


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("run", help="run a scenario over the bus, record it, score it")
    parser.add_argument("scenario", nargs="?", default="lvshun_tieshan", help="shipped name or TOML file")
    parser.add_argument("--controller", default="ipfc", metavar="LAW", help=f"one of {', '.join(law_names())}")
    parser.add_argument("--arithmetic", choices=("iq", "float64"), default="iq")
    parser.add_argument("--indexing", choices=("time", "distance"), default="time", help="set-point indexing")
    parser.add_argument("--pace", choices=("lockstep", "realtime"), default="lockstep")
    parser.add_argument("--rate", type=float, default=1.0, help="realtime: simulated seconds per second (default 1)")
    parser.add_argument("--seed", type=int, default=0, help="random seed (default 0)")
    parser.add_argument("--perturbed", action="store_true", help="draw parameters from the scenario's distributions")
    parser.add_argument("--out", metavar="DIR", help="run folder (default runs/<utc>-<scenario>-<controller>)")
    parser.add_argument("--attach", action="store_true", help="plant and controller are running already")
    parser.add_argument("--dbc", metavar="FILE", help="refuse to run unless this DBC describes the telegrams")
    parser.add_argument("--json", action="store_true", help="print score.json instead of the table")
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
    add_bus_arguments(parser)
    parser.set_defaults(work=work)


def law_names() -> list[str]:
    """Names of the registered control laws."""
    return sorted(entry.name for entry in entry_points(group="railhil.laws"))


def _options(namespace: argparse.Namespace) -> RunOptions:
    if namespace.controller not in law_names():
        raise InputError("command line", "--controller", namespace.controller, ", ".join(law_names()))
    if not 0 <= namespace.seed <= SEED_MAX:
        raise InputError("command line", "--seed", namespace.seed, f"0..{SEED_MAX}")
    if not 0 < namespace.rate <= 1000:
        raise InputError("command line", "--rate", namespace.rate, "above 0, at most 1000")
    scenario = namespace.scenario
    return RunOptions(
        scenario=str(Path(scenario).resolve()) if scenario.endswith(".toml") else scenario,
        controller=namespace.controller,
        arithmetic=namespace.arithmetic,
        indexing=namespace.indexing,
        pace=namespace.pace,
        rate=namespace.rate,
        seed=namespace.seed,
        perturbed=namespace.perturbed,
        attach=namespace.attach,
    )


def work(namespace: argparse.Namespace) -> int:
    """Run, write the run folder, print; the exit code is the verdict."""
    options = _options(namespace)
    scenario = load(options.scenario)
    if namespace.dbc:
        check_foreign_dbc(namespace.dbc)
    folder = run_folder(namespace.out, scenario.name, options.controller)
    console = Console(stderr=namespace.json)
    with tempfile.TemporaryDirectory(prefix="railhil-") as private:
        choice = choose_bus(namespace, None if options.attach else Path(private) / "hub.sock")
        console.print(f"bus: {choice.transport} ({choice.reason})", highlight=False)
        try:
            run, result = _execute(scenario, options, choice, folder, console, namespace.quiet or namespace.json)
        except BusUnavailable:
            shutil.rmtree(folder)
            raise
    if result.frames == 0:
        shutil.rmtree(folder)
        raise Failed(result.line or "no frame came", result.exit_code)
    given = [] if choice.needs_hub else choice.arguments
    write_folder(folder, scenario, options, result, run.trace, given)
    if namespace.json:
        print(json.dumps(score_json(result, options), indent=2))
    else:
        print_result(console, scenario, result, options, folder)
    return result.exit_code


class Failed(Exception):
    """A run that never began; carries its exit code."""

    def __init__(self, line: str, exit_code: int) -> None:
        super().__init__(line)
        self.exit_code = exit_code


def _execute(
    scenario: Scenario, options: RunOptions, choice: BusChoice, folder: Path, console: Console, quiet: bool
) -> tuple[Run, RunResult]:
    columns: tuple[Any, ...] = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:6.1f} of {task.total:.0f} s simulated"),
    )
    with Progress(*columns, console=console, disable=quiet, auto_refresh=False, transient=True) as progress:
        task = progress.add_task(f"{scenario.name} {options.controller}", total=scenario.plan.running_time_s)
        shown_s = [-1e9]

        def on_progress(sim_time_s: float) -> None:
            # A redraw costs about a millisecond: one per ten simulated seconds is smooth enough for the eye.
            if sim_time_s - shown_s[0] >= (10.0 if options.pace == "lockstep" else 0.5):
                shown_s[0] = sim_time_s
                progress.update(task, completed=sim_time_s, refresh=True)

        run = Run(scenario, options, choice, folder, None if quiet else on_progress)
        return run, run.execute()
