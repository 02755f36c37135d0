"""``railhil run``: one scenario over the bus in three processes, recorded and scored."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from railhil.bus.select import LOCAL
from railhil.cli.bus_run import (
    add_arguments,
    as_recorded,
    check_law,
    chosen_bus,
    law_names,
    recorded,
    report_line,
    run_spec,
    run_system,
    start_up,
)
from railhil.cli.dbcfile import check_foreign_dbc
from railhil.cli.show import print_result
from railhil.common.errors import InputError, Words
from railhil.common.output import Output, add_json_argument, print_json
from railhil.scenarios.parameters import load_parameters
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import system_named
from railhil.supervisor.folder import run_folder, score_json
from railhil.supervisor.report.recorded import REPORT
from railhil.supervisor.start_up import StartUp


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("run", help="run a scenario over the bus, record it, score it")
    add_arguments(parser)
    parser.add_argument(
        "--controller", metavar="LAW", help=f"one of {', '.join(law_names())}; of another system: one of its own"
    )
    parser.add_argument("--parameters", type=Path, metavar="FILE", help="parameters of the law (default: its own)")
    parser.add_argument("--out", metavar="DIR", help="run folder (default runs/<utc>-<scenario>-<controller>)")
    parser.add_argument("--attach", action="store_true", help="plant and controller are running already")
    parser.add_argument(
        "--rerun-command", default="", metavar="TEXT", help="--attach: what certificate.json says makes this run again"
    )
    parser.add_argument("--no-controller", action="store_true", help="it is somebody else: a board, another program")
    parser.add_argument("--dbc", metavar="FILE", help="refuse to run unless this DBC describes the telegrams")
    add_json_argument(parser)
    parser.set_defaults(work=work)


def _asked(namespace: argparse.Namespace) -> tuple[RunSpec, StartUp]:
    system = run_system(namespace)
    controller = namespace.controller or system.law
    check_law(controller, "--controller", system)
    given = [flag for flag, on in (("--attach", namespace.attach), ("--no-controller", namespace.no_controller)) if on]
    given += ["--bus local"] * (namespace.bus == LOCAL)
    if len(given) > 1:
        raise InputError("command line", given[1], Words(f"beside {given[0]}"), "one of the two")
    if (namespace.attach or namespace.no_controller) and namespace.task_period_ms:
        raise InputError("command line", "--task-period-ms", namespace.task_period_ms, f"0 with {given[0]}")
    if namespace.rerun_command and not namespace.attach:
        raise InputError("command line", "--rerun-command", namespace.rerun_command, "only with --attach")
    parameters = None if namespace.parameters is None else load_parameters(namespace.parameters.resolve())
    how = replace(
        start_up(namespace),
        attach=namespace.attach,
        foreign=namespace.no_controller,
        rerun_command=namespace.rerun_command,
    )
    return run_spec(namespace, controller, parameters), how


def work(namespace: argparse.Namespace) -> int:
    """Run, write the run folder, print; the exit code is the verdict."""
    spec, how = _asked(namespace)
    scenario = spec.load()
    if namespace.dbc is not None:
        check_foreign_dbc(namespace.dbc, system_named(scenario.system).contract)
    console = Output(stderr=namespace.json)
    with chosen_bus(namespace, how.attach or how.foreign) as choice:
        folder, made = run_folder(namespace.out, scenario.name, spec.law.controller)
        console.say(f"bus: {choice.transport} ({choice.reason})")
        quiet = namespace.quiet or namespace.json or not console.is_terminal
        run, result = recorded(scenario, spec, how, choice, folder, made, console, quiet)
    found = as_recorded(folder, run, result)
    report = "" if namespace.no_report else report_line([found], folder)
    if namespace.json:
        if report and not (folder / REPORT).is_file():
            console.say(report)
        print_json(score_json(scenario, result, spec))
    else:
        print_result(console, found, result, folder, report, namespace.verbose)
    return run.stopped_exit_code or result.exit_code
