"""``report.html`` of a hunt: what was found, and each least case with its figures; a function of the folder."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from railhil.batch.decision import decision_figure
from railhil.charts.figure import Figure
from railhil.hunt.draws import draws_sentence
from railhil.hunt.found import FOUND, PASSING, WITHOUT
from railhil.hunt.pictures import Side, figures, side
from railhil.hunt.plan import Plan
from railhil.hunt.show import found_sentence, headline, nearest, saved_sentence, tight_sentence, verdict_line
from railhil.judge.record import checked_record
from railhil.judge.requirements.drawn import DrawnSentence
from railhil.judge.requirements.names import Names
from railhil.judge.requirements.outcome import Outcome, Part, judge_one
from railhil.judge.requirements.requirement import Requirement
from railhil.record.documents import CERTIFICATE
from railhil.record.trace import Trace
from railhil.report.templates import render_page
from railhil.study.execute import Outcome as Made

#: Cases with figures; further ones have their table row and command alone.
_DRAWN_MAX = 12
#: Endings of the run folders of a case, and the labels of these runs.
_SIDES = (("", "case"), (PASSING, "nearest that passes"), (WITHOUT, "without the faults"))


def page(plan: Plan, made: Made, recorded: str) -> str:
    """The report as one HTML document without external references.

    :param made: with the least cases as ``found`` in its summary.
    :param recorded: as in :func:`~railhil.report.study_page.study_page`.
    """
    summary = made.summary
    return render_page(
        "hunt.html.j2",
        "railhil.hunt",
        summary=summary,
        title=f"Hunt on {plan.scenario.title}",
        recorded=recorded,
        law=f"{plan.base.law.label} {plan.base.law.arithmetic}",
        headline=headline(summary),
        verdict=verdict_line(summary),
        requirements=[{**one, "nearest": nearest(one)} for one in summary["requirements"]],
        strategies=[
            (
                name,
                str(one["runs"]),
                str(one["valid"]),
                str(first) if (first := one["first_violation"]) is not None else "none",
            )
            for name, one in summary["strategies"].items()
        ],
        tight=[(one["id"], tight_sentence(one)) for one in summary.get("tight", ())],
        cases=[_case(plan, one, made.folder, place < _DRAWN_MAX) for place, one in enumerate(summary["found"])],
    )


def _case(plan: Plan, one: Mapping[str, Any], folder: Path, is_drawn: bool) -> dict[str, Any]:
    requirement = next((found for found in plan.requirements if found.id == one["id"]), None)
    sides = _sides(folder, one["name"]) if is_drawn else []
    drawn, outcome = _judged(requirement, sides)
    parts = [(one["says"], "")] if requirement is None else [(requirement.says, "")]
    if drawn is not None and outcome is not None and outcome.instant_s is not None:
        grid = sides[0].grid
        parts = drawn.parts(grid, min(grid.tick_at(outcome.instant_s), grid.count - 1))
    file = shlex.quote(f"{FOUND}/{one['name']}.toml")
    pictures: list[Figure] = figures(one["name"], sides, drawn, outcome) if sides else []
    return {
        **one,
        "found": found_sentence(one),
        "drawn": draws_sentence(one["draws"]),
        "holds": [] if outcome is None else [(part.text, _holds(part)) for part in outcome.parts],
        "title": requirement.title if requirement else "",
        "source": requirement.source if requirement else "",
        "parts": parts,
        "outcome": outcome,
        "saved": saved_sentence(one),
        "pictures": pictures,
        "decision": decision_figure(one["decided"], f"{one['name']}-decision"),
        "command": f"railhil run {file}{one['options']}",
    }


def _holds(part: Part) -> str:
    """Whether a comparison holds, in words."""
    if part.margin is None:
        return "not known"
    if part.margin == 0:
        return "at its limit"
    return f"{'holds' if part.margin > 0 else 'does not hold'}, by {abs(part.margin):.4g} {part.unit}".rstrip()


def _sides(folder: Path, name: str) -> list[Side]:
    """The runs of a case that were recorded and can be drawn, the case first; empty: that one was not."""
    found = []
    for number, (ending, label) in enumerate(_SIDES):
        place = folder / FOUND / (name + ending)
        record = checked_record(str(place), None) if (place / CERTIFICATE).is_file() else None
        if record is not None and record.can_be_drawn:
            found.append(side(label, record, number))
        elif number == 0:
            return []
    return found


def _judged(requirement: Requirement | None, sides: Sequence[Side]) -> tuple[DrawnSentence | None, Outcome | None]:
    """The sentence on the record of the case."""
    if requirement is None or not sides:
        return None, None
    record = sides[0].record
    names = Names(record.scenario, Trace(record.trace.contract), record.certificate.get("notes"))
    return DrawnSentence(requirement, names), judge_one(requirement, requirement.bind(names), sides[0].grid)
