"""``railhil memory``: shows, checks and exports the memory that a law has kept."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import FAIL, PASS
from railhil.common.output import Output, number, table
from railhil.common.streams import add_json_argument, print_json
from railhil.common.user_files import refuse_unwritable, write_synced
from railhil.record.hash_list import check_free
from railhil.scenarios.load import load_any
from railhil.scenarios.memory import Memory, MemoryPlace, MemoryRecord
from railhil.scenarios.memory_store import SLOT_FILES, MemoryStore, read_memory
from railhil.scenarios.options import add_option

_PATH = "folder of --memory, file in it, memory of a run folder, certificate.json"


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("memory")
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="VERB")
    show = verbs.add_parser("show", help="print every record", examples=["railhil memory show memory"])
    verify = verbs.add_parser(
        "verify",
        help="exit code 1 if a record cannot be used",
        examples=["railhil memory verify memory --scenario yizhuang_stop"],
    )
    add_option(verify, "--scenario", "; key and values are checked with the law there", usual="")
    add_option(verify, "--set")
    export = verbs.add_parser(
        "export",
        help="write the record that a run would begin with, as one file",
        examples=["railhil memory export memory --out kept.json"],
    )
    export.add_argument("--slot", choices=sorted(SLOT_FILES), help="this one instead")
    add_option(export, "--out FILE", type=Path, required=True)
    for verb in (show, verify, export):
        verb.add_argument("memory", type=Path, metavar="DIR|FILE", help=_PATH)
        add_json_argument(verb)


def work(namespace: argparse.Namespace) -> int:
    """Show, check or export."""
    if namespace.verb == "export":
        return _export(namespace)
    memory = _read(namespace.memory)
    if namespace.verb == "verify" and namespace.scenario is not None:
        memory = _with_law(memory, namespace)
    document = {
        "path": str(namespace.memory),
        "law": memory.law,
        "sha256": memory.sha256,
        "usable": memory.newest is not None,
        "stored": [one.as_json() for one in memory.stored],
    }
    bad = [one for one in memory.stored if one.fault]
    if namespace.json:
        print_json(document)
    else:
        _print(Output(), memory, values=namespace.verb == "show")
    return FAIL if namespace.verb == "verify" and (bad or memory.newest is None) else PASS


def _read(path: Path) -> Memory:
    """The stored records, also if none of them can be used.

    :raises InputError: there is no record, or a named file is damaged.
    """
    if not path.is_dir():
        return read_memory(path)
    found = MemoryStore(path).read()
    if not found.stored:
        raise InputError(path, "", Words("has no record"), f"a folder with {', '.join(SLOT_FILES.values())}")
    return found


def _with_law(memory: Memory, namespace: argparse.Namespace) -> Memory:
    """The memory on a scenario, checked by its law.

    :raises InputError: no such scenario or law, or a named file that the law cannot begin with.
    """
    # Only this check needs the law itself.
    from railhil.controller_node.laws import find
    from railhil.controller_node.laws.memory import choice

    scenario = load_any(namespace.scenario, namespace.set)
    system = scenario.installed_system
    system.check_law(memory.law, namespace.memory, "law")
    found = choice(memory.law, find(memory.law, system.laws), scenario, memory)
    return replace(memory, stored=found.stored)


def _print(console: Output, memory: Memory, values: bool) -> None:
    console.say(f"memory of {memory.law or 'no law'}, {memory.source}")
    heads = ("place", number("runs"), number("last run"), "record", "key")
    console.print(table(*heads, rows=map(_cells, memory.stored)))
    for one in memory.stored:
        if one.fault:
            console.say(f"{one.slot} cannot be used ({one.fault}): {one.detail}")
        elif values and one.record is not None:
            console.say(f"{one.slot}: {_flat(one.record.values)}")
    newest = next((one for one in memory.stored if one.record is not None), None)
    console.say("a run would begin with nothing" if newest is None else f"a run would begin with {newest.slot}")


def _cells(one: MemoryPlace) -> tuple[str, ...]:
    record = one.record
    if record is None:
        return one.slot, "-", "-", "cannot be used", "-"
    return one.slot, str(record.runs), str(record.last_run), record.digest, record.key


def _flat(values: Any) -> str:
    return json.dumps(dict(values), sort_keys=True)


def _export(namespace: argparse.Namespace) -> int:
    """Write one record as a file that ``--memory-from`` and the ``default.json`` of a store take."""
    memory = _read(namespace.memory)
    record: MemoryRecord | None = memory.newest if namespace.slot is None else memory.find_record(namespace.slot)
    if record is None:
        found = Words(f"has no record in {namespace.slot}" if namespace.slot else "has no record that can be used")
        raise InputError(namespace.memory, "", found, "a place with one (railhil memory show)")
    out: Path = namespace.out
    check_free("--out", out)
    with refuse_unwritable("--out", out, "file"):
        write_synced(out, record.content)
    if namespace.json:
        print_json({"path": str(out), "sha256": record.sha256, "record": record.document})
    else:
        Output().say(f"record of {count_of(record.runs, 'run')}, sha256 {record.digest}, written to {out}")
    return PASS
