"""``railhil branch``: a recorded run again, with other faults from an instant on; the point of no return of a run."""

from __future__ import annotations

import argparse
from dataclasses import asdict

from railhil.common.errors import InputError, OptionError, Words
from railhil.common.exit_codes import PASS
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.faults.notation import ALLOWED, trigger_of
from railhil.scenarios.options import add_code_options, add_option, add_options, named_code


def _instant(text: str) -> float:
    """An option's type: ``@150s``."""
    found = trigger_of(text.removeprefix("@"))
    if found is None or found.kind != "time" or found.delay_s:
        raise argparse.ArgumentTypeError(f"found {text}, allowed a time of the run such as @150s")
    return float(found.value)


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "branch",
        examples=[
            'railhil branch runs/mine @150s --fault "TRN_SPEED loss for 2s"',
            "railhil branch runs/mine --no-return",
        ],
    )
    parser.add_argument("run", metavar="RUN", help="run folder, or its certificate.json")
    parser.add_argument(
        "instant", metavar="@TIME", type=_instant, nargs="?", help="the run is the same before it (@150s)"
    )
    # Without a condition it is no fault of the language yet.
    add_option(parser, "--fault", "; without @WHEN it begins at @TIME", type=str)
    add_option(parser, "--no-return")
    add_option(parser, "--out DIR")
    add_options(parser, "--no-report")
    add_code_options(parser)
    add_json_argument(parser)


def work(namespace: argparse.Namespace) -> int:
    """Make the branch and print it; the exit code is its verdict. With ``--no-return``: 0."""
    if namespace.no_return:
        return _no_return(namespace)
    from railhil.cli.result_printer import print_result
    from railhil.judge.folder import score_json
    from railhil.run.branch import Trunk, branched_run, faults_from
    from railhil.run.report import as_recorded, report_line

    at_s = namespace.instant
    if at_s is None:
        raise InputError("command line", "@TIME", Words("none"), "the instant of the branch such as @150s")
    if not namespace.fault:
        raise InputError(
            "command line", "--fault", Words("none"), f'a fault such as "TRN_SPEED loss for 2s"; {ALLOWED}'
        )
    console = Output(stderr=namespace.json)
    spec = branched_run(namespace.run, named_code(namespace))
    faults = (*spec.faults, *faults_from(namespace.fault, at_s))
    with Trunk(spec) as trunk:
        trunk.advance(at_s)
        result = trunk.branch(faults, namespace.out)
    found = as_recorded(result)
    report = "" if namespace.no_report else report_line([found], result.place)
    said = f"made from the start: {trunk.straight}" if trunk.straight else "the run was not made again before it"
    notes = [f"branch at {at_s:g} s: {said}", *(one.line for one in result.faults)]
    if namespace.json:
        for line in notes:
            console.say(line)
        print_json(score_json(result))
    else:
        print_result(console, found, result, notes, report, False)
    return result.exit_code


def _no_return(namespace: argparse.Namespace) -> int:
    from railhil.batch.decision import decision_of
    from railhil.judge.record import checked_record
    from railhil.run.no_return import find_no_return, has_acting_faults

    if namespace.instant is not None or namespace.fault or namespace.out is not None:
        raise OptionError("--no-return", "cannot be given with @TIME, --fault or --out")
    record = checked_record(namespace.run, None)
    if record.verdict != "FAIL":
        raise InputError(namespace.run, "verdict", record.verdict, "FAIL: a run that its faults or its noise have lost")
    found = find_no_return(record) if has_acting_faults(record) else decision_of(record)
    if namespace.json:
        print_json(asdict(found))
    else:
        Output().say(found.sentence)
    return PASS
