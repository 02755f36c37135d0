"""``python -m plant_sim`` (the same as ``railhil node plant``): the train and its line as one process on the bus."""

from __future__ import annotations

import argparse
import gc
import sys

from can.cli import add_bus_arguments

from bus.exitcodes import guarded
from bus.link import open_link
from bus.select import choose_bus
from plant_sim.node import PlantOptions, run_plant
from scenarios.load import load


def arguments() -> argparse.ArgumentParser:
    """Command line of the plant node."""
    parser = argparse.ArgumentParser(prog="railhil node plant", description="Train simulator and bus administrator.")
    parser.add_argument("scenario", nargs="?", default="lvshun_tieshan", help="shipped name or TOML file")
    parser.add_argument("--seed", type=int, default=0, help="random seed of the run (default 0)")
    parser.add_argument("--perturbed", action="store_true", help="draw parameters from the scenario's distributions")
    parser.add_argument("--pace", choices=("lockstep", "realtime"), default="lockstep")
    parser.add_argument("--rate", type=float, default=1.0, help="realtime: simulated seconds per second (default 1)")
    add_bus_arguments(parser)
    return parser


def main() -> int:
    """Run one scenario; exit code 0 when it came to its end."""
    namespace = arguments().parse_args()
    scenario = load(namespace.scenario)
    choice = choose_bus(namespace)
    print(f"plant: {choice.transport} ({choice.reason})", file=sys.stderr)
    options = PlantOptions(
        seed=namespace.seed,
        perturbed=namespace.perturbed,
        rate=namespace.rate if namespace.pace == "realtime" else 0.0,
        fd=choice.fd,
    )
    link = open_link(choice.config)
    # Nothing that outlives a tick is allocated in the loop; the collector would only add pauses.
    gc.freeze()
    gc.disable()
    return run_plant(scenario, options, link)


if __name__ == "__main__":
    sys.exit(guarded("plant", main))
