"""``railhil score``: computes the same numbers again, from the log alone."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from railhil.cli.result_printer import print_requirements, print_scores, print_verdict, print_watch
from railhil.common.exit_codes import FAIL, INVALID, PASS
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.judge.events.summary import explained, summary, why
from railhil.judge.record import Record, checked_record
from railhil.record.documents import CERTIFICATE
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
        ],
    )
    add_options(parser, "log", "--scenario", "--requirements")
    add_json_argument(parser)
    parser.set_defaults(work=work)


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
