"""``railhil scenarios``: what can be run."""

from __future__ import annotations

import argparse
import json

from rich.console import Console
from rich.table import Table

from scenarios.load import load, names
from scenarios.model import Scenario


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("scenarios", help="list the shipped scenarios, or check one file")
    parser.add_argument("scenario", nargs="?", help="shipped name or TOML file to check and describe")
    parser.add_argument("--json", action="store_true", help="machine-readable output")
    parser.set_defaults(work=work)


def _row(scenario: Scenario) -> dict[str, object]:
    return {
        "name": scenario.name,
        "title": scenario.title,
        "train": scenario.train.name,
        "distance_m": scenario.plan.distance_m,
        "running_time_s": scenario.plan.running_time_s,
        "sha256": scenario.sha256,
    }


def work(namespace: argparse.Namespace) -> int:
    """Print the table (or JSON)."""
    found = [load(namespace.scenario)] if namespace.scenario else [load(name) for name in names()]
    if namespace.json:
        rows = [_row(scenario) | {"assumptions": list(scenario.assumptions)} for scenario in found]
        print(json.dumps(rows, indent=2, ensure_ascii=False))
        return 0
    table = Table("scenario", "line", "train", title=None)
    table.add_column("distance m", justify="right")
    table.add_column("time s", justify="right")
    for scenario in found:
        plan = scenario.plan
        table.add_row(
            scenario.name, scenario.title, scenario.train.name, f"{plan.distance_m:.0f}", f"{plan.running_time_s:.1f}"
        )
    console = Console()
    console.print(table)
    if namespace.scenario:
        for sentence in found[0].assumptions:
            console.print(f"assumed: {sentence}", highlight=False)
    return 0
