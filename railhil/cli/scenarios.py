"""``railhil scenarios``: lists and checks scenarios."""

from __future__ import annotations

import argparse

from rich.table import Column

from railhil.cli.result_printer import print_watch
from railhil.common.errors import OptionError
from railhil.common.output import Output, number, table
from railhil.common.streams import add_json_argument, print_json
from railhil.scenarios.load import load_any, names, short_names
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.options import add_option
from railhil.scenarios.system import told_systems

#: Terminal width from which the longest short name leaves room for the other columns.
_NAMES_COLUMNS = 80


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "scenarios",
        examples=[
            "railhil scenarios",
            "railhil scenarios yizhuang_05",
            "railhil scenarios yizhuang_05 --set plan.stop_error_max_m=0.3",
        ],
        remark=told_systems,
    )
    add_option(parser, "scenario", ", to be checked and described", default=None, usual="all shipped ones are listed")
    add_option(parser, "--set")
    add_json_argument(parser)


def _row(scenario: AnyScenario) -> dict[str, object]:
    return {
        "name": scenario.name,
        "short_name": short_names().get(scenario.name),
        "title": scenario.title,
        "system": scenario.system,
        **scenario.described,
        "running_time_s": scenario.planned_s,
        "sha256": scenario.sha256,
    }


def work(namespace: argparse.Namespace) -> int:
    """Print the table (or JSON)."""
    if namespace.set and not namespace.scenario:
        raise OptionError("--set", "used only with a scenario")
    found = (
        [load_any(namespace.scenario, namespace.set)] if namespace.scenario else [load_any(name) for name in names()]
    )
    if namespace.json:
        print_json([_row(scenario) | {"assumptions": list(scenario.assumptions)} for scenario in found])
        return 0
    console, short = Output(), short_names()
    # The user will type the name, so it is never truncated.
    name = Column("scenario", overflow="fold", no_wrap=console.width >= _NAMES_COLUMNS)
    rows = table(name, "line", number("m"), number("s"))
    for scenario in found:
        rows.add_row(
            short.get(scenario.name, scenario.name),
            scenario.title,
            f"{distance_m:.0f}" if isinstance(distance_m := scenario.described.get("distance_m"), float | int) else "-",
            f"{scenario.planned_s:.1f}",
        )
    console.print(rows)
    if namespace.scenario:
        said = "".join(f", {key} {value}" for key, value in found[0].described.items() if isinstance(value, str))
        console.say(f"name {found[0].name}{said}, scenario sha256 {found[0].sha256}")
        for sentence in found[0].assumptions:
            console.say(f"assumed: {sentence}")
        print_watch(console, found[0])
    return 0
