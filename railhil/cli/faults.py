"""``railhil faults``: the fault catalogue or random pairs of faults on a scenario, and the reaction to each."""

from __future__ import annotations

import argparse
import shutil
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.cli.fault_pairs import pairs
from railhil.cli.fault_table import check_new, keep_table, says_by_id
from railhil.cli.run import add_arguments, run_spec, run_system
from railhil.common.command_line import whole_number
from railhil.common.digits import count_of
from railhil.common.errors import InputError, OptionError
from railhil.common.exit_codes import FAIL, INVALID, PASS
from railhil.common.output import Output, show_progress, table
from railhil.common.streams import add_json_argument, print_json
from railhil.faults.capability import why_not
from railhil.faults.language import parse
from railhil.faults.page import lines
from railhil.faults.words import CLEAR, PLACES, WORDS
from railhil.judge.reactions.catalogue import Entry, catalogue_of
from railhil.judge.reactions.evaluate import Row, decided, evaluated, seen_in
from railhil.judge.requirements.sentence import VIOLATED
from railhil.record.run_folder import remove_torn_run
from railhil.record.signature import add_sign_argument, check_key
from railhil.run.make import NeverBegan, run_into
from railhil.run.spec import with_requirements
from railhil.scenarios.given import given_controller
from railhil.scenarios.options import OR_YOURS, add_option
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import System
from railhil.study.engines import processes, processors, until_stopped

_PAIRS_MAX = 1_000_000
_COLUMNS = ("id", "fault", "begun s", "effective s", "detected by", "ms", "reaction", "ms", "bound", "margin", "")
_NUMBERS = ("begun s", "effective s", "ms", "bound", "margin")


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "faults",
        examples=["railhil faults --only T1,S1", "railhil faults yizhuang_05 --pairs 20", "railhil faults --list"],
        description="Exit code 0 when every entry reacts as it must, or every pair keeps the rules, else 1; 3 when no "
        "entry could be run.",
    )
    add_arguments(parser, bus="local")
    add_option(parser, "--controller", OR_YOURS)
    add_option(parser, "--list", " what can be injected, word by word")
    add_option(parser, "--only", ": entries by id, or by its beginning", metavar="T1,S,...")
    parser.add_argument(
        "--pairs", type=whole_number(1, _PAIRS_MAX), metavar="N", help="N random pairs of faults instead"
    )
    add_option(parser, "--jobs", ", with --bus local", default=processors())
    add_option(parser, "--out DIR", ", a folder for each entry", type=Path, usual="none is kept")
    add_option(parser, "--requirements")
    add_sign_argument(parser)
    add_json_argument(parser)


def _entries(only: str | None, system: System) -> list[Entry]:
    """Entries of the catalogue.

    :param only: their ids, or beginnings of them; None: all. :raises InputError: one of them begins no id.
    """
    known = catalogue_of(system)
    if only is None:
        return list(known)
    wanted = [item.strip() for item in only.split(",")]
    for item in wanted:
        if not item or not any(entry.id.startswith(item) for entry in known):
            raise InputError("command line", "--only", item, ", ".join(entry.id for entry in known))
    return [entry for entry in known if any(entry.id.startswith(item) for item in wanted)]


def _check_out(out: Path | None, entries: Sequence[Entry]) -> None:
    """Refuse to overwrite recorded runs. Raises InputError."""
    if out is not None and out.exists() and not out.is_dir():
        raise InputError("command line", "--out", str(out), "a folder")
    for folder in () if out is None else (out / entry.id for entry in entries):
        if folder.is_dir() and any(folder.iterdir()):
            raise InputError("command line", "--out", str(folder), "an empty or new folder for each entry")


def _can_be(entry: Entry, transport: str, pace: str) -> bool:
    """Whether the faults of an entry can be injected there."""
    return not any(why_not(parse(text), transport, pace) for text in entry.faults)


def needs_hub(base: RunSpec, entry: Entry) -> bool:
    """Whether an entry cannot be run in this process but on a hub, and the user has chosen no bus."""
    return base.is_local and not _can_be(entry, "local", base.pace)


def entry_run(base: RunSpec, out: Path, keep: bool, entry: Entry) -> Row:
    """One entry as a run, with its folder in ``out``. Without a run there is no folder.

    A folder that is there has been left by a worker that died, and is removed.

    :param keep: whether the folder is to be complete.
    """
    if entry.seen_in:
        return Row(entry)
    law = base.law
    if entry.law:
        law = replace(law, controller=entry.law)
        if law.given is not None:
            # The law computes in another arithmetic than the controller of the user.
            law = replace(law, given=None, arithmetic=base.load().installed_system.arithmetic)
    spec = replace(base, law=law, faults=entry.faults)
    if needs_hub(base, entry):
        # The hub is the only transport with controllers, lines and processes of its own; faults on the wall clock need
        # real time.
        pace = "lockstep" if _can_be(entry, "hub", "lockstep") else "realtime"
        spec = replace(spec, bus="auto", pace=pace, can={**spec.can, "interface": HUB_INTERFACE})
    remove_torn_run(out / entry.id)
    try:
        result = run_into(out / entry.id, spec, keep=keep)
    except InputError as error:
        return Row(entry, refused=error.allowed)
    except NeverBegan as error:
        return Row(entry, verdict="none", failures=[str(error)])
    row = evaluated(entry, seen_in(result, entry))
    if not row.made:
        # The condition of its faults did not occur: the table has no run of it, nor the folder.
        shutil.rmtree(out / entry.id)
        return row
    outcomes = result.score.requirements
    violated = [one.short_line for one in outcomes if one.violated]
    return replace(row, failures=[*row.failures, *violated], requirements=decided(outcomes))


def _millis(seconds: float | None, since_s: float | None) -> str:
    return "-" if seconds is None or since_s is None else f"{(seconds - since_s) * 1e3:.0f}"


def _bound(row: Row) -> tuple[str, str]:
    """Bound and margin."""
    after_ms, within_ms = row.bound
    margin = "-" if within_ms is None or after_ms is None else str(round(within_ms - after_ms))
    return "-" if within_ms is None else str(within_ms), margin


def _print_rows(console: Output, rows: Sequence[Row], sentences: Mapping[str, str]) -> None:
    """The table of reactions; the times are in ms from the first effect.

    :param sentences: by id; those that a run has violated stand below the table.
    """
    shown = table(tight=True)
    for name in _COLUMNS:
        shown.add_column(name, justify="right" if name in _NUMBERS else "left")
    for row in rows:
        entry = row.entry
        if row.refused or entry.seen_in:
            note = f"not here: {row.refused}" if row.refused else f"see {entry.seen_in}"
            shown.add_row(entry.id, entry.title, "", "", note)
            continue
        shown.add_row(
            entry.id,
            "; ".join(entry.faults),
            "-" if row.begun_s is None else f"{row.begun_s:.2f}",
            "-" if row.effective_s is None else f"{row.effective_s:.2f}",
            row.detected_by or "-",
            _millis(row.detected_s, row.effective_s),
            row.said_reaction,
            _millis(row.reaction_s, row.effective_s),
            *_bound(row),
            "; ".join(row.failures) or "ok",
        )
    console.print(shown)
    for row in rows:
        if row.entry.limit and not row.refused:
            console.say(f"{row.entry.id}: {row.entry.limit}")
    violated = {id_ for row in rows for id_, verdict in row.requirements.items() if verdict == VIOLATED}
    for id_, says in sentences.items():
        if id_ in violated:
            console.say(f"{id_}: {says}")


def work(namespace: argparse.Namespace) -> int:
    """Run the catalogue or the pairs; the exit code tells whether all reactions are as required."""
    if namespace.list:
        print_words(namespace.json)
        return PASS
    system = run_system(namespace)
    if namespace.controller and given_controller(namespace.controller) is None:
        system.check_law(namespace.controller, "command line", "--controller")
    base = with_requirements(run_spec(namespace, namespace.controller, None), namespace.requirements)
    jobs = namespace.jobs if base.is_local else 1
    console = Output(stderr=namespace.json)
    check_key(namespace.sign)
    keep = partial(keep_table, namespace.out, base, key=namespace.sign, is_shown=not namespace.no_report)
    if namespace.pairs is not None:
        if namespace.only is not None:
            raise OptionError("--only", "cannot be given with --pairs")
        check_new(namespace.out)
        named, as_json = namespace.controller, namespace.json
        return pairs(base, system, namespace.pairs, jobs, console, keep, controller=named, as_json=as_json)
    entries = _entries(namespace.only, system)
    _check_out(namespace.out, entries)
    rows: list[Row] = []
    with until_stopped() as stop, ExitStack() as held:
        out = namespace.out or Path(held.enter_context(TemporaryDirectory(prefix="railhil-faults-")))
        run = partial(entry_run, base, out, namespace.out is not None)
        # Entries with processes of their own come last, one at a time.
        alone = [entry for entry in entries if entry.faults and needs_hub(base, entry)]
        beside = [entry for entry in entries if entry not in alone]
        shown = held.enter_context(show_progress(console, "runs", len(entries)))
        for some, at_once in ((beside, jobs), (alone, 1)):
            with processes(at_once, Output(stderr=True).say)(run, some) as results:
                for _, row in results:
                    rows.append(row)
                    shown(len(rows), "runs")
        rows.sort(key=lambda row: entries.index(row.entry))
    line = keep(entries=[entry.id for entry in entries], rows=[row.as_json() for row in rows]) if rows else ""
    if namespace.json:
        print_json([row.as_json() for row in rows])
    else:
        _print_rows(console, rows, says_by_id(base))
    wrong = [row.entry.id for row in rows if row.failures]
    made = sum(row.made for row in rows)
    left = [row.entry.id for row in rows if not row.made]
    if stop.code:
        console.say(f"{stop.after(len(rows), len(entries))} entries")
    console.say(f"{count_of(made, 'run')}, {len(wrong)} not as they must be{': ' + ', '.join(wrong) if wrong else ''}")
    if line:
        console.say(line)
    if left:
        console.say(f"{count_of(len(left), 'entry', 'entries')} without a run here: {', '.join(left)}")
    # Nothing is known without a run.
    return stop.code or (FAIL if wrong else PASS if made else INVALID)


def _document() -> dict[str, Any]:
    words = [
        {
            "level": word.level,
            "part": word.part,
            "word": word.name,
            "places": list(word.names or PLACES.get(word.level, {})),
            "what": word.meaning,
            "after": list(word.after),
            "values": [
                {"name": one.name, "unit": one.unit, "usual": one.usual, "keyword": one.keyword, "what": one.meaning}
                for one in word.parameters
            ],
            "origin": word.origin,
        }
        for word in WORDS
        if word.name != CLEAR
    ]
    return {"words": words}


def print_words(as_json: bool) -> None:
    """Print all words."""
    if as_json:
        print_json(_document())
    else:
        console = Output()
        for line in lines():
            console.say(line)
