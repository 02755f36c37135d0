"""``railhil compare``: several laws over the bus, one after another, beside each other and the published table."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from scenarios.errors import InputError, Words
from scenarios.load import load
from scenarios.parameters import ParameterSet, load_parameters
from supervisor.cli.execute import (
    add_arguments,
    as_recorded,
    check_law,
    chosen_bus,
    law_names,
    recorded,
    report_line,
    run_options,
)
from supervisor.cli.output import Output
from supervisor.cli.show import print_scores, print_verdict
from supervisor.compared import write_comparison
from supervisor.folder import run_folder
from supervisor.report.recorded import RecordedRun
from supervisor.run import RunOptions

_ALL = "all"


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "compare",
        help="run several laws over the bus, one after another, and compare them",
        description="Exit code 0 when all laws pass, 1 when one fails; the highest of the others when a run is more "
        "than failed.",
    )
    add_arguments(parser)
    parser.add_argument("--laws", default=_ALL, metavar="A,B,...", help=f"of {', '.join(law_names())} (default {_ALL})")
    parser.add_argument(
        "--parameters", type=Path, action="append", default=[], metavar="FILE", help="parameters of the law it names"
    )
    parser.add_argument("--both", action="store_true", help="run laws of such a file with their own parameters too")
    parser.add_argument(
        "--allow-training-seeds", action="store_true", help="judge parameters by runs that they were tuned on"
    )
    parser.add_argument("--out", metavar="DIR", help="folder (default runs/<utc>-<scenario>-compare)")
    parser.set_defaults(work=work)


@dataclass(frozen=True, slots=True)
class _Planned:
    """One run to come: its folder below that of the comparison, and its options."""

    folder: str
    options: RunOptions


def _laws(text: str) -> list[str]:
    names = law_names() if text == _ALL else [name.strip() for name in text.split(",")]
    for name in names:
        check_law(name, "--laws")
    if len(set(names)) < len(names):
        raise InputError("command line", "--laws", text, "each law once")
    return names


def _parameter_sets(namespace: argparse.Namespace, laws: Sequence[str]) -> dict[str, ParameterSet]:
    """Parameter file of each law that has one."""
    found: dict[str, ParameterSet] = {}
    for path in namespace.parameters:
        given = load_parameters(path.resolve())
        if given.law not in laws:
            raise InputError(path, "law", given.law, f"a law that is compared: {', '.join(laws)}")
        if given.law in found:
            raise InputError(
                path, "law", given.law, f"one parameter file per law (the other: {found[given.law].source})"
            )
        found[given.law] = given
    if namespace.both and not found:
        raise InputError("command line", "--both", Words("no parameter file"), "--parameters FILE beside it")
    return found


def _planned(namespace: argparse.Namespace) -> list[_Planned]:
    laws = _laws(namespace.laws)
    files = _parameter_sets(namespace, laws)
    found = []
    for law in laws:
        if law not in files or namespace.both:
            found.append(_Planned(law, run_options(namespace, law, None)))
        if law in files:
            found.append(_Planned(f"{law}-tuned", run_options(namespace, law, files[law])))
    return found


def work(namespace: argparse.Namespace) -> int:
    """Run all, write the comparison, print; nothing that looks like one is written before all laws have run.

    What was recorded stays when a law is refused or the comparison is stopped.
    """
    plan = _planned(namespace)
    scenario = load(plan[0].options.scenario)
    for item in plan:
        parameters = item.options.parameters
        if parameters is not None and namespace.perturbed and not namespace.allow_training_seeds:
            parameters.check_unseen(scenario.name, [namespace.seed])
    console = Output()
    folder: Path | None = None
    made = False
    runs: list[tuple[Path, RecordedRun]] = []
    codes: list[int] = []
    for item in plan:
        with chosen_bus(namespace) as choice:
            if folder is None:
                folder, made = run_folder(namespace.out, scenario.name, "compare")
                console.say(f"bus: {choice.transport} ({choice.reason})")
            own = folder / item.folder
            own.mkdir()
            quiet = namespace.quiet or not console.is_terminal
            try:
                done, result = recorded(scenario, item.options, choice, own, True, console, quiet)
            finally:
                if made and not any(folder.iterdir()):
                    folder.rmdir()
        runs.append((own, as_recorded(own, done, result)))
        codes.append(result.exit_code)
        if done.stopped_exit_code:
            rest = f"{len(runs)} of {len(plan)} runs recorded in {folder}, no comparison written"
            print_verdict(console, "INVALID", f"{result.line}; {rest}")
            return done.stopped_exit_code
    assert folder is not None
    found = [run for _, run in runs]
    write_comparison(folder, scenario, plan[0].options, runs)
    print_scores(console, scenario, [(f"{run.label} (measured)", run.score) for run in found])
    for sentence in scenario.assumptions:
        console.say(f"assumed: {sentence}", style="dim")
    console.say(f"comparison {folder}")
    if not namespace.no_report:
        console.say(report_line(found, folder))
    for run in found:
        print_verdict(console, run.verdict, f"{run.label}{': ' if run.line else ''}{run.line}")
    return max(codes)
