"""``railhil rerun``: repeats a recorded run and compares the two records."""

from __future__ import annotations

import argparse
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

from railhil.bus.can_settings import LOCAL, add_bus_arguments, named_bus
from railhil.common.digits import count_of
from railhil.common.errors import InputError
from railhil.common.exit_codes import FAIL, PASS
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.dbc import Contract, recorded_contract
from railhil.judge import rerun as again
from railhil.judge.result import Result
from railhil.record.difference import Difference, first_difference
from railhil.record.framelog import read_log
from railhil.run.make import record_run
from railhil.scenarios.options import add_code_options, add_option, named_code


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("rerun", examples=["railhil rerun runs/mine"])
    parser.add_argument("run", metavar="RUN", help="run folder, or its certificate.json")
    add_option(parser, "--bus", default=None, usual="local, without -i and the like")
    add_option(parser, "--out DIR", usual="none, unless the repeated run differs")
    add_code_options(parser)
    add_json_argument(parser)
    add_bus_arguments(parser)


def work(namespace: argparse.Namespace) -> int:
    """Repeat, compare, print; exit code 0 for the same bytes (of the contract, on a shared bus), 1 for others."""
    code = named_code(namespace)
    run = again.certified_run(namespace.run, code)
    if code.controller is None:
        _check_law(namespace.controller, run)
    again.repeatable(run)
    console = Output(stderr=namespace.json)
    given = named_bus(namespace)
    spec = replace(run.spec, bus=namespace.bus or ("auto" if given else LOCAL), can=given)
    notes = again.changes(run)
    scenario, changed = again.scenario_now(run, spec.is_local)
    notes += [changed] if changed else []
    for note in notes:
        console.say(f"note: {note}")
    kept = namespace.out is not None
    place = namespace.out if kept else tempfile.mkdtemp(prefix="railhil-rerun-")
    try:
        result = record_run(replace(spec, out=place), scenario=scenario)
    finally:
        if not kept and not any(Path(place).iterdir()):
            # The run never began.
            Path(place).rmdir()
    folder = result.place
    if result.stopped_exit_code:
        console.say(f"not compared: {result.line}; the repeated run is in {folder}")
        return result.stopped_exit_code
    equal = result.frames_sha256 == run.sha256
    # One of the two records may have foreign frames, from a shared bus.
    shared = bool(run.certificate.get("other_frames") or result.other_frames)
    same = equal or (shared and result.telegrams_sha256 == run.telegrams_sha256)
    found = None if same else _difference(run, folder / "frames.log", scenario.installed_system.contract)
    if same and not kept:
        shutil.rmtree(folder)
    if namespace.json:
        print_json(
            {
                "same": same,
                "recorded_sha256": run.sha256,
                "frames_sha256": result.frames_sha256,
                "telegrams_sha256": result.telegrams_sha256,
                "notes": notes,
                "difference": None if found is None else found.as_json(),
                "folder": str(folder) if kept or not same else None,
            }
        )
    elif same:
        said = f"{count_of(result.frames, 'frame')}, {run.spec.scenario}, seed {spec.seed}, on {result.transport}"
        what = "bytes: frames.log" if equal else f"telegrams, {_others(run, result)}:"
        console.say(f"same {what} sha256 {result.frames_sha256 if equal else result.telegrams_sha256} ({said})")
    else:
        console.say(f"other bytes: frames.log sha256 {result.frames_sha256}, recorded {run.sha256}")
        where = f"no frames.log beside {run.certificate_path} to compare with"
        console.say(f"first difference: {where if found is None else found.sentence}")
        console.say(f"the repeated run is in {folder}" + (f": {result.line}" if result.line else ""))
    return PASS if same else FAIL


def _check_law(law: str | None, run: again.CertifiedRun) -> None:
    """Refuse a law that is not the one of the record: the repeated run would have other bytes.

    :raises InputError: it is another one.
    """
    recorded = run.spec.law.controller
    if law not in (None, recorded):
        allowed = (
            f"{recorded}, the controller of the record; "
            f"railhil run --spec {run.certificate_path} --controller {law} runs the same with another"
        )
        raise InputError("command line", "--controller", law, allowed)


def _others(run: again.CertifiedRun, result: Result) -> str:
    """Number of foreign frames in each record."""
    recorded = run.certificate.get("other_frames")
    return f"beside {recorded} recorded frames of others and {result.other_frames} now"


def _difference(run: again.CertifiedRun, repeated: Path, now: Contract) -> Difference | None:
    """The first difference of the records; None without the record."""
    if run.log is None:
        return None
    was = recorded_contract(run.log.parent, run.certificate.get("dbc_sha256"), now)
    return first_difference(read_log(run.log), read_log(repeated), was, now)
