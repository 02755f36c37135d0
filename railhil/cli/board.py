"""``railhil board check``: the first check of a controller on a bus, before its first run."""

from __future__ import annotations

import argparse
from typing import Final

from railhil.bus.administrator import REPLY_NS
from railhil.bus.can_settings import add_bus_arguments, named_bus
from railhil.bus.link import open_link
from railhil.bus.select import choose_bus
from railhil.common.command_line import RATE, whole_number
from railhil.common.digits import count_of
from railhil.common.output import Output, number, table, whole
from railhil.common.streams import add_json_argument, print_json
from railhil.run.first_check import PATIENCE_S, POLLS, Checked, FirstCheck
from railhil.scenarios.load import stable_name
from railhil.scenarios.options import add_option, add_options
from railhil.scenarios.run_spec import RunSpec

#: More polls than that are a run.
_POLLS_MAX: Final = 1000


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommands."""
    kinds = commands.add_parser("board").add_subparsers(dest="kind", required=True, metavar="KIND")
    parser = kinds.add_parser(
        "check",
        help="handshake and some polls with a controller, and what is wrong with its answers",
        examples=[
            "railhil board check -i socketcan -c can0",
            "railhil board check -i socketcan -c can0 --pace realtime",
        ],
        description="Polls a controller as the bus administrator of a run does, while the train stands. Exit code 1 if "
        "an answer is wrong, 3 if no controller answers (docs/reference/wire.md).",
    )
    add_options(parser, "scenario", "--set", "--pace", "--rate", "--appear-timeout")
    add_option(parser, "--patience", default=PATIENCE_S, usual=f"{PATIENCE_S:g} s")
    parser.add_argument(
        "--polls", type=whole_number(1, _POLLS_MAX), default=POLLS, metavar="N",
        help=f"polls of the first command (default: {POLLS})",
    )  # fmt: skip
    add_json_argument(parser)
    add_bus_arguments(parser)


def work(namespace: argparse.Namespace) -> int:
    """Check the controller on a bus; returns the exit code.

    :raises InputError: no such scenario, or the bus is not named rightly.
    :raises BusUnavailable: the bus cannot be opened.
    :raises PeerSilent: no controller answers.
    """
    run = RunSpec(
        stable_name(namespace.scenario),
        settings=tuple(namespace.set),
        pace=namespace.pace,
        rate=namespace.rate or RATE,
        patience_s=namespace.patience,
    )
    scenario = run.load()
    choice = choose_bus(named_bus(namespace))
    console = Output(stderr=namespace.json)
    console.say(f"bus: {choice.transport} ({choice.reason})")
    link = open_link(choice.config, "plant")
    try:
        found = FirstCheck(
            link, scenario, run, fd=choice.fd, appear_s=namespace.appear_timeout, polls=namespace.polls
        ).check()
    finally:
        link.close()
        link.tell_trouble()
    if namespace.json:
        print_json(document(found))
    else:
        show(console, found, namespace.pace)
    return found.exit_code


def document(found: Checked) -> dict[str, object]:
    """The result as JSON."""
    return {
        "verdict": "FAIL" if found.faults else "PASS",
        "faults": found.faults,
        "notes": found.notes,
        "stated": found.stated,
        "lives": found.lives,
        "latency_ms": {
            name: {"min": least, "median": median, "max": most}
            for name, (least, median, most) in found.latencies_ms().items()
        },
        "other_frames": found.others,
        "answers": [
            {"tick": one.tick, "poll": one.name, "latency_ns": one.latency_ns, "values": one.values}
            for one in found.answers
        ],
    }


def show(console: Output, found: Checked, pace: str) -> None:
    """Print the answers, what they say, and the faults."""
    rows = table(number("tick"), whole("poll"), number("ms"), "answer")
    for one in found.answers:
        latency = "-" if one.latency_ns is None else f"{one.latency_ns / 1e6:.2f}"
        said = one.values or ("no answer" if one.latency_ns is None else "not understood")
        rows.add_row("-" if one.tick < 0 else f"{one.tick}", one.name, latency, said)
    console.print(rows)
    if found.stated:
        console.say(", ".join(f"{name}: {value}" for name, value in found.stated.items()))
    for name, lives in found.lives.items():
        console.say(f"life signs of {name}: {' '.join(map(str, lives))}")
    limit = f"{REPLY_NS / 1e6:g} ms"
    for name, (least, median, most) in found.latencies_ms().items():
        said = "" if pace == "realtime" or most <= REPLY_NS / 1e6 else f"; in real time {limit} are allowed"
        console.say(f"answers to {name}: {least:.2f} / {median:.2f} / {most:.2f} ms (min / median / max){said}")
    if found.others:
        console.say(f"{count_of(found.others, 'frame')} with identifiers that the bench does not have")
    for line in (*found.notes, *found.faults):
        console.say(line)
    console.say("FAIL" if found.faults else "PASS")
