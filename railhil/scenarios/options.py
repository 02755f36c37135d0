"""The options that describe a run. Each is declared once, here; a command may change its help or its default.

The parsed command line stays in the module of the command. Other modules get a :class:`RunSpec`, a :class:`LawSpec` or
a :class:`PlantFmu` made of it.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from railhil.common.command_line import (
    ARITHMETICS,
    BUSES,
    INDEXINGS,
    PACES,
    RATE,
    RUN_NUMBER_MAX,
    SEED_MAX,
    TASK_PERIOD_MAX_MS,
    USUAL_SCENARIO,
    rate,
    seconds,
    whole_number,
)
from railhil.common.errors import InputError, Sentence
from railhil.common.patience import APPEAR_S, PATIENCE_S
from railhil.scenarios.given import FMU_MAP_OPTION, FMU_OPTION, NamedCode, given_controller, refuse_beside
from railhil.scenarios.operator_commands import ORDER
from railhil.scenarios.plant_fmu import MAP_OPTION, OPTION, PlantFmu
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.scenario_pipe import OPTION as SCENARIO_PIPE
from railhil.scenarios.settings import normalise_fault, normalise_setting
from railhil.scenarios.system import System

if TYPE_CHECKING:
    from railhil.scenarios.memory import Memory
    from railhil.scenarios.parameters import ParameterSet

_JOBS_MAX = 1024


def _lifeline(text: str) -> tuple[str, int]:
    node, _, descriptor = text.partition("=")
    try:
        os.fstat(int(descriptor))
    except (ValueError, OverflowError, OSError):
        raise argparse.ArgumentTypeError(f"found {text}, allowed NODE=DESCRIPTOR of an open file") from None
    return node, int(descriptor)


def patience_help(awaited: str) -> str:
    """Help of ``--patience``.

    :param awaited: the event that the node waits for.
    """
    return f"lockstep: wall time for {awaited} when nobody says that its node has ended (default {PATIENCE_S:g} s)"


#: Option -> arguments of ``add_argument``.
_DECLARED: Final[Mapping[str, Mapping[str, Any]]] = {
    "scenario": {"nargs": "?", "default": USUAL_SCENARIO, "help": "shipped name or TOML file"},
    "--set": {
        "type": normalise_setting, "action": "append", "default": [], "metavar": "KEY=VALUE",
        "help": "change one key of the scenario (plan.stop_error_max_m=0.3); may be given again",
    },
    "--fault": {
        "type": normalise_fault, "action": "append", "default": [], "metavar": "TEXT",
        "help": 'inject a fault ("TRN_SPEED loss 30%% @20s for 5s"); may be given again',
    },
    FMU_OPTION: {"metavar": "FILE", "help": "this FMU is the controller, native code (needs the extra [fmi])"},
    FMU_MAP_OPTION: {
        "metavar": "FILE",
        "help": f"names of its variables (default: FILE of {FMU_OPTION} with .toml, or those of the readings)",
    },
    # The law, and the way to run it.
    "--controller": {"metavar": "LAW", "help": "control law (default: that of the system), or a controller of yours"},
    "--parameters": {"type": Path, "metavar": "FILE", "help": "parameters of the law (default: its own)"},
    "--arithmetic": {"choices": sorted(ARITHMETICS), "help": "(default: that of the scenario's system)"},
    "--indexing": {"choices": INDEXINGS, "default": "time", "help": "set-point indexing (default time)"},
    "--task-period-ms": {
        "type": whole_number(0, TASK_PERIOD_MAX_MS), "default": 0, "metavar": "N",
        "help": "the controller reads its mailboxes every N ms of simulation time only (default 0: each frame at once)",
    },
    "--memory": {"metavar": "DIR", "help": "the law's memory: read before and updated after the run"},
    "--memory-from": {"type": Path, "metavar": "FILE", "help": "begin with this memory, do not update it"},
    # The run.
    "--seed": {"type": whole_number(0, SEED_MAX), "default": 0, "help": "random seed of the run (default 0)"},
    "--perturbed": {"action": "store_true", "help": "draw parameters from the scenario's distributions"},
    "--run-number": {
        "type": whole_number(1, RUN_NUMBER_MAX), "default": 1, "metavar": "N",
        "help": "number of the run in the sequence of its seed, for systems that learn from run to run (default 1)",
    },
    "--pace": {
        "choices": PACES, "default": "lockstep",
        "help": "as fast as the nodes answer, or by the clock (default lockstep)",
    },
    "--appear-timeout": {
        "type": seconds, "default": APPEAR_S, "metavar": "S",
        "help": f"wall time for the other nodes to appear (default {APPEAR_S:g} s)",
    },
    "--patience": {"type": seconds, "default": PATIENCE_S, "metavar": "S", "help": patience_help("an answer")},
    "--rate": {"type": rate, "help": f"realtime: simulated seconds per second (default {RATE:g})"},
    "--bus": {
        "choices": BUSES, "default": "auto", "help": "local: all nodes in this process, no bus (same record, faster)",
    },
    ORDER: {
        "action": "append", "default": [], "metavar": "TEXT",
        "help": 'an order of an operator, as certificates have them ("75 inject 1"); may be given again',
    },
    OPTION: {"metavar": "FILE", "help": "simulate the train by this FMU, native code (needs the extra [fmi])"},
    MAP_OPTION: {
        "metavar": "FILE", "help": f"names and units of its variables (default: FILE of {OPTION} with .toml)",
    },
    "--no-rt": {
        "action": "store_true", "help": "realtime: normal scheduling, no locked memory, even where permitted",
    },
    # Many runs.
    "--both": {"action": "store_true", "help": "laws with a parameter file also with their own parameters"},
    "--allow-training-seeds": {"action": "store_true", "help": "judge parameters on runs on which they were tuned"},
    "--jobs": {"type": whole_number(1, _JOBS_MAX), "metavar": "N", "help": "processes (default: one per core)"},
    "--no-report": {"action": "store_true", "help": "write no report.html"},
    # For the command that starts all nodes.
    "--fault-log": {"type": Path, "metavar": "FOLDER", "help": "write there what the faults did (the run folder)"},
    "--lifeline": {"type": _lifeline, "action": "append", "default": [], "help": argparse.SUPPRESS},
    "--sent-file": {"type": Path, "help": argparse.SUPPRESS},
    SCENARIO_PIPE: {"type": int, "metavar": "DESCRIPTOR", "help": argparse.SUPPRESS},
}  # fmt: skip
_OF_THE_LAW = ("--arithmetic", "--indexing", "--task-period-ms")
_OF_THE_RUN = (
    "scenario", "--seed", "--perturbed", "--run-number", "--pace", "--appear-timeout", "--patience", "--rate",
)  # fmt: skip


def add_option(parser: argparse.ArgumentParser, name: str, **changes: Any) -> None:
    """Add one option.

    :param changes: arguments of ``add_argument`` other than declared.
    """
    parser.add_argument(name, **{**_DECLARED[name], **changes})


def add_options(parser: argparse.ArgumentParser, *names: str) -> None:
    """Add options as they are declared, in this order."""
    for name in names:
        add_option(parser, name)


def add_law_options(parser: argparse.ArgumentParser) -> None:
    """Options of running a law: the same for the controller node and for the command that starts it."""
    add_options(parser, *_OF_THE_LAW)


def add_run_options(parser: argparse.ArgumentParser) -> None:
    """Options that identify the run: the same for the plant node and for the supervisor."""
    add_options(parser, *_OF_THE_RUN)


def add_fmu_options(parser: argparse.ArgumentParser) -> None:
    """Options that name an FMU as the plant."""
    add_options(parser, OPTION, MAP_OPTION)


def add_controller_fmu_options(parser: argparse.ArgumentParser) -> None:
    """Options that name an FMU as the controller, for a command with ``--controller``."""
    add_options(parser, FMU_OPTION, FMU_MAP_OPTION)


def add_code_options(parser: argparse.ArgumentParser) -> None:
    """Options that name the code of a recorded run again."""
    add_fmu_options(parser)
    add_controller_fmu_options(parser)
    add_option(parser, "--controller", metavar="CODE", help="the controller of the run, if it was not a law")


def law_spec(
    namespace: argparse.Namespace,
    system: System,
    controller: str | None,
    parameters: ParameterSet | None,
    memory: Memory | None = None,
) -> LawSpec:
    """The law of a command line with :func:`add_law_options`.

    :param controller: name of a law, or text of a controller that the user brings.
    :param system: of the scenario: its law and its arithmetic are the defaults.
    :raises InputError: there is no such controller, or it takes no option that is given.
    """
    given = None if controller is None else given_controller(controller)
    if given is not None:
        refuse_beside(
            given, {"--arithmetic": namespace.arithmetic, "--parameters": parameters, "--memory-from": memory}
        )
        return LawSpec.of_given(given, namespace.indexing, namespace.task_period_ms)
    arithmetic = namespace.arithmetic or system.arithmetic
    law = controller or system.law
    return LawSpec(law, arithmetic, namespace.indexing, parameters, namespace.task_period_ms, memory)


def run_spec(namespace: argparse.Namespace, law: LawSpec) -> RunSpec:
    """The run of a command line with :func:`add_run_options` and ``--set``.

    :raises InputError: there is no such scenario.
    """
    # A node gets its scenario from the command that starts it and has found it.
    name = namespace.scenario
    if getattr(namespace, "handed_scenario", None) is None:
        from railhil.scenarios.load import stable_name

        name = stable_name(name)
    return RunSpec(
        scenario=name,
        settings=tuple(namespace.set),
        law=law,
        seed=namespace.seed,
        perturbed=namespace.perturbed,
        pace=namespace.pace,
        rate=namespace.rate or RATE,
        patience_s=namespace.patience,
        # Only the commands that make complete runs have it.
        bus=getattr(namespace, "bus", "auto"),
        faults=tuple(getattr(namespace, "fault", ())),
        run_number=namespace.run_number,
    )


def named_code(namespace: argparse.Namespace) -> NamedCode:
    """The code that a command line names: an FMU, and a controller that is not the name of a law.

    :raises InputError: like :func:`named_fmu` and :func:`~railhil.scenarios.given.given_controller`.
    """
    controller = named_controller(namespace)
    return NamedCode(named_fmu(namespace), None if controller is None else given_controller(controller))


def named_controller(namespace: argparse.Namespace) -> str | None:
    """The text of ``--controller``, or that of an FMU; None: there is neither.

    :raises InputError: two controllers, or the names of an FMU without an FMU.
    """
    text: str | None = getattr(namespace, "controller", None)
    if namespace.controller_fmu is None:
        if namespace.controller_fmu_map is not None:
            only = Sentence(f"used only with {FMU_OPTION}")
            raise InputError("command line", FMU_MAP_OPTION, namespace.controller_fmu_map, only)
        return text
    if text is not None:
        only = Sentence("used only without --controller")
        raise InputError("command line", FMU_OPTION, namespace.controller_fmu, only)
    names = namespace.controller_fmu_map
    return namespace.controller_fmu if names is None else f"{namespace.controller_fmu}:{names}"


def named_fmu(namespace: argparse.Namespace) -> PlantFmu | None:
    """The FMU that a command line with :func:`add_fmu_options` names.

    :raises InputError: a map without an FMU, or a file that cannot be read.
    """
    if namespace.plant_fmu is None:
        if namespace.fmu_map is not None:
            raise InputError("command line", MAP_OPTION, namespace.fmu_map, Sentence(f"used only with {OPTION}"))
        return None
    file = Path(namespace.plant_fmu)
    found = PlantFmu(str(file), namespace.fmu_map or str(file.with_suffix(".toml")))
    found.as_json()
    return found
