"""``railhil sequence run|verify|rerun``: runs of a law that learns, recorded as one piece of evidence."""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

from railhil.bus.can_settings import LOCAL, add_bus_arguments, named_bus
from railhil.cli.panel import add_page_argument, panel_process, require_websockets
from railhil.cli.run import add_arguments, run_spec, run_system
from railhil.common.command_line import OneLineParser, run_command, whole_number
from railhil.common.digits import count_of
from railhil.common.errors import InputError
from railhil.common.exit_codes import FAIL, PASS, run_guarded
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.controller_node.laws import find
from railhil.controller_node.laws.memory import require_memory
from railhil.judge.criteria import limited
from railhil.judge.judging import judging_of
from railhil.judge.result import Result
from railhil.record.run_folder import run_folder
from railhil.record.signature import add_sign_argument, check_key, sign_list
from railhil.run.report import say_report
from railhil.scenarios.memory_store import read_memory
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.options import add_option, add_options
from railhil.scenarios.parameters import load_parameters
from railhil.scenarios.run_spec import RunSpec
from railhil.sequences.evidence import SEQUENCE, Evidence, problems, read_evidence, run_name
from railhil.sequences.plan import RUNS_MAX, SCENARIO
from railhil.sequences.record import Told, begin, record

_RUNS = 15
#: Wall time for which the page of a finished sequence stays.
_SHOWN_S = 1.0


def arguments() -> argparse.ArgumentParser:
    """Command line of ``railhil sequence``."""
    parser = OneLineParser(prog="railhil sequence", description="Runs of a law that learns, as one piece of evidence.")
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="VERB", parser_class=OneLineParser)
    run = verbs.add_parser(
        "run",
        help="record a sequence; an interrupted one is gone on with",
        examples=["railhil sequence run yizhuang_stop --runs 5 --out runs/sequence"],
    )
    add_arguments(run, scenario=SCENARIO)
    add_option(run, "--controller", ", with a memory")
    add_options(run, "--parameters", "--memory-from")
    add_option(run, "--runs", type=whole_number(1, RUNS_MAX), default=_RUNS, usual=str(_RUNS))
    add_option(run, "--out DIR", usual="runs/<utc>-<scenario>-sequence")
    add_page_argument(run)
    add_sign_argument(run)
    verify = verbs.add_parser(
        "verify",
        help="check every file of a sequence against its hashes",
        examples=["railhil sequence verify runs/sequence"],
    )
    verify.add_argument("sequence", type=Path, metavar="DIR", help="folder of a sequence")
    rerun = verbs.add_parser(
        "rerun",
        help="make the sequence again: the same bytes, or the first run that differs",
        examples=["railhil sequence rerun runs/sequence"],
    )
    rerun.add_argument("sequence", type=Path, metavar="DIR", help="folder of a sequence")
    add_option(rerun, "--bus", default=None, usual="local, without -i and the like")
    add_bus_arguments(rerun)
    for verb in (run, verify, rerun):
        add_json_argument(verb)
    return parser


def _run(namespace: argparse.Namespace) -> int:
    check_key(namespace.sign)
    system = run_system(namespace)
    name = namespace.controller or system.law
    system.check_law(name, "command line", "--controller")
    given = None if namespace.parameters is None else load_parameters(namespace.parameters.resolve())
    first = run_spec(namespace, name, given)
    scenario = first.load()
    require_memory(name, {law: find(law, system.laws) for law in system.law_names()}, scenario)
    if first.run_number != 1:
        raise InputError("command line", "--run-number", first.run_number, "1: a sequence begins with its first run")
    if namespace.memory_from is not None:
        first = replace(first, law=replace(first.law, memory=read_memory(namespace.memory_from.resolve())))
    console = Output(stderr=namespace.json)
    with begin(first, scenario, namespace.runs, namespace.out) as (folder, evidence):
        found = _record(first, scenario, folder, evidence, console, namespace.panel)

        def write(page: Path) -> None:
            from railhil.sequences.recorded import report_of

            report_of(folder, page)

        line = "" if namespace.no_report else say_report(folder, write)
        sign_list(folder, namespace.sign)
    if namespace.json:
        print_json(found.as_json())
    console.say(f"sequence sha256 {found.sha256}")
    console.say(f"folder {folder}")
    if line:
        console.say(line)
    return PASS


def _record(
    first: RunSpec, scenario: AnyScenario, folder: Path, evidence: Evidence, console: Output, panel: int | None
) -> Evidence:
    """Make the runs that are missing.

    :param panel: port of the page that shows them; None: there is none.
    """
    if evidence.made:
        console.say(f"{folder}: {len(evidence.made)} of {evidence.runs} runs are there already")
    try:
        with _page(panel, folder, bool(evidence.made)) as shown:
            say = _told(console, scenario)

            def told(number: int, result: Result) -> None:
                say(number, result)
                shown()

            return record(folder, evidence, scenario, first, told)
    except KeyboardInterrupt:
        done = len(read_evidence(folder).made)
        raise KeyboardInterrupt(f"stopped; {done} of {evidence.runs} runs are in {folder}") from None


@contextmanager
def _page(port: int | None, folder: Path, has_runs: bool) -> Iterator[Callable[[], None]]:
    """The page of a sequence (``railhil panel FOLDER``); it needs a finished run: call the yielded function after
    each."""
    if port is None:
        yield lambda: None
        return
    require_websockets()
    with ExitStack() as held:
        is_shown = False

        def shown() -> None:
            nonlocal is_shown
            if not is_shown:
                held.enter_context(panel_process([str(folder), "--port", str(port), "--child"]))
                is_shown = True

        if has_runs:
            shown()
        yield shown
        # Time to show the last run.
        time.sleep(_SHOWN_S)


def _told(console: Output, scenario: AnyScenario) -> Told:
    criteria = limited(judging_of(scenario).criteria, scenario)

    def told(number: int, result: Result) -> None:
        values = {**result.score.values, **result.score.signed}
        figures = [f"{one.title} {one.shown(values[one.signed or one.key])} {one.unit}" for one in criteria]
        left = "no record" if result.memory is None or result.memory.record is None else result.memory.record.digest
        console.say(f"run {number}: {result.verdict}, {', '.join(figures)}, left {left}")

    return told


def _verify(namespace: argparse.Namespace) -> int:
    found = [*problems(namespace.sequence)]
    evidence = read_evidence(namespace.sequence)
    if namespace.json:
        print_json({"sha256": evidence.sha256, "runs": evidence.runs, "problems": found})
        return FAIL if found else PASS
    console = Output()
    for problem in found:
        console.say(problem, style="red")
    said = "does not fit its files" if found else "every file fits"
    console.say(f"sequence of {count_of(evidence.runs, 'run')}, sha256 {evidence.sha256}: {said}")
    return FAIL if found else PASS


def _rerun(namespace: argparse.Namespace) -> int:
    recorded = read_evidence(namespace.sequence)
    if not recorded.complete:
        found = f"{len(recorded.made)} of {count_of(recorded.runs, 'run')}"
        raise InputError(namespace.sequence / SEQUENCE, "made", found, "a complete sequence (railhil sequence run)")
    given = named_bus(namespace)
    first = replace(recorded.first, bus=namespace.bus or ("auto" if given else LOCAL), can=given)
    console = Output(stderr=namespace.json)
    folder = Path(tempfile.mkdtemp(prefix="railhil-sequence-"))
    scenario = first.load()
    run_folder(str(folder), scenario.name, "sequence")
    made = record(folder, Evidence(first, recorded.runs, ()), scenario, first, lambda number, result: None)
    differs = next((now.run for then, now in zip(recorded.made, made.made, strict=True) if then.line != now.line), None)
    if namespace.json:
        document = {"same": differs is None, "recorded_sha256": recorded.sha256, "sha256": made.sha256}
        print_json(document | {"first_difference": differs, "folder": None if differs is None else str(folder)})
    if differs is None:
        shutil.rmtree(folder)
        console.say(f"same bytes: {count_of(recorded.runs, 'run')}, sequence sha256 {made.sha256}")
        return PASS
    console.say(f"other bytes: sequence sha256 {made.sha256}, recorded {recorded.sha256}")
    console.say(f"first difference: run {differs}; the repeated one is {folder / run_name(differs)}")
    return FAIL


def main(words: Sequence[str] | None = None) -> int:
    """Record, verify or repeat."""
    verbs = {"run": _run, "verify": _verify, "rerun": _rerun}
    return run_command(arguments(), words, lambda namespace: verbs[namespace.verb](namespace))


if __name__ == "__main__":
    sys.exit(run_guarded("railhil sequence", main))
