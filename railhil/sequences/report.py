"""``report.html`` of ``railhil learn``: a function of its rows and of two runs made again; nothing external."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pyarrow as pa

from railhil.common.digits import count_of
from railhil.controller_node.laws import find
from railhil.controller_node.laws.memory import memory_key
from railhil.judge.judging import system_pictures
from railhil.judge.record import Record
from railhil.report.study_page import Table, study_page
from railhil.scenarios.memory import SLOT_A, SLOT_B, Memory, MemoryPlace, MemoryRecord, no_memory
from railhil.sequences.one import through_nodes
from railhil.sequences.pictures import figures
from railhil.sequences.plan import Plan
from railhil.sequences.show import converged, run_rows
from railhil.sequences.table import memories
from railhil.study.execute import Outcome
from railhil.study.table import row as row_of


def page(plan: Plan, made: Outcome, recorded: str) -> str:
    """The report as one HTML document; ``recorded`` as in :func:`~railhil.report.study_page.study_page`."""
    summary, table = made.summary, made.table
    kind = "perturbed" if summary["perturbed"] else "nominal"
    runs = f"{count_of(summary['sequences'], 'sequence')} of {count_of(summary['runs'], f'{kind} run')}"
    lead = (
        f"{runs} of {summary['law']} in {summary['arithmetic']}: {plan.judging.asked(plan.scenario)}. Each sequence "
        "begins with nothing and keeps what it has learned."
    )
    measures = summary["measures"].values()
    said = [f"{text[0].upper()}{text[1:]}." for text in (converged(one, summary["sequences"]) for one in measures)]
    examples = _examples(plan, table)
    parts = [
        *map(_by_run, measures),
        *figures(plan, table),
        *(["Two runs of the first sequence:"] if examples else []),
        *examples,
        Table("facts", "Facts", (), _facts(plan, summary), "facts"),
    ]
    counts = [(verdict, count_of(count, "run")) for verdict, count in summary["verdicts"].items()]
    return study_page(f"Learning on {plan.scenario.title}", lead, parts, counts, said, recorded)


def _by_run(measure: Mapping[str, Any]) -> Table:
    """The table of a measure by the number of the run."""
    title = f"{measure['title'].capitalize()} by the number of the run ({measure['unit']})"
    return Table(f"by-run-{measure['title'].replace(' ', '-')}", title, *run_rows(measure))


def _facts(plan: Plan, summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    seeds = f"{summary['seed']} to {summary['last_seed']}"
    used = ", ".join(f"{slot or 'nothing'} {count}" for slot, count in summary["memory_used"].items())
    refused = ", ".join(f"{slot} {count}" for slot, count in summary["memory_refused"].items()) or "none"
    return [
        ("Scenario", f"{summary['scenario']}, sha256 {plan.scenario.sha256[:12]}"),
        ("Seeds", f"{seeds}: one per sequence"),
        ("Verdicts", ", ".join(f"{count} {name}" for name, count in summary["verdicts"].items())),
        ("Slots begun with", used),
        ("Slots that could not be used", refused),
        ("Runs that left no record", str(summary["not_learned"])),
        ("Runs in which the arithmetic wrapped", str(summary["runs_with_wraps"])),
    ]


def _examples(plan: Plan, table: pa.Table) -> list[Any]:
    """The system's own figures of the first and the last run of the first sequence."""
    kept = memories(table, plan.request.runs)[0]
    numbers = [1, plan.request.runs] if plan.request.runs > 1 else [1]
    runs = [_example(plan, table, number, kept[number - 2] if number > 1 else None) for number in numbers]
    return system_pictures(plan.scenario, runs)


def _example(plan: Plan, table: pa.Table, number: int, values: Mapping[str, Any] | None) -> Record:
    """One run of the first sequence, made again.

    :param values: left by the run before it.
    """
    law = plan.law.controller
    memory = no_memory(law, Path("memory"))
    if values is not None:
        key = memory_key(find(law, plan.scenario.installed_system.laws), plan.scenario)
        slot = row_of(table, number - 1)["memory_used"]
        record = MemoryRecord(law, key, number - 1, number - 1, values)
        memory = Memory(law, (MemoryPlace(slot if slot in (SLOT_A, SLOT_B) else SLOT_A, record),), Path("memory"))
    spec = plan.specs(plan.seeds[0])[number - 1]
    run = through_nodes(plan.scenario, replace(spec, law=replace(spec.law, memory=memory)))
    assert run.trace is not None
    label = f"run {number}"
    made = Record(Path(), plan.scenario, run.trace, certificate={"controller": label})
    return made.copy_with(score=run.score, events=())
