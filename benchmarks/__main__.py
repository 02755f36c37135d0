"""``python -m benchmarks``: measure, and print the figures with a description of the machine."""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from dataclasses import asdict
from importlib import import_module
from ipaddress import ip_address
from pathlib import Path
from types import ModuleType
from typing import Any

from rich.console import Console
from rich.table import Table

from railhil.common.errors import InputError
from railhil.common.exit_codes import run_guarded
from railhil.common.extras import missing_library

#: Benchmarks in the order of measurement. Each module has TITLE, METHOD and ``measure(setting)``.
NAMES = (
    "lockstep",
    "features",
    "start_and_end",
    "transports",
    "jitter",
    "arithmetic",
    "controller_step",
    "plant",
    "batch",
    "campaign",
    "codec",
    "memory",
    "index",
    "predictive_peer",
    "training",
)
#: Width of the tables when the output is not a terminal.
_FILE_COLUMNS = 150


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description="performance figures of the bench")
    parser.add_argument("--json", action="store_true", help="machine-readable output")
    parser.add_argument(
        "--only", action="append", metavar="NAME", help=f"one of {', '.join(NAMES)}; may be given again"
    )
    parser.add_argument(
        "--quick", action="store_true", help="few repetitions of an 8 s run: a check, not a measurement"
    )
    parser.add_argument(
        "--history",
        type=Path,
        metavar="FILE",
        help="add the figures to FILE, and say which are worse than the last ones",
    )
    parser.add_argument(
        "--counting",
        type=int,
        choices=range(65),
        default=0,
        metavar="N",
        help="with N processes beside that only count",
    )
    parser.add_argument(
        "--multicast",
        default="",
        metavar="GROUP",
        help="transports: also measure python-can's udp_multicast, which sends to this multicast group",
    )
    return parser


def is_multicast(text: str) -> bool:
    """Whether a text is the address of a multicast group."""
    try:
        return ip_address(text).is_multicast
    except ValueError:
        return False


def _module(name: str) -> ModuleType:
    try:
        return import_module(f"benchmarks.{name}")
    except ModuleNotFoundError as error:
        raise missing_library("benchmarks", error, "dev") from None


def run(name: str, quick: bool, multicast: str = "") -> dict[str, Any]:
    """Measure one benchmark.

    :param multicast: the group that it may send to; empty: none.
    :returns: ``title``, ``method``, ``taken_s``, ``figures`` (each with name, value, unit, ratio, against, spread)
        and ``missing`` (name, why).
    :raises benchmarks.figures.MeasurementError: it could not be measured.
    """
    module = _module(name)
    figures = _module("figures")
    start_s = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="railhil-") as folder:
        found = module.measure(figures.Setting.make(quick, Path(folder), multicast))
    return {
        "title": module.TITLE,
        "method": module.METHOD,
        "taken_s": time.monotonic() - start_s,
        "figures": [asdict(each) for each in found if isinstance(each, figures.Figure)],
        "missing": [asdict(each) for each in found if isinstance(each, figures.Missing)],
    }


def _shown(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def _print(console: Console, result: dict[str, Any]) -> None:
    table = Table(
        title=f"{result['title']} ({result['taken_s']:.0f} s)", title_justify="left", caption=result["method"]
    )
    table.caption_justify = "left"
    table.add_column("what")
    table.add_column("value", justify="right")
    table.add_column("unit")
    table.add_column("ratio", justify="right")
    table.add_column("of what to what")
    spread = any(figure["spread"] for figure in result["figures"])
    if spread:
        table.add_column("same samples")
    for figure in result["figures"]:
        ratio = "" if figure["ratio"] is None else _shown(figure["ratio"])
        row = [figure["name"], _shown(figure["value"]), figure["unit"], ratio, figure["against"]]
        table.add_row(*row, ", ".join(f"{name} {_shown(value)}" for name, value in figure["spread"].items()))
    for absent in result["missing"]:
        table.add_row(absent["name"], "MISSING", "", "", absent["why"], style="bold yellow")
    console.print(table)
    console.print()


def work() -> int:
    """Run the benchmarks selected on the command line."""
    namespace = _parser().parse_args()
    names = namespace.only or list(NAMES)
    for name in names:
        if name not in NAMES:
            raise InputError("command line", "--only", name, ", ".join(NAMES))
    if namespace.multicast and not is_multicast(namespace.multicast):
        raise InputError("command line", "--multicast", namespace.multicast, "a multicast address (239.74.163.2)")
    machine = _module("machine").this_machine()
    stream = sys.stderr if namespace.json else sys.stdout
    # In a file the table has its full width, unless the environment sets another.
    wide = None if stream.isatty() or "COLUMNS" in os.environ else _FILE_COLUMNS
    console = Console(file=stream, width=wide)
    for key, text in machine.lines():
        console.print(f"{key:10} {text}", highlight=False, soft_wrap=True)
    if machine.warning:
        console.print(f"WARNING    {machine.warning}", style="bold yellow", highlight=False, soft_wrap=True)
    if namespace.quick:
        console.print(
            "QUICK      few repetitions: a check that the benchmarks work, not a measurement", highlight=False
        )
    if namespace.counting:
        console.print(f"LOAD       {namespace.counting} processes beside that only count", highlight=False)
    history = _module("history")
    before = [] if namespace.history is None else history.read(namespace.history)
    results = {}
    with _module("counting").counting(namespace.counting):
        for name in names:
            results[name] = run(name, namespace.quick, namespace.multicast)
            if not namespace.json:
                _print(console, results[name])
    description = {
        **asdict(machine),
        "busy": machine.busy,
        "warning": machine.warning,
        "counting": namespace.counting,
    }
    document = {"machine": description, "quick": namespace.quick, "benchmarks": results}
    if namespace.json:
        print(json.dumps(document, indent=2, allow_nan=False))
    if namespace.history is not None:
        line = history.entry(document)
        for loss in history.losses(before, line):
            console.print(f"LOSS       {loss}", style="bold yellow", highlight=False, soft_wrap=True)
        history.append(namespace.history, line)
    return 0


if __name__ == "__main__":
    sys.exit(run_guarded("benchmarks", work))
