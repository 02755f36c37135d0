"""The table of searches on the suite of planted defects, read from hunts and from the entries of other programs.

A defect counts as found if a run with it violates a requirement that the same run keeps without it. The latter is made
here, by the installed package.
"""

from __future__ import annotations

import json
import statistics
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field
from rich.table import Table as Shown

from railhil.common.errors import InputError, Words
from railhil.hunt.defects import JOURNEY_FILE, LAW, RUNS, SEEDS, defects, journey, requirements
from railhil.hunt.draws import with_draws
from railhil.hunt.found import CASES
from railhil.hunt.oracle import broken_rules, run_case
from railhil.hunt.study import HUNT
from railhil.judge.record import checked_record
from railhil.judge.requirements.outcome import judge_requirements
from railhil.record.hash_list import check_hash_list
from railhil.scenarios.layers import read_toml
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.scenario_documents import any_judged_sha256
from railhil.scenarios.schema import Table
from railhil.scenarios.validation import validate
from railhil.study.manifest import read_manifest

ENTRY = "entry.toml"


class EntryTable(Table):
    """``entry.toml`` of a program that is not railhil's."""

    tool: Annotated[str, Field(min_length=1, max_length=40)]
    seed: int
    runs: Annotated[int, Field(ge=1)]
    defect: str
    run: str = ""


@dataclass(frozen=True, slots=True)
class Entry:
    """What a search made of a defect with one seed: number of the run that found it, from 1; None: not within the
    budget."""

    folder: Path
    tool: str
    defect: str
    seed: int
    first: int | None


@cache
def _defect_of() -> dict[str, str]:
    """Hash of the code with a defect -> its id."""
    return {one.code_sha256: one.id for one in defects().values()}


def _check(file: Path, key: str, found: object, allowed: Iterable[object]) -> None:
    known = list(allowed)
    if found not in known:
        raise InputError(file, key, found, ", ".join(map(str, known)))


def _check_code(file: Path, code_sha256: object) -> str:
    """The defect with which a document was made."""
    if not isinstance(code_sha256, str) or code_sha256 not in _defect_of():
        known = ", ".join(f"{code} ({name})" for code, name in _defect_of().items())
        raise InputError(file, "code_sha256", code_sha256, f"that of this railhil with a defect planted: {known}")
    return _defect_of()[code_sha256]


def _shows(faults: Sequence[str], seed: int, violated: Iterable[str], draws: Sequence[float] = ()) -> bool:
    """Whether a run without the defect keeps one of the violated requirements."""
    base = with_draws(RunSpec(str(JOURNEY_FILE), law=LAW, bus="local"), draws)
    found = run_case(base, requirements(), faults, seed)
    return found.is_valid and any(name not in found.violated for name in violated)


def read_entry(folder: Path) -> Entry:
    """The folder of a hunt, or one with ``entry.toml``.

    :raises InputError: it is neither, is not of the suite, or has changed since it was written.
    """
    if (folder / HUNT.manifest).is_file():
        return _of_hunt(folder)
    if (folder / ENTRY).is_file():
        return _of_tool(folder)
    raise InputError(folder, "", Words(f"neither {HUNT.manifest} nor {ENTRY}"), "a hunt, or the entry of a program")


def _of_hunt(folder: Path) -> Entry:
    begun, file = read_manifest(folder, HUNT), folder / HUNT.manifest
    check_hash_list(folder, HUNT.manifest, None)
    same = {"scenario_sha256": any_judged_sha256(journey()), "law": LAW.controller, **LAW.how}
    for key, allowed in same.items():
        _check(file, key, begun.identity.get(key), [allowed])
    defect = _check_code(file, begun.identity.get("code_sha256"))
    _check(file, "seed", begun.request.seed, SEEDS)
    says = {one.id: one.says for one in requirements()}
    for one in begun.identity["requirements"]:
        _check(file, f"requirement {one['id']}", one["says"], [says.get(one["id"], "no such requirement")])
    if not (folder / CASES).is_file():
        raise InputError(folder, "", Words(f"has no {CASES}"), "a finished hunt (--resume finishes it)")
    first = next(_shown_by(folder / CASES), None)
    return Entry(folder, f"railhil hunt, {begun.request.strategy}", defect, begun.request.seed, first)


def _shown_by(cases: Path) -> Iterator[int]:
    """Numbers, from 1, of the runs of a hunt that show its defect."""
    for number, line in enumerate(cases.read_text("utf-8").splitlines()[:RUNS], 1):
        row: dict[str, Any] = json.loads(line)
        if row["violated"] and _shows(row["faults"], row["seed"], row["violated"], row["draws"]):
            yield number


def _of_tool(folder: Path) -> Entry:
    file = folder / ENTRY
    given = validate(EntryTable, read_toml(file), lambda keys: file)
    _check(file, "seed", given.seed, SEEDS)
    _check(file, "defect", given.defect, defects())
    first = None
    if given.run:
        record = checked_record(str(folder / given.run), None)
        document = record.certificate
        certificate = folder / given.run / "certificate.json"
        _check(certificate, "code_sha256", _check_code(certificate, document.get("code_sha256")), [given.defect])
        # The faults are part of a recorded scenario.
        own = any_judged_sha256(replace(record.scenario, faults=()))
        _check(certificate, "scenario", own, [any_judged_sha256(journey())])
        _check(certificate, "controller", document.get("controller"), [LAW.controller])
        _check(certificate, "arithmetic", document.get("arithmetic"), [LAW.arithmetic])
        violated = {one.id for one in judge_requirements(record, requirements()) if one.violated}
        violated |= broken_rules(record.score.failures).keys()
        if not _shows(record.scenario.faults, document["seed"], violated):
            raise InputError(file, "run", given.run, "a run that violates what it keeps without the defect")
        first = given.runs if given.runs <= RUNS else None
    return Entry(folder, given.tool, given.defect, given.seed, first)


def leaderboard(folders: Sequence[Path]) -> list[dict[str, Any]]:
    """A row for each tool: most found first, then fewest runs; what was not found or not handed in counts the budget.

    :raises InputError: as :func:`read_entry`; a tool has two entries of a defect and a seed.
    """
    tools: dict[str, dict[tuple[str, int], Entry]] = {}
    for entry in map(read_entry, folders):
        mine = tools.setdefault(entry.tool, {})
        if (entry.defect, entry.seed) in mine:
            other = mine[entry.defect, entry.seed].folder
            said = Words(f"{entry.tool}, {entry.defect}, seed {entry.seed}, as in {other}")
            raise InputError(entry.folder, "", said, "one entry of each tool, defect and seed")
        mine[entry.defect, entry.seed] = entry
    rows = [_row(tool, mine) for tool, mine in tools.items()]
    return sorted(rows, key=lambda row: (-row["found"], row["mean_runs"], row["tool"]))


def _row(tool: str, mine: dict[tuple[str, int], Entry]) -> dict[str, Any]:
    firsts = {name: [mine[name, seed].first if (name, seed) in mine else None for seed in SEEDS] for name in defects()}
    every = [first for found in firsts.values() for first in found]
    return {
        "tool": tool,
        "found": sum(first is not None for first in every),
        "of": len(every),
        "entries": len(mine),
        "mean_runs": statistics.mean(RUNS if first is None else first for first in every),
        "runs": firsts,
    }


def table_of(rows: Sequence[dict[str, Any]]) -> Shown:
    """The rows for people: for each defect the runs of each seed."""
    table = Shown("tool", "found", "mean runs", *defects())
    for row in rows:
        cells = [" ".join("-" if first is None else str(first) for first in row["runs"][name]) for name in defects()]
        table.add_row(row["tool"], f"{row['found']} of {row['of']}", f"{row['mean_runs']:.1f}", *cells)
    return table
