"""``railhil run``: one scenario over the bus in three processes, recorded and scored; options of all commands that make
runs."""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import cache
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.bus.can_settings import add_bus_arguments, named_bus
from railhil.cli.panel import PanelBeside, add_panel_arguments, check_panel, with_catalogue, with_emergency
from railhil.cli.progress import Progress
from railhil.common.command_line import USUAL_SCENARIO
from railhil.common.errors import Faults, InputError, OptionError
from railhil.common.streams import add_json_argument, print_json, say
from railhil.common.user_files import given_text
from railhil.record.signature import add_sign_argument, check_key, sign_list
from railhil.run.make import record_run
from railhil.run.memory import memory_lines
from railhil.run.report import as_recorded, report_line
from railhil.run.run import Observer, Plan
from railhil.run.spec import with_requirements
from railhil.scenarios.given import NamedCode, refuse_beside
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.options import (
    OR_YOURS,
    SECTIONS,
    add_controller_fmu_options,
    add_fmu_options,
    add_law_options,
    add_option,
    add_options,
    add_run_options,
    law_spec,
    named_code,
)
from railhil.scenarios.options import run_spec as named_run
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.plant_fmu import OPTION as FMU_OPTION
from railhil.scenarios.run_document import OPTIONS, Layer, environment_layer, file_layer
from railhil.scenarios.run_spec import RunSpec, StartUp
from railhil.scenarios.system import System, told_systems

if TYPE_CHECKING:
    from railhil.common.output import Output
    from railhil.judge.record import Record
    from railhil.judge.result import Result


def add_arguments(parser: argparse.ArgumentParser, bus: str = "auto", scenario: str = USUAL_SCENARIO) -> None:
    """Options of every command that makes and records runs.

    :param bus: the default; so is ``scenario``.
    """
    add_run_options(parser, scenario)
    add_options(parser, "--set", "--fault")
    add_law_options(parser)
    add_options(parser, "--no-rt", "--no-report")
    parser.add_argument(
        "--verbose", action="store_true", help="print all assumptions of the scenario, and the time that the end took"
    )
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
    add_option(parser, "--bus", default=bus, usual=bus)
    add_bus_arguments(parser)


def run_system(namespace: argparse.Namespace) -> System:
    """The system of the scenario on the command line.

    :raises InputError: it cannot be loaded.
    """
    return load_any(namespace.scenario, namespace.set, namespace.fault).installed_system


def run_spec(namespace: argparse.Namespace, controller: str | None, parameters: ParameterSet | None) -> RunSpec:
    """The run of one law as described by the command line; None: the default law of the scenario.

    :raises InputError: there is no such scenario.
    """
    scenario = load_any(namespace.scenario, namespace.set, namespace.fault)
    law = law_spec(namespace, scenario, controller, parameters)
    return replace(named_run(namespace, law), can=named_bus(namespace), start_up=start_up(namespace))


def start_up(namespace: argparse.Namespace) -> StartUp:
    """How to start the nodes of a run, from the command line."""
    return StartUp(ask_for_fifo=not namespace.no_rt, appear_s=namespace.appear_timeout)


#: Keys of a run that only laws have.
_OF_A_LAW = ("arithmetic", "parameters", "memory", "memory_store")
#: Key of a run -> name in the parsed command line.
_DESTINATIONS: Mapping[str, str] = {key: option.lstrip("-").replace("-", "_") for key, option in OPTIONS.items()}


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "run",
        examples=[
            "railhil run --controller ipfc_plus",
            "railhil run yizhuang_05 --controller ipfc_plus --seed 7 --perturbed --out runs/mine",
            'railhil run --controller ipfc_plus --fault "TRN_SPEED loss 30% @20s for 5s" --out runs/other',
            "railhil run yizhuang_stop --memory memory",
        ],
        sections=SECTIONS,
        remark=told_systems,
    )
    add_arguments(parser)
    add_option(parser, "--controller", OR_YOURS)
    add_options(parser, "--parameters", "--memory", "--memory-from")
    add_options(parser, "--requirements", "--no-return")
    parser.add_argument("--spec", type=Path, metavar="FILE", help="the run: TOML, or an earlier certificate.json")
    parser.add_argument(
        "--no-perturbed", dest="perturbed", action="store_false", help="a nominal run, overriding --spec"
    )
    add_fmu_options(parser)
    add_controller_fmu_options(parser)
    add_option(parser, "--out DIR", usual="runs/<utc>-<scenario>-<controller>")
    parser.add_argument("--attach", action="store_true", help="plant and controller are running already")
    parser.add_argument(
        "--rerun-command",
        default="",
        metavar="TEXT",
        help="--attach: command in certificate.json to repeat the run",
    )
    add_option(parser, "--fault-logs", ", with --attach", usual="the run folder")
    parser.add_argument("--no-controller", action="store_true", help="the controller is a board or another program")
    parser.add_argument("--controller-name", default="", metavar="TEXT", help="--no-controller: name of the controller")
    add_option(parser, "--dbc")
    add_panel_arguments(parser)
    add_sign_argument(parser)
    add_json_argument(parser)
    for action in parser._actions:
        # Only options given here override environment and file.
        if action.dest in _DESTINATIONS.values():
            action.default = argparse.SUPPRESS


def spec_of(namespace: argparse.Namespace, environment: Mapping[str, str]) -> RunSpec:
    """The run: the command line overrides the environment, which overrides ``--spec``.

    :raises InputError: all errors together.
    """
    faults = Faults()
    code = named_code(namespace)
    layers = [] if namespace.spec is None else [file_layer(namespace.spec, faults, code)]
    layers.append(environment_layer(environment, faults))
    words = {key: getattr(namespace, dest) for key, dest in _DESTINATIONS.items() if dest in namespace}
    layers.append(Layer("command line", words, OPTIONS))
    if code.controller is not None:
        words.pop("controller", None)
        for layer in layers:
            beside = {layer.names.get(key, key): layer.values.get(key) for key in _OF_A_LAW}
            refuse_beside(code.controller, beside, layer.source)
    return RunSpec.from_layers(layers, faults).with_code(code)


def _read_spec(namespace: argparse.Namespace) -> RunSpec:
    """The run, with the way of making it. Raises InputError for options that do not go together."""
    spec = spec_of(namespace, os.environ)
    given = [flag for flag, on in (("--attach", namespace.attach), ("--no-controller", namespace.no_controller)) if on]
    given += ["--bus local"] * spec.is_local
    if len(given) > 1:
        raise OptionError(given[1], f"cannot be given with {given[0]}")
    if (namespace.attach or namespace.no_controller) and spec.law.task_period_ms:
        raise InputError("command line", "--task-period-ms", spec.law.task_period_ms, f"0 with {given[0]}")
    if (namespace.attach or namespace.no_controller) and (spec.memory_store or spec.law.memory):
        raise OptionError(
            given[0], "used only without a memory of the law: the controller of somebody else is not given it"
        )
    if namespace.controller_name and not namespace.no_controller:
        raise OptionError("--controller-name", "used only with --no-controller")
    if namespace.rerun_command and not namespace.attach:
        raise OptionError("--rerun-command", "used only with --attach")
    if namespace.fault_logs is not None and not namespace.attach:
        raise OptionError("--fault-logs", "used only with --attach")
    if namespace.attach and spec.plant_fmu is not None:
        raise OptionError(FMU_OPTION, "cannot be given with --attach, but on the command line of the plant")
    if namespace.no_rt and not spec.is_realtime:
        raise OptionError("--no-rt", "used only with --pace realtime")
    how = replace(
        start_up(namespace),
        attach=namespace.attach,
        foreign=namespace.no_controller,
        controller_name=namespace.controller_name,
        rerun_command=namespace.rerun_command,
        fault_logs=namespace.fault_logs,
        waits=namespace.wait,
    )
    spec = replace(spec, can=named_bus(namespace), start_up=how, out=namespace.out)
    return with_requirements(spec, namespace.requirements)


def _with_determinism(spec: RunSpec, scenario: AnyScenario, stderr: bool) -> RunSpec:
    """The run with what its certificate says of its FMUs, if it has any: whether they do the same twice.

    :param stderr: whether to print a line on it there.

    :raises InputError: an FMU cannot be the plant or the controller.
    """
    note = spec.law.given.check(scenario, spec) if spec.law.given is not None else ""
    if note:
        say(f"note: {note}", stderr)
    if spec.plant_fmu is None:
        return spec
    # This loads the plant, and native code.
    from railhil.plant_sim.fmu import plant_twice

    same, why = plant_twice(scenario, spec)
    if not same:
        say(f"note: the run may not be repeatable: {spec.plant_fmu.file}: {why}", stderr)
    return replace(spec, plant_fmu=replace(spec.plant_fmu, same_twice=same, why=why))


def compare_with_certificate(path: Path, spec: RunSpec, result: Result) -> str:
    """Whether a run repeated from a certificate has the same bytes; empty for another file, a run in real time and a
    changed run."""
    if (
        path.suffix.lower() != ".json"
        or spec.is_realtime
        or spec != RunSpec.from_file(path, NamedCode(spec.plant_fmu, spec.law.given))
    ):
        return ""
    document = json.loads(given_text(path))
    then = document.get("frames_sha256")
    if then == result.frames_sha256:
        return f"frames.log has the same bytes as in {path}"
    if document.get("scenario_sha256") != spec.load().sha256:
        return f"frames.log has other bytes than in {path}: the scenario has changed"
    return f"frames.log has other bytes than in {path}: {then}, with railhil {document.get('railhil')}"


class _Command(Observer):
    """Prints the bus of the run, and imports the modules for the end of the command while the nodes work."""

    def __init__(self, to_stderr: bool) -> None:
        self._to_stderr = to_stderr

    def beside(self, plan: Plan) -> AbstractContextManager[Plan]:
        say(f"bus: {plan.choice.transport} ({plan.choice.reason})", self._to_stderr)
        return nullcontext(plan)

    def on_ended(self) -> None:
        import railhil.cli.result_printer  # noqa: F401


def work(namespace: argparse.Namespace) -> int:
    """Run, write the run folder, print; the exit code is the verdict, of the last run if the page asked for others."""
    spec = _read_spec(namespace)
    check_key(namespace.sign)
    check_panel(namespace, spec)
    is_watched = namespace.panel is not None or namespace.operator is not None
    spec = with_emergency(spec) if is_watched else spec
    spec = with_catalogue(spec) if namespace.catalogue else spec
    scenario = spec.load()
    if namespace.dbc is not None:
        # Imports the modules that print tables; other runs import them while their nodes start.
        from railhil.cli.ports import check_foreign_dbc

        check_foreign_dbc(namespace.dbc, scenario.installed_system.contract)
    spec = _with_determinism(spec, scenario, namespace.json)

    @cache
    def console() -> Output:
        # The modules are loaded while the nodes start or end.
        from railhil.common.output import Output

        return Output(stderr=namespace.json)

    observers: list[Observer] = [_Command(namespace.json)]
    observers += [] if namespace.quiet or namespace.json else [Progress(console)]
    if not is_watched:
        return _conclude(namespace, record_run(spec, *observers, scenario=scenario), spec, console)[0]
    with PanelBeside(namespace.panel, namespace.foxglove, namespace.operator) as page:
        observers.insert(1, page)
        while True:
            result = record_run(spec, *observers, scenario=scenario)
            exit_code, found = _conclude(namespace, result, spec, console)
            if result.stopped_exit_code or not page.show_end(found):
                return exit_code
            # The next run, in a folder of its own.
            spec = replace(spec, out=_next_folder(namespace.out))


def _next_folder(out: str | None) -> Path | None:
    """The named folder with the first number that is free; None: no folder is named."""
    names = () if out is None else (Path(f"{Path(out)}-{number}") for number in count(2))
    return next((name for name in names if not name.exists()), None)


def _conclude(
    namespace: argparse.Namespace, result: Result, spec: RunSpec, console: Callable[[], Output]
) -> tuple[int, Record]:
    """Write the report of a run that has been recorded, and print its result; returns the exit code and the record."""
    # The modules were loaded while the nodes ended.
    from railhil.cli.result_printer import print_result
    from railhil.judge.folder import score_json
    from railhil.record.hash_list import REPORT

    folder, found = result.place, as_recorded(result)
    lost = ""
    if namespace.no_return:
        from railhil.batch.decision import lost_sentence

        lost = lost_sentence(found)
    report = "" if namespace.no_report else report_line([found], folder, [lost] if lost else ())
    sign_list(folder, namespace.sign)
    # Faults may have been typed while the run waited for its start.
    spec = replace(spec, faults=result.spec.faults)
    again = "" if namespace.spec is None else compare_with_certificate(namespace.spec, spec, result)
    # Faults that were prepared for the operator and never ordered get no line of their own.
    notes = [one.line for one in result.faults if one.begun_s is not None or not namespace.catalogue]
    notes += [*memory_lines(result), *([again] if again else [])]
    if namespace.json:
        if report and not (folder / REPORT).is_file():
            notes.append(report)
        for line in notes:
            console().say(line)
        print_json(score_json(result) | ({"no_return": lost} if namespace.no_return else {}))
    else:
        print_result(console(), found, result, notes, report, namespace.verbose, lost)
    return result.stopped_exit_code or result.exit_code, found
