"""A hunt as a study: the rows of its cases, its summary, its runs made again, and the least cases at its end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import pyarrow as pa

from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import FAIL, INVALID, PASS, TOOL_ERROR
from railhil.hunt.cases import HuntCase
from railhil.hunt.draws import Draws, descend_rows, with_draws
from railhil.hunt.found import FOUND, read_found, shrink_violations
from railhil.hunt.oracle import BENCH, run_case
from railhil.hunt.plan import DESCENT, OWN_CODE, Chunk, Plan, Request, cut, make_plan
from railhil.hunt.show import lines
from railhil.hunt.tighten import read_tight, tighten
from railhil.judge.requirements.outcome import NOT_JUDGED
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.sentence import SILENT
from railhil.scenarios.given import KEY, is_law_name
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.scenario_documents import any_judged_sha256
from railhil.study.engines import Engine, Say
from railhil.study.execute import Outcome
from railhil.study.finished import Verified, differences
from railhil.study.plan import Study, bench_sha256, code_of
from railhil.study.table import NotThePart, row

_TEXTS = pa.list_(pa.string())
_OUTCOME = {
    "id": pa.string(),
    "verdict": pa.string(),
    "margin": pa.float64(),
    "unit": pa.string(),
    "instant_s": pa.float64(),
    "antecedent_met": pa.int64(),
    "slack": pa.float64(),
}
SCHEMA = pa.schema(
    [
        pa.field("number", pa.int64(), nullable=False),
        pa.field("strategy", pa.string(), nullable=False),
        pa.field("seed", pa.int64(), nullable=False),
        # The faults that acted, and those of the case that changed nothing.
        pa.field("faults", _TEXTS, nullable=False),
        pa.field("idle", _TEXTS, nullable=False),
        pa.field("draws", pa.list_(pa.float64()), nullable=False),
        pa.field("verdict", pa.string(), nullable=False),
        # Ids of the violated requirements, and a sentence for each.
        pa.field("violated", _TEXTS, nullable=False),
        pa.field("said", _TEXTS, nullable=False),
        # Of each requirement of the hunt, in their order.
        pa.field("outcomes", pa.list_(pa.struct(_OUTCOME)), nullable=False),
        pa.field("detail", pa.string(), nullable=False),
        pa.field("cells", _TEXTS, nullable=False),
        pa.field("frames_sha256", pa.string(), nullable=False),
    ]
)


def case_row(base: RunSpec, requirements: Sequence[Requirement], case: HuntCase) -> dict[str, Any]:
    """The row of a case, whose run is made.

    If some of its faults changed nothing and it violates something, it is run again without them: what is violated is
    that of a valid run with the faults of the row.
    """
    base = with_draws(base, case.draws)
    found = run_case(base, requirements, case.faults, case.seed)
    idle = [case.faults[place] for place in found.idle]
    acted = tuple(text for place, text in enumerate(case.faults) if place not in found.idle)
    if idle and found.violated:
        found = run_case(base, requirements, acted, case.seed)
    return {
        "number": case.number,
        "strategy": case.strategy,
        "seed": case.seed,
        "faults": list(acted),
        "idle": idle,
        "draws": list(case.draws),
        "verdict": found.verdict,
        "violated": list(found.violated),
        "said": list(found.violated.values()),
        "outcomes": [{name: getattr(outcome, name) for name in _OUTCOME} for outcome in found.outcomes],
        "detail": found.detail,
        "cells": list(found.cells),
        "frames_sha256": found.frames_sha256,
    }


@dataclass(frozen=True, slots=True)
class ChunkWork:
    """The cases of a part, which are data, and the run without faults."""

    base: RunSpec
    requirements: tuple[Requirement, ...]
    system: str
    cases: tuple[HuntCase, ...]

    def code(self) -> tuple[str, ...]:
        return code_of(self.base.law, self.system, OWN_CODE)

    def rows(self) -> pa.Table:
        rows = [case_row(self.base, self.requirements, case) for case in self.cases]
        return pa.Table.from_pylist(rows, schema=SCHEMA)


@dataclass(frozen=True, slots=True)
class DescentWork(ChunkWork):
    """A descent of the margin of the requirement ``aim``; its cases have no draws yet."""

    aim: str = ""
    seed: int = 0
    drawn: tuple[bool, ...] = ()

    def rows(self) -> pa.Table:
        cases = {case.number: case for case in self.cases}

        def make_row(number: int, draws: Draws) -> dict[str, Any]:
            return case_row(self.base, self.requirements, replace(cases[number], draws=draws))

        rows = [*descend_rows(make_row, [*cases], self.aim, self.seed, self.drawn)]
        return pa.Table.from_pylist(rows, schema=SCHEMA)


def _work(plan: Plan, chunk: Chunk) -> ChunkWork:
    if plan.request.strategy == DESCENT:
        # One noise for all runs: the margin is then a function of the draws.
        cases = tuple(HuntCase(number, DESCENT, 0, ()) for number in chunk.numbers)
        given = plan.base, plan.requirements, plan.scenario.system, cases
        return DescentWork(*given, plan.aim(chunk), plan.request.seed, plan.drawn)
    return ChunkWork(plan.base, plan.requirements, plan.scenario.system, plan.cases(chunk.numbers))


def _check_rows(table: pa.Table, plan: Plan, chunk: Chunk) -> None:
    if table["number"].to_pylist() != list(chunk.numbers):
        raise NotThePart("with other cases")


def summary(plan: Plan, table: pa.Table) -> dict[str, Any]:
    """``summary.json``: the requirements, the strategies and the cells, without what the least cases add."""
    rows = table.to_pylist()
    valid = [one for one in rows if one["verdict"] in ("PASS", "FAIL")]
    cells: dict[str, int] = {}
    for one in rows:
        for cell in one["cells"]:
            cells.setdefault(cell, one["number"])
    return {
        "scenario": plan.scenario.name,
        "scenario_sha256": any_judged_sha256(plan.scenario),
        "law": plan.base.law.label,
        **plan.base.law.how,
        "code_sha256": bench_sha256(),
        "seed": plan.request.seed,
        "runs": len(rows),
        "valid": len(valid),
        "with_idle_faults": sum(bool(one["idle"]) for one in valid),
        "verdicts": dict(sorted(Counter(one["verdict"] for one in rows).items())),
        "requirements": _requirements(plan, rows, len(valid)),
        "strategies": _strategies(rows),
        "cells": sorted(cells),
        "last_new_cell": max(cells.values(), default=None),
    }


def _requirements(plan: Plan, rows: Sequence[Mapping[str, Any]], valid: int) -> list[dict[str, Any]]:
    """The requirements of the hunt in their order, then the rules of every run that are violated."""
    found = {one.id: _requirement(one, rows) for one in plan.requirements}
    for one in rows:
        for name, said in zip(one["violated"], one["said"], strict=True):
            if not plan.is_searched(name):
                continue
            entry = found.setdefault(name, {"id": name, "says": said, "runs": valid})
            if entry.get("verdict") != "violated":
                entry |= {"verdict": "violated", "said": said, "first": one["number"], "violations": 0}
            entry["violations"] += 1
    return list(found.values())


def _requirement(requirement: Requirement, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What all runs made of a requirement. ``nearest``: smallest margin; ``slack``: least of all runs, in s."""
    outcomes = [one for case in rows for one in case["outcomes"] if one["id"] == requirement.id]
    judged = [one for one in outcomes if one["verdict"] != NOT_JUDGED]
    nearest = min((one for one in judged if one["margin"] is not None), key=lambda one: one["margin"], default=None)
    met = sum(one["verdict"] != SILENT for one in judged)
    return {
        "id": requirement.id,
        "says": requirement.says,
        "verdict": "not found" if met else SILENT,
        "runs": len(judged),
        "antecedent_met": met,
        "margin": None if nearest is None else nearest["margin"],
        "unit": None if nearest is None else nearest["unit"],
        "instant_s": None if nearest is None else nearest["instant_s"],
        "slack": min((one["slack"] for one in judged if one["slack"] is not None), default=None),
        "violations": 0,
    }


def _strategies(rows: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    for one in rows:
        entry = found.setdefault(one["strategy"], {"runs": 0, "valid": 0, "first_violation": None})
        entry["runs"] += 1
        entry["valid"] += one["verdict"] in ("PASS", "FAIL")
        if one["violated"] and entry["first_violation"] is None:
            entry["first_violation"] = entry["runs"]
    return dict(sorted(found.items()))


def _repeat(plan: Plan, rows: pa.Table, place: int) -> Iterator[Verified]:
    """One case run again."""
    ours = row(rows, place)
    number = ours["number"]
    if plan.request.strategy == DESCENT:
        # Its draws depend on the margins of the runs before.
        case = HuntCase(number, DESCENT, ours["seed"], (), tuple(ours["draws"]))
    else:
        (case,) = plan.cases([number])
    bench = case_row(plan.base, plan.requirements, case)
    yield Verified(f"case {case.number}", {"case": case.number}, differences(ours, bench))


def finish(plan: Plan, made: Outcome, engine: Engine, say: Say) -> Outcome:
    """Shrink what was found, and tighten what was kept if that is asked for."""
    made = shrink_violations(plan, made, engine, say)
    return tighten(plan, made, engine) if plan.request.tighten else made


def exit_code(plan: Plan, made: Outcome) -> int:
    """0: no violation found; 1: violated; 3: more than half of the runs say nothing; 4: a defect of the bench."""
    found = {one["id"] for one in made.summary["requirements"] if one["verdict"] == "violated"}
    if BENCH in found or any(not one["is_repeatable"] for one in made.summary["found"]):
        return TOOL_ERROR
    if found:
        return FAIL
    return INVALID if 2 * made.summary["valid"] < made.summary["runs"] else PASS


def _explained(plan: Plan) -> Mapping[str, Any]:
    given = plan.base.law.given
    return {} if given is None else {KEY: given.as_json()}


def _controllers(request: Request, identity: Mapping[str, Any]) -> Mapping[str, Mapping[str, Any]]:
    return {} if is_law_name(request.controller) else {request.controller: identity}


def _completed(made: Outcome) -> Outcome:
    found = read_found(made.folder)
    if found is None:
        allowed = "the least cases of a finished hunt (--resume finishes it)"
        raise InputError(made.folder, FOUND, Words("unfinished"), allowed)
    return replace(made, summary={**made.summary, "found": found, "tight": read_tight(made.folder)})


HUNT: Study[Plan, Chunk] = Study(
    name="hunt",
    kind="hunt",
    request=Request,
    make_plan=make_plan,
    columns=lambda plan: SCHEMA,
    check_rows=_check_rows,
    work=_work,
    summary=summary,
    explained=_explained,
    items=lambda plan: plan.request.runs,
    repeat=_repeat,
    page="railhil.hunt.report:page",
    lines=lines,
    finish=finish,
    completed=_completed,
    controllers=_controllers,
    exit_code=exit_code,
    cut=cut,
)
