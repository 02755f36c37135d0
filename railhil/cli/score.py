"""``railhil score``: computes the same numbers again, from the log alone."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from railhil.cli.result_printer import print_requirements, print_scores, print_verdict, print_watch
from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import FAIL, INVALID, PASS
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.common.user_files import refuse_unwritable
from railhil.common.version import full_version
from railhil.judge.events.summary import explained, summary, why
from railhil.judge.record import Record, checked_record
from railhil.record.documents import CERTIFICATE
from railhil.record.framelog import log_sha256
from railhil.record.hash_list import check_free
from railhil.report.facts import memory_sentence
from railhil.scenarios.options import add_options
from railhil.scenarios.settings import required


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "score",
        examples=[
            "railhil score runs/mine",
            "railhil score runs/mine --json",
            "railhil score runs/mine --requirements train.reqif --results judged.reqif",
        ],
    )
    add_options(parser, "log", "--scenario", "--requirements")
    parser.add_argument("--results", metavar="PATH", help="write a copy of the list in ReqIF with the outcomes")
    add_json_argument(parser)


def further_required(record: Record, words: Sequence[str], scenario: str = "") -> Record:
    """The record, judged by further requirements, too; those that it is judged by already count once.

    :param scenario: whose own requirements are further ones, too; empty: none.

    :raises InputError: a file cannot be read, a sentence does not fit, or an id is given twice.
    """
    from railhil.judge.requirements.outcome import with_requirements
    from railhil.judge.requirements.requirement import (
        check_requirements,
        named_requirements,
        requirements_from_json,
        scenario_requirements,
    )

    path = record.folder / CERTIFICATE
    known = requirements_from_json(required(record.certificate, path), path)
    own = [one for one in scenario_requirements(scenario) if one not in known] if scenario else []
    further = [*own, *named_requirements(words, (*known, *own))]
    check_requirements([*known, *further], record.scenario)
    return record.copy_with(score=with_requirements(record, further))


def _write_results(record: Record, words: Sequence[str], invalid: str, out: str) -> None:
    """Write the outcomes into a copy of the only list among files of requirements.

    :param invalid: why the run was not judged; empty: it was.
    :raises InputError: there is not exactly one list.
    """
    from railhil.judge.requirements.lists import Result, is_list, result_of, write_results
    from railhil.judge.requirements.outcome import NOT_JUDGED

    lists = [Path(word) for word in words if is_list(word)]
    if len(lists) != 1:
        allowed = "--requirements with one list in ReqIF"
        raise InputError("command line", "--results", Words(count_of(len(lists), "list")), allowed)
    check_free("--results", Path(out), lists)
    frames = record.frames_sha256 or log_sha256(record.log)
    run = f"{record.title}, verdict {record.verdict}, frames.log sha256 {frames}, railhil {full_version()}"
    results = {
        one.id: Result(NOT_JUDGED, f"{invalid}, {run}") if invalid else result_of(one, run)
        for one in record.score.requirements
    }
    with refuse_unwritable("--results", Path(out), "file"):
        write_results(lists[0], results, Path(out))


def work(namespace: argparse.Namespace) -> int:
    """Score and print; the exit code is the verdict."""
    record = checked_record(namespace.log, namespace.scenario)
    if namespace.requirements or namespace.scenario:
        record = further_required(record, namespace.requirements, namespace.scenario or "")
    found, events = record.score, record.events
    reason = why(record.scenario, events)
    verdict, line = found.verdict, "; ".join(found.failures)
    if record.invalid:
        # The reason why the run was INVALID (its timing, a killed node) need not be visible in the log.
        own = (line,) if verdict == "INVALID" else ()
        verdict, line = "INVALID", "; ".join(dict.fromkeys((*own, record.invalid)))
    if namespace.results is not None:
        _write_results(record, namespace.requirements, line if verdict == "INVALID" else "", namespace.results)
    if namespace.json:
        beside = {"watch_weakened": record.scenario.watch_weakened, "memory": record.certificate.get("memory")}
        beside |= {"notes": list(record.notes), "why": reason, "events": summary(record.scenario, events)}
        print_json({**found.as_json(), **beside, "verdict": verdict, "line": line})
    else:
        console = Output()
        print_scores(console, record.scenario, [("from the log", found)])
        print_watch(console, record.scenario)
        for note in record.notes:
            console.say(note, style="bold yellow")
        if memory := memory_sentence(record.certificate):
            console.say(f"memory: {memory}")
        print_requirements(console, found)
        print_verdict(console, verdict, explained(line, reason))
    return {"PASS": PASS, "FAIL": FAIL}.get(verdict, INVALID)
