"""What a run makes of each of its requirements."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from railhil.bus.codes import FaultOrder
from railhil.bus.telegrams import SupCmd
from railhil.judge.requirements.bound import Bound
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.names import Names
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.robustness import LEAST
from railhil.judge.requirements.sentence import KEPT, SILENT, VIOLATED, BoundSentence
from railhil.judge.score import Score
from railhil.record.trace import Trace

if TYPE_CHECKING:
    from railhil.judge.record import Record

NOT_JUDGED = "not judged"
#: Unit of a margin over conditions of several dimensions, each divided by its scale.
SCALED = "scaled"
#: Margins below this have no size: :data:`LEAST` in another unit, or divided by a scale.
SIZE_MIN = LEAST * 2.0**100


@dataclass(frozen=True, slots=True)
class Part:
    """A comparison of the sentence at the instant of the margin: its text, its own margin and the unit of that."""

    text: str
    margin: float | None
    unit: str

    def as_json(self) -> dict[str, Any]:
        """As in ``score.json``."""
        return {"text": self.text, "margin": self.margin, "unit": self.unit}


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a record makes of a requirement.

    ``verdict``: kept, violated, open (the end of the record comes before the decision), says nothing (its antecedent
    was never met), not judged (a run with faults of a requirement for runs without, or an INVALID run). ``margin``: of
    the worst case, in ``unit``; below 0 if violated; None: no case has one. ``instant_s``: the instant that makes it,
    ``trigger_s``: at which that case began. ``antecedent_met``: number of times. ``slack``: what the slowest case left
    of the longest allowed time ``allowed_s``, in s. ``parts``: the comparisons of its condition at ``instant_s``; of
    the antecedent, where it was nearest, if that was never met. ``open_s``: begin of the first open case.
    """

    id: str
    says: str
    verdict: str
    margin: float | None = None
    unit: str = ""
    instant_s: float | None = None
    antecedent_met: int = 0
    slack: float | None = None
    parts: tuple[Part, ...] = ()
    trigger_s: float | None = None
    allowed_s: float | None = None
    open_s: float | None = None
    title: str = ""

    @property
    def kept(self) -> bool:
        """Whether the run has kept it, and the record shows so."""
        return self.verdict == KEPT

    @property
    def violated(self) -> bool:
        """Whether the run has violated it."""
        return self.verdict == VIOLATED

    @property
    def line(self) -> str:
        """What was found, in a line; for a violated one the reason of a FAIL."""
        said = f"requirement {self.id}: {self.says}: {self.verdict}"
        if self.margin is not None and self.instant_s is not None:
            said += f", {self._margin_text} at {self.instant_s:.2f} s"
        return said

    @property
    def short_line(self) -> str:
        """As :attr:`line`, without its sentence: where that stands elsewhere."""
        said = f"{self.id} {self.verdict}"
        if self.instant_s is not None:
            said += f" at {self.instant_s:.2f} s"
        return said if self.margin is None else f"{said}, {self._margin_text}"

    @property
    def _margin_text(self) -> str:
        return f"margin {self.margin:.4g} {self.unit}".rstrip()

    def as_json(self) -> dict[str, Any]:
        """As in ``score.json``."""
        return {
            "id": self.id,
            "says": self.says,
            "title": self.title,
            "verdict": self.verdict,
            "margin": self.margin,
            "unit": self.unit,
            "instant_s": self.instant_s,
            "trigger_s": self.trigger_s,
            "antecedent_met": self.antecedent_met,
            "slack": self.slack,
            "allowed_s": self.allowed_s,
            "open_s": self.open_s,
            "parts": [part.as_json() for part in self.parts],
        }


def judge_requirements(record: Record, requirements: Iterable[Requirement]) -> tuple[Outcome, ...]:
    """What a record makes of each requirement, in their order.

    It is a function of the record, its scenario and the faults of its certificate: every transport gives the same
    margins.

    :raises InputError: a sentence does not fit the scenario.
    """
    found = tuple(requirements)
    if not found:
        return ()
    if record.verdict == "INVALID":
        return tuple(_not_judged(one) for one in found)
    return judge_frames(record, found)


def judge_frames(record: Record, requirements: Sequence[Requirement]) -> tuple[Outcome, ...]:
    """As :func:`judge_requirements`, whether or not the record is that of a whole run.

    :raises InputError: a sentence does not fit the scenario.
    """
    names = Names(record.scenario, Trace(record.trace.contract), record.certificate.get("notes"))
    grid = Grid(record)
    has_faults = _has_faults(record)
    return tuple(
        _not_judged(one) if has_faults and one.when == "none" else judge_one(one, one.bind(names), grid)
        for one in requirements
    )  # fmt: skip


def _has_faults(record: Record) -> bool:
    """Whether the run has faults; one that is injected by hand counts if an order has injected one."""
    texts = [*record.scenario.faults, *(one["fault"] for one in record.certificate.get("injected") or ())]
    if not texts:
        return False
    # A run without faults does not load their language.
    from railhil.faults.language import parse

    by_hand = all(parse(text).trigger.kind == "manual" for text in texts)
    return not by_hand or bool((record.trace.raw(SupCmd.PORT, "FaultOrder") == FaultOrder.INJECT).any())


def with_requirements(record: Record, requirements: Sequence[Requirement]) -> Score:
    """The score of a record with the outcomes of further requirements; a violated one is among the failures.

    :raises InputError: a sentence does not fit the scenario.
    """
    found = record.score
    outcomes = judge_requirements(record, requirements)
    violated = tuple(one.line for one in outcomes if one.violated)
    return replace(
        found,
        verdict="FAIL" if violated and found.verdict == "PASS" else found.verdict,
        failures=(*found.failures, *violated),
        requirements=(*found.requirements, *outcomes),
    )


def _not_judged(requirement: Requirement) -> Outcome:
    return Outcome(requirement.id, requirement.says, NOT_JUDGED, title=requirement.title)


def judge_one(requirement: Requirement, sentence: BoundSentence, grid: Grid) -> Outcome:
    """What the record of a grid makes of one requirement."""
    found = sentence.on(grid)
    condition, tick = sentence.condition, found.tick
    if found.verdict == SILENT and sentence.given is not None:
        condition, tick = sentence.given, _nearest(sentence.given, grid)
    tick_s = grid.tick_ns / 1e9

    def instant_s(tick: int) -> float | None:
        return None if tick < 0 else tick * grid.tick_ns / 1e9

    unit = sentence.condition.unit
    return Outcome(
        id=requirement.id,
        says=requirement.says,
        verdict=found.verdict,
        margin=_number(found.margin),
        unit=SCALED if unit is None else unit.name,
        instant_s=instant_s(found.tick),
        antecedent_met=found.met,
        slack=None if found.spare is None else found.spare * grid.tick_ns / 1e9,
        parts=_parts(condition, grid, tick),
        trigger_s=instant_s(found.trigger),
        allowed_s=None if found.allowed is None else found.allowed * tick_s,
        open_s=instant_s(found.opened),
        title=requirement.title,
    )


def _number(margin: float) -> float | None:
    """A margin as a number; that of a comparison at its limit is 0."""
    if not math.isfinite(margin):
        return None
    return 0.0 if abs(margin) < SIZE_MIN else margin


def _nearest(condition: Bound, grid: Grid) -> int:
    """The tick at which a condition that never holds is nearest to it; -1: nothing is known of it."""
    margins = condition.on(grid)
    return -1 if np.isnan(margins).all() else int(np.nanargmax(margins))


def _parts(condition: Bound, grid: Grid, tick: int) -> tuple[Part, ...]:
    if tick < 0:
        return ()
    return tuple(Part(leaf.text, _number(float(leaf.on(grid)[tick])), leaf.unit.name) for leaf in condition.leaves)
