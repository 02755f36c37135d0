"""``railhil plot``: the picture of a recorded run."""

from __future__ import annotations

import argparse
from pathlib import Path

from scenarios.errors import InputError
from supervisor.cli.score import checked_trace, log_path, recorded_scenario


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("plot", help="draw a recorded run (needs the extra [plot])")
    parser.add_argument("log", help="frames.log, or the run folder that holds it")
    parser.add_argument("--scenario", help="shipped name or TOML file (default: what certificate.json says)")
    parser.add_argument("--out", metavar="FILE", help="picture (.svg, .png, .pdf; default: run.svg beside the log)")
    parser.set_defaults(work=work)


def work(namespace: argparse.Namespace) -> int:
    """Draw and say where."""
    try:
        from supervisor.picture import draw
    except ImportError:
        raise InputError("railhil plot", "matplotlib", "not installed", "pip install 'railhil[plot]'") from None
    log = log_path(namespace.log)
    scenario = recorded_scenario(log, namespace.scenario)
    out = Path(namespace.out) if namespace.out else log.with_name("run.svg")
    if out.suffix not in (".svg", ".png", ".pdf"):
        raise InputError("command line", "--out", str(out), "a name that ends in .svg, .png or .pdf")
    draw(scenario, checked_trace(log, scenario), out)
    print(out)
    return 0
