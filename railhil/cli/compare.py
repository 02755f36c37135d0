"""``railhil compare``: several laws over the bus, one after another, compared with each other and the published
table.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path

from railhil.cli.progress import Progress
from railhil.cli.result_printer import assumption_lines, print_scores, print_verdict, print_watch
from railhil.cli.run import add_arguments, run_spec, run_system
from railhil.common.command_line import name_list
from railhil.common.digits import count_of
from railhil.common.errors import InputError, OptionError
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.judge.record import Record
from railhil.judge.training_seeds import check_unseen
from railhil.record.run_folder import run_folder
from railhil.record.signature import add_sign_argument, check_key, sign_list
from railhil.record.telemetry import LawOrigin, law_origin
from railhil.report.comparison_file import write_comparison
from railhil.report.facts import parameters_sentence
from railhil.run.make import NeverBegan, record_run
from railhil.run.report import as_recorded, report_line
from railhil.run.run import Observer, Plan
from railhil.run.spec import with_requirements
from railhil.scenarios.given import given_controller
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.options import SECTIONS, add_option
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import System

_ALL = "all"


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "compare",
        examples=["railhil compare", "railhil compare yizhuang_05 --laws ipfc,ipfc_plus --seed 7 --perturbed"],
        description="Exit code 0 when all laws pass, 1 when one fails; the highest of the others when a run is more "
        "than failed.",
        sections=SECTIONS,
    )
    add_arguments(parser)
    add_option(parser, "--laws", default=_ALL, usual=_ALL)
    add_option(parser, "--parameters", "; may be given again, for another law", action="append", default=[])
    add_option(parser, "--both")
    add_option(parser, "--allow-training-seeds")
    add_sign_argument(parser)
    add_json_argument(parser)
    add_option(parser, "--out DIR", usual="runs/<utc>-<scenario>-compare")


def _laws(text: str, system: System) -> list[str]:
    names = system.law_names() if text == _ALL else list(name_list(text))
    for name in names:
        if given_controller(name) is None:
            system.check_law(name, "command line", "--laws")
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
        raise OptionError("--both", "used only with --parameters FILE")
    return found


def _planned(namespace: argparse.Namespace) -> list[RunSpec]:
    laws = _laws(namespace.laws, run_system(namespace))
    files = _parameter_sets(namespace, laws)
    found = []
    for law in laws:
        if law not in files or namespace.both:
            found.append(run_spec(namespace, law, None))
        if law in files:
            found.append(run_spec(namespace, law, files[law]))
    return found


def _checked(
    namespace: argparse.Namespace, scenario: AnyScenario, wanted: Sequence[RunSpec]
) -> tuple[list[RunSpec], list[str]]:
    """The runs to be made, and sentences on the runs that are left out.

    :raises InputError, NeverBegan: a run cannot be made, or must not be judged on this seed.
    """
    if not namespace.allow_training_seeds:
        for spec in wanted:
            check_unseen(scenario, spec)
    plan, left_out, refused = [], [], []
    for spec, checked in zip(wanted, check_controllers(wanted), strict=True):
        law = spec.law
        own = namespace.laws == _ALL and law.parameters is None
        if own and law.indexing not in checked.indexings:
            left_out.append(law.controller)
            continue
        if own and checked.exit_code == InputError.exit_code:
            # The law needs another arithmetic, or a library that is not installed.
            refused.append(checked)
            continue
        checked.require()
        if not namespace.allow_training_seeds:
            check_unseen(scenario, spec, checked.origin)
        plan.append(spec)
    if not plan:
        for checked in refused:
            checked.require()
        raise InputError("command line", "--indexing", namespace.indexing, "an indexing that some law has")
    notes = [f"Left out, as without set-points over {namespace.indexing}: {', '.join(left_out)}."] if left_out else []
    return plan, [*notes, *(f"Left out. {checked.line}" for checked in refused)]


def _places(plan: Sequence[RunSpec]) -> list[str]:
    """Name of each run's folder: the law, and a number where an export of it is compared, too."""
    labels = [spec.law.label for spec in plan]
    return [
        f"{label}-{labels[:index].count(label) + 1}" if label in labels[:index] else label
        for index, label in enumerate(labels)
    ]


class _BusLine(Observer):
    """Prints the bus of the runs once."""

    def __init__(self, console: Output) -> None:
        self._console: Output | None = console

    def beside(self, plan: Plan) -> AbstractContextManager[Plan]:
        if self._console is not None:
            self._console.say(f"bus: {plan.choice.transport} ({plan.choice.reason})")
            self._console = None
        return nullcontext(plan)


def work(namespace: argparse.Namespace) -> int:
    """Run all, write the comparison, print; no comparison is written before all laws have run.

    Recorded runs are kept if the comparison is stopped or a run fails.
    """
    wanted = _planned(namespace)
    check_key(namespace.sign)
    scenario = wanted[0].load()
    plan, notes = _checked(namespace, scenario, wanted)
    plan = [with_requirements(spec, ()) for spec in plan]
    console = Output(stderr=namespace.json)
    for sentence in notes:
        console.say(sentence)
    observers: list[Observer] = [_BusLine(console)]
    observers += [] if namespace.quiet or namespace.json else [Progress(lambda: console)]
    folder: Path | None = None
    made = False
    runs: list[tuple[Path, Record]] = []
    places = _places(plan)
    codes: list[int] = []
    try:
        for spec in plan:
            if folder is None:
                folder, made = run_folder(namespace.out, scenario.name, "compare")
            own = folder / places[len(runs)]
            try:
                result = record_run(replace(spec, out=own), *observers, scenario=scenario)
            finally:
                if made and not any(folder.iterdir()):
                    folder.rmdir()
            runs.append((own, as_recorded(result)))
            codes.append(result.exit_code)
            if result.stopped_exit_code:
                print_verdict(console, "INVALID", f"{result.line or 'stopped'}; {_so_far(runs, plan, folder)}")
                return result.stopped_exit_code
    except BaseException:
        # Recorded runs are kept after Ctrl-C, too, and the message says so.
        if runs and folder is not None:
            console.say(_so_far(runs, plan, folder))
        raise
    assert folder is not None
    found = [run for _, run in runs]
    document = write_comparison(folder, scenario, plan[0], runs, notes)
    print_scores(console, scenario, [(f"{run.label} (measured)", run.score) for run in found], every_stop=False)
    report = "" if namespace.no_report else report_line(found, folder, notes)
    sign_list(folder, namespace.sign)
    if remark := found[0].judging.remark([run.score for run in found]):
        console.say(f"runs that {remark}")
    for line in assumption_lines(scenario, namespace.scenario, folder, namespace.verbose):
        console.say(line, style="dim")
    print_watch(console, scenario)
    for run in found:
        console.say(f"{run.label}: {parameters_sentence(run)}", style="dim")
    console.say(f"comparison {folder}")
    if report:
        console.say(report)
    for run in found:
        if run.caution:
            console.say(run.caution, style="bold yellow")
    for run in found:
        print_verdict(console, run.verdict, f"{run.label}{': ' if run.line else ''}{run.line}")
    if namespace.json:
        print_json(document)
    return max(codes)


def _so_far(runs: Sequence[tuple[Path, Record]], plan: Sequence[RunSpec], folder: Path) -> str:
    return f"{len(runs)} of {count_of(len(plan), 'run')} recorded in {folder}, no comparison written"


_CHECK_S = 120.0


@dataclass(frozen=True, slots=True)
class Checked:
    """A law's declarations, and the line and exit code with which it refused (empty and 0 if it can run)."""

    indexings: tuple[str, ...]
    origin: LawOrigin
    line: str
    exit_code: int

    def require(self) -> None:
        """Continue only if the controller can run.

        :raises NeverBegan: it refused to run.
        """
        if self.exit_code:
            raise NeverBegan(self.line, self.exit_code)


def check_controllers(wanted: Sequence[RunSpec]) -> list[Checked]:
    """Make the controller of each run once, all at once, each in its own process without a bus.

    :raises NeverBegan: a process ended before it could describe its law.
    """
    with ExitStack() as stack:
        started = []
        for spec in wanted:
            command = [sys.executable, "-P", "-m", "railhil.controller_node", *spec.scenario_words]
            command += [*spec.law.words, "--check"]
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            stack.callback(process.wait)
            stack.callback(process.kill)
            started.append(process)
        return [_answer(spec, process) for spec, process in zip(wanted, started, strict=True)]


def _answer(spec: RunSpec, process: subprocess.Popen[str]) -> Checked:
    said, complaint = process.communicate(timeout=_CHECK_S)
    lines = [line for line in complaint.splitlines() if line.strip()]
    line = lines[-1] if lines else f"{spec.law.controller}: exit code {process.returncode}"
    try:
        document = json.loads(said)
        indexings, origin = tuple(map(str, document["indexings"])), law_origin(document)
    except (ValueError, LookupError, TypeError, AttributeError):
        raise NeverBegan(line, process.returncode or InputError.exit_code) from None
    return Checked(indexings, origin, line, process.returncode)
