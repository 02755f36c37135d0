"""``railhil doctor``: the timing that this machine can provide, and the properties that each transport does not
model."""

from __future__ import annotations

import argparse
import platform
import sys
import time
from collections.abc import Mapping
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import can

from railhil.bus.can_settings import add_bus_arguments, named_bus
from railhil.bus.configured import configured
from railhil.bus.errors import BusLost, BusUnavailable
from railhil.bus.link import open_link
from railhil.bus.select import BusChoice, choose_bus, own_pipes
from railhil.bus.transports import HUB_MODEL, limits
from railhil.common.build import python_build, railhil_build
from railhil.common.command_line import USUAL_SCENARIO, accept_former_name
from railhil.common.digits import count_of
from railhil.common.errors import OptionError
from railhil.common.exit_codes import PASS, USAGE
from railhil.common.output import Output, table, whole
from railhil.common.streams import add_json_argument, print_json
from railhil.common.version import full_version
from railhil.dbc import wire_contract
from railhil.live.doctor.machine import Finding, kernel_can, machine, tools
from railhil.live.doctor.timing import measure_lateness, scheduling
from railhil.run.node_commands import gets_pipes
from railhil.scenarios.options import add_option
from railhil.scenarios.plant_fmu import MAP_OPTION, PlantFmu
from railhil.scenarios.plant_fmu import OPTION as FMU_OPTION
from railhil.scenarios.run_spec import RunSpec

#: Listening time on the requested bus.
_LISTEN_S = 0.3
_SEE = "the lines above, and docs/howto/adapters.md"


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "doctor",
        examples=[
            "railhil doctor --quick",
            "railhil doctor -i socketcan -c can0",
        ],
    )
    add_json_argument(parser)
    parser.add_argument("--quick", action="store_true", help="leave out the measurement, which takes 2 to 4 s")
    add_option(parser, FMU_OPTION, "; the command only tells whether it can be, and does the same twice")
    add_option(parser, MAP_OPTION)
    add_option(parser, "--scenario", f" of the system of {FMU_OPTION}", usual=USUAL_SCENARIO)
    accept_former_name(parser, "--fmu", FMU_OPTION)
    accept_former_name(parser, "--fmu-scenario", "--scenario")
    add_bus_arguments(parser)


def _bus_sentence(given: Mapping[str, Any], choice: BusChoice) -> str:
    """The bus of a run with these options: a run in lockstep that would get a hub unasked gets pipes instead."""
    named = f"{choice.transport} ({choice.reason})"
    if not gets_pipes(given, choose_bus(given, Path("a hub of the run's own"))):
        return named
    pipes = own_pipes()
    return f"{pipes.transport} ({pipes.reason}); with faults of the bus, in real time or with other clients {named}"


def facts(given: Mapping[str, Any], choice: BusChoice) -> dict[str, str]:
    """Versions, and the bus that a command would choose."""
    return {
        "railhil": f"{full_version()}, {railhil_build()}",
        "python": f"{platform.python_version()}, {python_build()} ({sys.executable})",
        "python-can": version("python-can"),
        "interfaces": ", ".join(sorted(can.VALID_INTERFACES)),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "bus": _bus_sentence(given, choice),
        "DBC sha256": wire_contract().sha256,
    }


def findings(quick: bool) -> list[Finding]:
    """All findings, in the order of printing."""
    found = [*kernel_can(), *scheduling(), *machine(), *([] if quick else measure_lateness()), *tools()]
    if "railhil" not in can.VALID_INTERFACES:
        found.append(
            Finding("hub interface", "not registered with python-can", "pip install --force-reinstall railhil")
        )
    return found


def _asked_bus(given: Mapping[str, Any], choice: BusChoice) -> Finding | None:
    """Whether the bus named by the user, or by python-can's configuration, can be opened; None if none is named."""
    if not given and not configured({}):
        return None
    try:
        link = open_link(choice.config)
    except BusUnavailable as error:
        return Finding("bus asked for", str(error), _SEE)
    try:
        until_s = time.monotonic() + _LISTEN_S
        while (rest_s := until_s - time.monotonic()) > 0:
            link.receive(rest_s)
    except BusLost as error:
        return Finding("bus asked for", f"{choice.transport} can be opened, and then: {error}", _SEE)
    finally:
        link.close()
    heard, garbage = link.counters["received"], link.counters["garbage"]
    # A part of a line may have been under way.
    came = f"{count_of(heard, 'frame')}, unreadable input {count_of(garbage, 'time')}"
    found = f"{choice.transport} can be opened; in {_LISTEN_S:g} s {came}"
    return Finding("bus asked for", found, _SEE if garbage > heard + 1 else "")


def _fmu(namespace: argparse.Namespace) -> int:
    """Print whether an FMU is deterministic; exit code 2 if it is not."""
    # Imported here, because it loads the plant.
    from railhil.fmu.determinism import TICKS
    from railhil.plant_sim.fmu import plant_twice

    if namespace.plant_fmu is None:
        option, value = (MAP_OPTION, namespace.fmu_map)
        if value is None:
            option, value = ("--scenario", namespace.scenario)
        raise OptionError(option, f"used only with {FMU_OPTION}")
    named = PlantFmu(namespace.plant_fmu, namespace.fmu_map or str(Path(namespace.plant_fmu).with_suffix(".toml")))
    document = named.as_json()
    run = RunSpec(namespace.scenario or USUAL_SCENARIO, plant_fmu=named)
    same, found = plant_twice(run.load(), run)
    if namespace.json:
        print_json({**document, "ticks": TICKS, "deterministic": same, "found": found})
    else:
        console = Output()
        console.say(f"{'FMU':18} {named.file}, sha256 {document['sha256']}")
        console.say(f"{'determinism':18} {found or f'two runs of {TICKS} steps are equal'}")
    return PASS if same else USAGE


def work(namespace: argparse.Namespace) -> int:
    """Print facts, findings and limits; exit code 2 if the requested bus cannot be opened."""
    if any(value is not None for value in (namespace.plant_fmu, namespace.fmu_map, namespace.scenario)):
        return _fmu(namespace)
    given = named_bus(namespace)
    choice = choose_bus(given)
    asked = _asked_bus(given, choice)
    found = findings(namespace.quick) + ([asked] if asked else [])
    code = USAGE if asked and asked.advice else PASS
    if namespace.json:
        hub = [row._asdict() for row in HUB_MODEL]
        print_json(
            {**facts(given, choice), "findings": [asdict(item) for item in found], "limits": limits(), "hub": hub}
        )
        return code
    console = Output()
    for key, value in facts(given, choice).items():
        console.say(f"{key:18} {value}")
    for item in found:
        console.say(f"{item.subject:18} {item.found}")
        if item.advice:
            console.say(f"{'':18} -> {item.advice}", style="yellow")
    console.print(table(whole("transport"), "what it does not model", rows=limits().items()))
    models = ((row.subject, row.option, row.by or "nothing", row.without) for row in HUB_MODEL)
    heads = (whole("on the hub"), whole("option"), "what it does", "what it does not model")
    console.print(table(*heads, rows=models))
    return code
