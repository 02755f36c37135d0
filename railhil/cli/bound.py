"""``railhil bound``: least traction work of the sections of a scenario in their running times."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.common.output import Output, titled_table
from railhil.common.streams import add_json_argument, print_json
from railhil.scenarios.load import load_any
from railhil.scenarios.options import add_options
from railhil.scenarios.section_bound import ListBounds, SectionBound, WorkBound
from railhil.scenarios.system import names, system_named

#: What the columns say.
_WHAT = (
    "ideal: a train with full traction, its service brake and the speed limits; least: its shortest time",
    "comfort: a train with the default limits of generated target curves",
    "ideal, comfort: the dual value, a lower bound; run: the work of a driving (feasible value); uncertainty 0.5 %",
)
#: Columns of work in the table: heading, kind and value.
_WORKS = (
    ("ideal", "ideal", "dual"), ("run", "ideal", "feasible"),
    ("comfort", "comfort", "dual"), ("run", "comfort", "feasible"),
)  # fmt: skip


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "bound",
        description="\n".join(
            ["Least traction work at the wheel over all drivings in the running time, and shortest times.", "", *_WHAT]
        ),
        examples=["railhil bound yizhuang_05", "railhil bound yizhuang_05 --json"],
    )
    add_options(parser, "scenario", "--set")
    add_json_argument(parser)


def work(namespace: argparse.Namespace) -> int:
    """Print the sections and their sum."""
    scenario = load_any(namespace.scenario, namespace.set)
    list_bounds: ListBounds | None = scenario.installed_system.optional_part("bound")
    if list_bounds is None:
        able = ", ".join(name for name in names() if system_named(name).bound is not None)
        found = Words(f"{scenario.name}, of system {scenario.system}")
        raise InputError("command line", "SCENARIO", found, f"a scenario of a system with bounds: {able}")
    sections = list(list_bounds(scenario))
    if namespace.json:
        print_json(
            {
                "scenario": scenario.name,
                "sha256": scenario.sha256,
                "sections": [_row(section) for section in sections],
                "total": _sum(sections),
            }
        )
        return 0
    console = Output()
    rows = [*map(_row, sections), *([{"name": "sum", **_sum(sections)}] if len(sections) > 1 else [])]
    heads = ["s", "least", *(heading for heading, _, _ in _WORKS)]
    console.print(titled_table("traction work in kJ", ["section"], heads, map(_cells, rows), is_whole=False))
    for line in _WHAT:
        console.say(line)
    return 0


def _row(section: SectionBound) -> dict[str, Any]:
    return {
        "name": section.name,
        "length_m": section.length_m,
        "running_time_s": section.running_time_s,
        "shortest_s": round(section.shortest_s, 4),
        "ideal": _values(section.ideal),
        "comfort": None if section.comfort is None else _values(section.comfort),
    }


def _values(bound: WorkBound) -> dict[str, float]:
    return {
        "dual_kj": round(bound.dual_kj, 1),
        "feasible_kj": round(bound.feasible_kj, 1),
        "bound_kj": round(bound.bound_kj, 1),
    }


def _sum(sections: Sequence[SectionBound]) -> dict[str, Any]:
    """The sums over the sections; that of ``comfort`` is None if a section has none."""
    comfort = [section.comfort for section in sections if section.comfort is not None]
    return {
        "length_m": sum(section.length_m for section in sections),
        "running_time_s": sum(section.running_time_s for section in sections),
        "shortest_s": round(sum(section.shortest_s for section in sections), 4),
        "ideal": _total([section.ideal for section in sections]),
        "comfort": _total(comfort) if len(comfort) == len(sections) else None,
    }


def _total(bounds: Sequence[WorkBound]) -> dict[str, float]:
    return {
        "dual_kj": round(sum(bound.dual_kj for bound in bounds), 1),
        "feasible_kj": round(sum(bound.feasible_kj for bound in bounds), 1),
        "bound_kj": round(sum(bound.bound_kj for bound in bounds), 1),
    }


def _cells(row: dict[str, Any]) -> list[str]:
    works = ("-" if row[kind] is None else f"{row[kind][f'{value}_kj']:.0f}" for _, kind, value in _WORKS)
    return [
        row["name"], f"{row['running_time_s']:.1f}", f"{row['shortest_s']:.2f}", *works,
    ]  # fmt: skip
