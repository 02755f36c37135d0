"""The tables of a page: scores, and events."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from railhil.judge.criteria import Criterion
from railhil.judge.events.event import FAULT, LEVEL, MILESTONE, START, RecordedEvent
from railhil.judge.events.summary import level_shown
from railhil.scenarios.model import AnyScenario, PublishedScore

if TYPE_CHECKING:
    from railhil.judge.record import Record


@dataclass(frozen=True, slots=True)
class Cell:
    """A measured value and the published one, as text (empty: none); ``best``: the best measured value of all runs that
    count as an evaluation; ``missed``: it is outside the scenario's limits."""

    measured: str
    published: str
    best: bool
    missed: bool = False


@dataclass(frozen=True, slots=True)
class Row:
    """One law: its cells in the order of the criteria; no verdict if there is only a published row."""

    label: str
    verdict: str
    cells: tuple[Cell, ...]


def published_text(row: PublishedScore, criterion: Criterion) -> str:
    """A published value with its digits; ``-`` if the row has none."""
    return criterion.shown(row.values.get(criterion.key), criterion.published_digits)


def _cell(run: Record, criterion: Criterion, best: str) -> Cell:
    text = criterion.shown(run.score.values[criterion.key])
    is_best = text == best and not run.seed_was_trained
    published = published_text(run.published, criterion) if run.published else ""
    missed = criterion.missed(run.scenario, run.score.with_sign(criterion))
    return Cell(text, published, is_best, bool(missed))


def rows(scenario: AnyScenario, criteria: Sequence[Criterion], runs: Sequence[Record]) -> list[Row]:
    """Rows of the runs in their order, then the published rows of laws that were not run."""
    best = []
    judged = [run.score for run in runs if not run.seed_was_trained]
    for criterion in criteria:
        values = [value for score in judged if (value := score.values[criterion.key]) is not None]
        best.append(criterion.shown(criterion.best(values)) if len(values) > 1 else "")
    pairs = list(zip(criteria, best, strict=True))
    found = [
        Row(run.label, run.verdict, tuple(_cell(run, criterion, text) for criterion, text in pairs)) for run in runs
    ]
    run_here = {run.controller for run in runs}
    for row in scenario.published:
        if row.controller not in run_here:
            cells = (Cell("", published_text(row, criterion), False) for criterion in criteria)
            found.append(Row(row.controller, "", tuple(cells)))
    return found


def better_sentence(criteria: Sequence[Criterion]) -> str:
    """The sentence on the columns in which less or more is better, and on columns shown without sign."""
    more = [criterion.title for criterion in criteria if criterion.better == "high"]
    bare = [criterion.title.removesuffix(" error") for criterion in criteria if criterion.signed]
    text = f"Less is better in every column{f' but {_listed(more)}' if more else ''}"
    return f"{text}; {_listed(bare)} error stand without sign." if bare else f"{text}."


def _listed(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


#: Kinds of events of every run.
_USUAL = (START, MILESTONE)


def has_unusual(events: Sequence[RecordedEvent]) -> bool:
    """Whether the run has events that not every run has."""
    return any(event.kind not in _USUAL for event in events)


@dataclass(frozen=True, slots=True)
class EventRow:
    """Events of a run that differ only in instant and place: the first and the last, their number, and their kind."""

    label: str
    first_s: float
    until_s: float
    count: int
    source: str
    what: str
    why: str
    is_fault: bool = False


def _places(places_m: Sequence[float]) -> str:
    """The place of the first event of a row, and of the last where it is another one; empty without any."""
    if not places_m:
        return ""
    first, last = (f"{place_m:.4f} m" for place_m in (places_m[0], places_m[-1]))
    return f"at {first}" if first == last else f"from {first} to {last}"


def event_rows(label: str, events: Sequence[RecordedEvent]) -> list[EventRow]:
    """The table of events: those that differ only in instant and place are one row, in the order of the first."""
    alike: dict[tuple[str, str, str, str, str], list[RecordedEvent]] = {}
    for event in events:
        alike.setdefault((event.source, event.kind, event.level, event.cause, event.detail), []).append(event)
    rows = []
    for (source, kind, level, cause, detail), own in alike.items():
        what = level_shown(level) if kind == LEVEL else kind.replace("_", " ")
        why = detail or cause.replace("_", " ")
        place = _places([event.position_m for event in own if event.position_m is not None])
        until_s = max(event.time_s + event.lasted_s for event in own)
        count = sum(event.count for event in own)
        said = f"{why} {place}".strip()
        rows.append(EventRow(label, own[0].time_s, until_s, count, source, what, said, kind == FAULT))
    return rows
