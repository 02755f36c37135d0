"""The command lines of ``railhil run``, ``compare``, ``faults`` and ``sequence run``: what they have in common."""

from __future__ import annotations

import argparse
from dataclasses import replace

from railhil.bus.can_settings import add_bus_arguments, named_bus
from railhil.scenarios.load import load_any
from railhil.scenarios.options import add_law_options, add_option, add_options, add_run_options, law_spec
from railhil.scenarios.options import run_spec as named_run
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import RunSpec, StartUp
from railhil.scenarios.system import DEFAULT, System, system_named


def add_arguments(parser: argparse.ArgumentParser, bus: str = "auto") -> None:
    """Options of every command that makes and records runs.

    :param bus: the default.
    """
    add_run_options(parser)
    add_options(parser, "--set", "--fault")
    add_law_options(parser)
    add_options(parser, "--no-rt", "--no-report")
    parser.add_argument(
        "--verbose", action="store_true", help="print all that the scenario assumes, and how long the end took"
    )
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
    add_option(parser, "--bus", default=bus)
    add_bus_arguments(parser)


def law_names(system: System | None = None) -> list[str]:
    """Names of the installed laws of a system, in the order of every table; None: of railhil's own system."""
    return (system or system_named(DEFAULT)).law_names()


def run_system(namespace: argparse.Namespace) -> System:
    """The system of the scenario on the command line.

    :raises InputError: it cannot be loaded.
    """
    return system_named(load_any(namespace.scenario, namespace.set, namespace.fault).system)


def run_spec(namespace: argparse.Namespace, controller: str | None, parameters: ParameterSet | None) -> RunSpec:
    """The run of one law as described by the command line; None: the usual one of the scenario's system.

    :raises InputError: there is no such scenario.
    """
    law = law_spec(namespace, run_system(namespace), controller, parameters)
    return replace(named_run(namespace, law), can=named_bus(namespace), start_up=start_up(namespace))


def start_up(namespace: argparse.Namespace) -> StartUp:
    """How to start the nodes of a run, from the command line."""
    return StartUp(ask_for_fifo=not namespace.no_rt, appear_s=namespace.appear_timeout)
