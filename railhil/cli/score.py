"""``railhil score``: computes the same numbers again, from the log alone."""

from __future__ import annotations

import argparse

from railhil.cli.result_printer import print_scores, print_verdict, print_watch
from railhil.common.exit_codes import FAIL, INVALID, PASS
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.judge.events.summary import explained, summary, why
from railhil.judge.record import checked_record
from railhil.report.facts import memory_sentence
from railhil.scenarios.options import add_options


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "score",
        examples=[
            "railhil score runs/mine",
            "railhil score runs/mine --json",
        ],
    )
    add_options(parser, "log", "--scenario")
    add_json_argument(parser)
    parser.set_defaults(work=work)


def work(namespace: argparse.Namespace) -> int:
    """Score and print; the exit code is the verdict."""
    record = checked_record(namespace.log, namespace.scenario)
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
        print_verdict(console, verdict, explained(line, reason))
    return {"PASS": PASS, "FAIL": FAIL}.get(verdict, INVALID)
