"""``python -m plant_sim`` (the same as ``railhil node plant``): the train and its line as one process on the bus."""

from __future__ import annotations

import argparse
import gc
import sys

from can.cli import add_bus_arguments

from bus.exitcodes import guarded
from bus.link import open_link
from bus.select import choose_bus
from bus.usage import OneLineParser, add_run_arguments, parse
from plant_sim.node import PlantOptions, run_plant
from scenarios.load import load


def arguments() -> argparse.ArgumentParser:
    """Command line of the plant node."""
    parser = OneLineParser(prog="railhil node plant", description="Train simulator and bus administrator.")
    add_run_arguments(parser)
    add_bus_arguments(parser)
    return parser


def main() -> int:
    """Run one scenario; exit code 0 when it came to its end."""
    namespace = parse(arguments())
    scenario = load(namespace.scenario)
    choice = choose_bus(namespace)
    print(f"plant: {choice.transport} ({choice.reason})", file=sys.stderr)
    options = PlantOptions(
        seed=namespace.seed,
        perturbed=namespace.perturbed,
        rate=namespace.rate if namespace.pace == "realtime" else 0.0,
        fd=choice.fd,
        appear_s=namespace.appear_timeout,
    )
    link = open_link(choice.config)
    # Nothing that outlives a tick is allocated in the loop; the collector would only add pauses.
    gc.freeze()
    gc.disable()
    return run_plant(scenario, options, link)


if __name__ == "__main__":
    sys.exit(guarded("plant", main))
