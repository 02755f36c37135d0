"""``--tighten``: the tightest bound of each kept requirement that held in all runs, and the case that comes to it.

The bound comes from the rows of the hunt. The case with the least slack, or the nearest margin, is made again: it has
to keep the requirement with the new bound, and to violate the next tighter one.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.hunt.draws import with_draws
from railhil.hunt.oracle import run_case
from railhil.judge.requirements.names import Names
from railhil.judge.requirements.requirement import Requirement, as_toml
from railhil.judge.requirements.sentence import KEPT, OPEN
from railhil.judge.requirements.tighter import Tighter, tighter
from railhil.record.hash_list import listed_file
from railhil.record.trace import Trace
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    from railhil.hunt.plan import Plan
    from railhil.study.engines import Engine
    from railhil.study.execute import Outcome

#: File with the sentences of the tighter bounds, for ``--requirements``.
TIGHT = "tight.toml"
#: File with what was found, for the page.
TIGHT_LIST = "tight.json"
_BEYOND_ID = "BEYOND"
#: Verdicts of runs in which a requirement held, as far as they were recorded.
_HELD = (KEPT, OPEN)


@dataclass(frozen=True, slots=True)
class _Confirmation:
    """A case to be made again with a tighter requirement. ``runs``: in which the requirement held; ``open_runs``: of
    these, whose end left it open."""

    base: RunSpec
    tighter: Tighter
    number: int
    faults: tuple[str, ...]
    seed: int
    runs: int
    open_runs: int


def _confirm(one: _Confirmation) -> dict[str, Any]:
    beyond = one.tighter.beyond
    wanted = [one.tighter.requirement, *([] if beyond is None else [replace(beyond, id=_BEYOND_ID)])]
    found = run_case(one.base, wanted, one.faults, one.seed)
    verdicts = {outcome.id: outcome for outcome in found.outcomes}
    tight = verdicts.get(one.tighter.requirement.id)
    is_kept = tight is not None and tight.verdict in _HELD
    return {
        "id": one.tighter.requirement.id,
        "says": one.tighter.requirement.says,
        "was": one.tighter.was,
        "bound": one.tighter.bound,
        "runs": one.runs,
        "open_runs": one.open_runs,
        "case": one.number,
        "is_confirmed": is_kept and (beyond is None or _BEYOND_ID in found.violated),
        "is_least": beyond is None,
    }


def tighten(plan: Plan, made: Outcome, engine: Engine) -> Outcome:
    """Find the tightest bounds, and write them as a file of requirements.

    :returns: the outcome with them in its summary, as ``tight``.
    """
    assert made.table is not None
    asked = list(_confirmations(plan, made.summary, made.table.to_pylist()))
    with engine(_confirm, asked) as results:
        by_place = dict(results)
    found = [by_place[place] for place in range(len(asked))]
    held = {one["id"] for one in found if one["is_confirmed"]}
    with listed_file(made.folder / TIGHT) as draft:
        text = _file([one.tighter.requirement for one in asked if one.tighter.requirement.id in held])
        draft.write_text(text, encoding="utf-8")
    with listed_file(made.folder / TIGHT_LIST) as draft:
        draft.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    return replace(made, summary={**made.summary, "tight": found})


def read_tight(folder: Path) -> list[dict[str, Any]]:
    """The tightest bounds that the folder of a hunt has; none, if they were not asked for."""
    path = folder / TIGHT_LIST
    found: list[dict[str, Any]] = json.loads(path.read_bytes()) if path.is_file() else []
    return found


def _confirmations(
    plan: Plan, summary: Mapping[str, Any], rows: Sequence[Mapping[str, Any]]
) -> Iterator[_Confirmation]:
    names = Names(plan.scenario, Trace(plan.scenario.installed_system.contract))
    results = {one["id"]: one for one in summary["requirements"]}
    for requirement in plan.requirements:
        if results[requirement.id]["verdict"] != "not found":
            continue
        cases = [
            (row, outcome)
            for row in rows
            for outcome in row["outcomes"]
            if outcome["id"] == requirement.id and outcome["verdict"] in _HELD
        ]
        for key in ("slack", "margin"):
            known = [pair for pair in cases if pair[1][key] is not None]
            if not known:
                continue
            row, outcome = min(known, key=lambda pair: pair[1][key])
            given = {"slack_s": None, "margin": None, "slack_s" if key == "slack" else key: outcome[key]}
            if (found := tighter(requirement, names, **given)) is not None:
                still_open = sum(outcome["verdict"] == OPEN for _, outcome in cases)
                faults = tuple(row["faults"])
                yield _Confirmation(
                    with_draws(plan.base, row["draws"]),
                    found,
                    row["number"],
                    faults,
                    row["seed"],
                    len(cases),
                    still_open,
                )
                break


def _file(requirements: Sequence[Requirement]) -> str:
    """A file of requirements; of two files that give a name two meanings it has those of the first."""
    define: dict[str, str] = {}
    first, others = list[Requirement](), list[str]()
    for one in requirements:
        if any(define.get(name, text) != text for name, text in one.define):
            others.append(f"# {one.id}: a name of its [define] has another meaning above: {one.says}\n")
            continue
        define |= dict(one.define)
        first.append(replace(one, note="", source="held in all runs of a hunt"))
    return as_toml(first) + "".join(others)
