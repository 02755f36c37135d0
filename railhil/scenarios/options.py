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
from railhil.common.errors import OptionError
from railhil.common.patience import APPEAR_S, PATIENCE_S
from railhil.scenarios.given import FMU_MAP_OPTION, FMU_OPTION, NamedCode, given_controller, refuse_beside
from railhil.scenarios.operator_commands import ORDER
from railhil.scenarios.plant_fmu import MAP_OPTION, OPTION, PlantFmu
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.scenario_pipe import OPTION as SCENARIO_PIPE
from railhil.scenarios.settings import normalise_fault, normalise_setting
from railhil.scenarios.system import DEFAULT, system_named
from railhil.scenarios.system import names as system_names

if TYPE_CHECKING:
    from railhil.scenarios.memory import Memory
    from railhil.scenarios.model import AnyScenario
    from railhil.scenarios.parameters import ParameterSet

_JOBS_MAX = 1024
_RUNS_MAX = 1_000_000
_SECTIONS_MAX = 255
#: Largest TCP port, and the port of the panel's page.
PORT_MAX, PANEL_PORT = 65535, 8765
#: A parser, or a group of its options.
Options = argparse._ActionsContainer


def _section(text: str) -> str:
    """The setting of a section's number."""
    return f"section={whole_number(1, _SECTIONS_MAX)(text)}"


def _lifeline(text: str) -> tuple[str, int]:
    node, _, descriptor = text.partition("=")
    try:
        os.fstat(int(descriptor))
    except (ValueError, OverflowError, OSError):
        raise argparse.ArgumentTypeError(f"found {text}, allowed NODE=DESCRIPTOR of an open file") from None
    return node, int(descriptor)


def _requirements(text: str) -> str:
    """A file by its absolute path, because it is read again in other folders; the name of a system as it is."""
    return str(Path(text).resolve()) if Path(text).is_file() else text


class _Laws:
    """Names of the laws of railhil's own system, found when a help is shown: a node does not look for them."""

    def __str__(self) -> str:
        return ", ".join(system_named(DEFAULT).law_names())


class _UsualLaws:
    """The default law of each installed system, found when a help is shown."""

    def __str__(self) -> str:
        names = sorted(system_names(), key=lambda name: name != DEFAULT)
        return ", ".join(f"{system_named(name).law} of {name}" for name in names)


#: Help on a controller that a command takes beside laws.
OR_YOURS = ", or a controller of yours (railhil new c-controller)"
_OF_THE_SCENARIO = "that of the scenario's system"
_OF_THE_RECORD = "that of the certificate"

#: Option -> arguments of ``add_argument``. Its help is the same on every command; ``usual`` is the default in words.
_DECLARED: Final[Mapping[str, Mapping[str, Any]]] = {
    "scenario": {
        "nargs": "?", "default": USUAL_SCENARIO, "metavar": "SCENARIO", "help": "shipped name or TOML file",
        "usual": USUAL_SCENARIO,
    },
    "--scenario": {"metavar": "SCENARIO", "help": "shipped name or TOML file", "usual": _OF_THE_RECORD},
    "log": {"metavar": "RUN", "help": "run folder, or a log of frames (.log, .blf, .asc; .gz)"},
    "--set": {
        "type": normalise_setting, "action": "append", "default": [], "metavar": "KEY=VALUE",
        "help": "change one key of the scenario (plan.stop_error_max_m=0.3); may be given again",
    },
    "--section": {
        "type": _section, "action": "append", "dest": "set", "metavar": "N",
        "help": "only this part of a long run, as a scenario of its own (--set section=N)",
    },
    "--fault": {
        "type": normalise_fault, "action": "append", "default": [], "metavar": "TEXT",
        "help": 'inject a fault ("TRN_SPEED loss 30%% @20s for 5s"); may be given again',
    },
    "--requirements": {
        "type": _requirements, "action": "append", "default": [], "metavar": "FILE",
        "help": "sentences that judge the run: a TOML file, a list in ReqIF, or the name of a system "
        "that ships one; may be given again",
    },
    "--campaign": {
        "metavar": "DIR", "type": Path, "help": "a finished campaign, among whose runs of the law the scores stand",
        "usual": "one beside the run, of its scenario and law",
    },
    "--no-return": {
        "action": "store_true", "help": "up to when ending all faults, or else other noise, saves a run that fails",
    },
    FMU_OPTION: {"metavar": "FILE", "help": "this FMU is the controller, native code (needs the extra [fmi])"},
    FMU_MAP_OPTION: {
        "metavar": "FILE", "help": "names of its variables",
        "usual": f"FILE of {FMU_OPTION} with .toml, or those of the readings",
    },
    # The law, and the way to run it.
    "law": {"metavar": "LAW", "help": "law of the scenario's system (of ato: %(laws)s)"},
    "--controller": {
        "metavar": "LAW", "help": "law of the scenario's system (of ato: %(laws)s)", "usual": "%(usual_laws)s",
    },
    "--laws": {
        "metavar": "A,B,...", "help": f"all, or laws of the scenario's system (of ato: %(laws)s){OR_YOURS}",
    },
    "--parameters": {"type": Path, "metavar": "FILE", "help": "parameters of a law", "usual": "its own"},
    "--arithmetic": {"choices": sorted(ARITHMETICS), "help": "arithmetic of the law", "usual": _OF_THE_SCENARIO},
    "--indexing": {
        "choices": INDEXINGS, "default": "time", "help": "set-points over time or distance", "usual": "time",
    },
    "--task-period-ms": {
        "type": whole_number(0, TASK_PERIOD_MAX_MS), "default": 0, "metavar": "N",
        "help": "the controller reads its mailboxes every N ms of simulation time only",
        "usual": "0, each frame at once",
    },
    "--memory": {"metavar": "DIR", "help": "the law's memory: read before and updated after the run"},
    "--memory-from": {"type": Path, "metavar": "FILE", "help": "begin with this memory, which is not changed"},
    # The run.
    "--seed": {
        "type": whole_number(0, SEED_MAX), "default": 0, "metavar": "N",
        "help": "random seed (of several runs, of the first)", "usual": "0",
    },
    "--seeds": {"metavar": "N,N-N,...", "help": "seeds and ranges of seeds"},
    "--perturbed": {"action": "store_true", "help": "draw parameters from the scenario's distributions"},
    "--run-number": {
        "type": whole_number(1, RUN_NUMBER_MAX), "default": 1, "metavar": "N",
        "help": "number of the run in the sequence of its seed, for systems that learn from run to run", "usual": "1",
    },
    "--pace": {
        "choices": PACES, "default": "lockstep", "help": "as fast as the nodes answer, or by the clock",
        "usual": "lockstep",
    },
    "--appear-timeout": {
        "type": seconds, "default": APPEAR_S, "metavar": "S", "help": "wall time for the others on the bus to appear",
        "usual": f"{APPEAR_S:g} s",
    },
    "--patience": {
        "type": seconds, "default": PATIENCE_S, "metavar": "S", "help": "wall time for an answer",
        "usual": f"{PATIENCE_S:g} s",
    },
    "--rate": {"type": rate, "metavar": "X", "help": "realtime: simulated seconds per second", "usual": f"{RATE:g}"},
    "--bus": {
        "choices": BUSES, "default": "auto",
        "help": "auto: over a bus; local: all nodes in this process, no bus (same record, faster)", "usual": "auto",
    },
    ORDER: {
        "action": "append", "default": [], "metavar": "TEXT",
        "help": 'an order of an operator, as certificates have them ("75 inject 1"); may be given again',
    },
    OPTION: {"metavar": "FILE", "help": "this FMU is the train, native code (needs the extra [fmi])"},
    MAP_OPTION: {
        "metavar": "FILE", "help": "names and units of its variables", "usual": f"FILE of {OPTION} with .toml",
    },
    "--no-rt": {
        "action": "store_true", "help": "realtime: normal scheduling, no locked memory, even where permitted",
    },
    "--operator": {
        "type": Path, "metavar": "SOCKET",
        "help": "Unix socket of the page's orders, the same for railhil run and railhil panel",
    },
    "--foxglove": {
        "type": whole_number(0, PORT_MAX), "metavar": "PORT",
        "help": "serve Lichtblick, PlotJuggler and Foxglove too, at ws://127.0.0.1:PORT",
    },
    # Many runs.
    "--runs": {"type": whole_number(0, _RUNS_MAX), "metavar": "N", "help": "number of runs"},
    "--sequences": {"metavar": "N", "help": "number of sequences"},
    "--chunk": {"metavar": "N", "help": "runs or sequences that are made as one part"},
    "--both": {"action": "store_true", "help": "laws with a parameter file also with their own parameters"},
    "--allow-training-seeds": {
        "action": "store_true", "help": "judge parameters also on seeds on which they were tuned or chosen",
    },
    "--jobs": {
        "type": whole_number(1, _JOBS_MAX), "metavar": "N", "help": "processes at a time",
        "usual": "one for each processor",
    },
    "--verify": {"metavar": "DIR", "help": "make some runs of this finished folder again on the bench, and compare"},
    "--no-report": {"action": "store_true", "help": "write no report.html"},
    # What is written or looked at.
    "--out DIR": {"metavar": "DIR", "help": "folder of the results"},
    "--out FILE": {"metavar": "FILE", "help": "file to write"},
    "--dbc": {"metavar": "FILE", "help": "refuse a DBC that does not describe the telegrams"},
    "--only": {"help": "make only these"},
    "--list": {"action": "store_true", "help": "only list"},
    "--fmu": {"action": "store_true", "help": "also as an FMU"},
    # For the command that starts all nodes.
    "--fault-logs": {"type": Path, "metavar": "DIR", "help": "folder of the nodes' logs of what their faults did"},
    "--lifeline": {"type": _lifeline, "action": "append", "default": [], "help": argparse.SUPPRESS},
    "--sent-file": {"type": Path, "help": argparse.SUPPRESS},
    SCENARIO_PIPE: {"type": int, "metavar": "DESCRIPTOR", "help": argparse.SUPPRESS},
}  # fmt: skip
#: Parts of a long help, for :class:`~railhil.common.command_line.OneLineParser`.
SECTIONS: Final[Mapping[str, tuple[str, ...]]] = {
    "what is run": (
        "--spec", "--set", "--section", "--fault", "--seed", "--perturbed", "--no-perturbed", "--run-number", OPTION,
        MAP_OPTION,
    ),
    "the controller": (
        "--controller", "--laws", "--both", "--parameters", "--arithmetic", "--indexing", "--task-period-ms",
        "--memory", "--memory-from", "--allow-training-seeds", FMU_OPTION, FMU_MAP_OPTION, "--no-controller",
        "--controller-name",
    ),
    "how it is run": (
        "--bus", "--pace", "--rate", "--no-rt", "--appear-timeout", "--patience", "--attach", "--fault-logs",
        "--rerun-command", "--dbc",
    ),
    "results": ("--requirements", "--no-return", "--out", "--no-report", "--json", "--sign", "--verbose", "--quiet"),
    "panel and operator": ("--panel", "--wait", "--catalogue", "--foxglove", "--operator", ORDER),
}  # fmt: skip
_OF_THE_LAW = ("--arithmetic", "--indexing", "--task-period-ms")
_OF_THE_RUN = (
    "--seed", "--perturbed", "--run-number", "--pace", "--appear-timeout", "--patience", "--rate",
)  # fmt: skip


def add_option(parser: Options, name: str, note: str = "", **changes: Any) -> None:
    """Add one option.

    :param note: words after the help, on what this command does with it.
    :param changes: arguments of ``add_argument`` other than declared, but no other help; ``usual``: the default in
        words, "" for none.
    """
    declared = {**_DECLARED[name], **changes}
    usual = declared.pop("usual", "")
    if declared["help"] != argparse.SUPPRESS:
        declared["help"] += f"{note}{f' (default: {usual})' if usual else ''}"
    action = parser.add_argument(name.partition(" ")[0], **declared)
    action.laws, action.usual_laws = _Laws(), _UsualLaws()  # type: ignore[attr-defined]
    if name == "--set":
        add_option(parser, "--section", default=declared["default"])


def add_options(parser: Options, *names: str) -> None:
    """Add options as they are declared, in this order."""
    for name in names:
        add_option(parser, name)


def add_law_options(parser: argparse.ArgumentParser) -> None:
    """Options of running a law: the same for the controller node and for the command that starts it."""
    add_options(parser, *_OF_THE_LAW)


def add_run_options(parser: argparse.ArgumentParser, scenario: str = USUAL_SCENARIO) -> None:
    """Options that identify the run: the same for the plant node and for the supervisor.

    :param scenario: the default.
    """
    add_option(parser, "scenario", default=scenario, usual=scenario)
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
    add_option(parser, "--controller", OR_YOURS, usual=_OF_THE_RECORD)


def law_spec(
    namespace: argparse.Namespace,
    scenario: AnyScenario,
    controller: str | None,
    parameters: ParameterSet | None,
    memory: Memory | None = None,
) -> LawSpec:
    """The law of a command line with :func:`add_law_options`.

    :param controller: name of a law, or text of a controller that the user brings.
    :param scenario: its law and the arithmetic of its system are the defaults.
    :raises InputError: there is no such controller, or it takes no option that is given.
    """
    given = None if controller is None else given_controller(controller)
    if given is not None:
        refuse_beside(
            given, {"--arithmetic": namespace.arithmetic, "--parameters": parameters, "--memory-from": memory}
        )
        return LawSpec.of_given(given, namespace.indexing, namespace.task_period_ms)
    arithmetic = namespace.arithmetic or scenario.installed_system.arithmetic
    law = controller or scenario.usual_law
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
            raise OptionError(FMU_MAP_OPTION, f"used only with {FMU_OPTION}")
        return text
    if text is not None:
        raise OptionError(FMU_OPTION, "used only without --controller")
    names = namespace.controller_fmu_map
    return namespace.controller_fmu if names is None else f"{namespace.controller_fmu}:{names}"


def named_fmu(namespace: argparse.Namespace) -> PlantFmu | None:
    """The FMU that a command line with :func:`add_fmu_options` names.

    :raises InputError: a map without an FMU, or a file that cannot be read.
    """
    if namespace.plant_fmu is None:
        if namespace.fmu_map is not None:
            raise OptionError(MAP_OPTION, f"used only with {OPTION}")
        return None
    file = Path(namespace.plant_fmu)
    found = PlantFmu(str(file), namespace.fmu_map or str(file.with_suffix(".toml")))
    found.as_json()
    return found
