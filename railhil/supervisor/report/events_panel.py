"""The events of runs in the report: speed, ladder of the watches and markers over time; and the table of events."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes

from railhil.scenarios.model import AnyScenario
from railhil.supervisor.events.event import FAULT, LEVEL, MILESTONE, START, RecordedEvent
from railhil.supervisor.events.summary import level_shown
from railhil.supervisor.judging import judging_of
from railhil.supervisor.report.panels import Drawn

#: Kinds of events of every run.
_USUAL = (START, MILESTONE)
#: Lines of the watches, in their order.
_TRACKS = ({"linestyle": "-", "linewidth": 1.4}, {"linestyle": (0, (4, 2)), "linewidth": 1.4, "color": "black"})
_TICK = 0.25
#: An injected fault stands out from what followed from it.
_MARKER: dict[str, Any] = {"linewidth": 1.5, "color": "C0"}
_FAULT_MARKER: dict[str, Any] = {"linewidth": 4.0, "color": "firebrick"}


def has_unusual(events: Sequence[RecordedEvent]) -> bool:
    """Whether anything happened that does not happen in every run."""
    return any(event.kind not in _USUAL for event in events)


def speed_over_time(axes: Axes, run: Drawn) -> None:
    """True speed of a run, and the set-point that it followed."""
    curves = run.curves
    axes.plot(curves.time_s, curves.speed_kmh + curves.error_kmh, color="0.75", linewidth=3.5, label="target")
    axes.plot(curves.time_s, curves.speed_kmh, label=run.label, **run.style.line)
    axes.set(ylabel="speed (km/h)", ylim=(0, None))


def ladder(axes: Axes, scenario: AnyScenario, run: Drawn, end_s: float) -> None:
    """Level of each watch over time.

    :param end_s: end of the record.
    """
    own = [event for event in run.events if event.kind == LEVEL]
    names = {event.rank: event.level.replace("_", " ") for event in own}
    for watch, line in zip(judging_of(scenario).watches, _TRACKS, strict=False):
        times_s, ranks = [0.0], [0]
        for event in own:
            if event.source != watch.name:
                continue
            if event.time_s == times_s[-1] and ranks[-1] == 0:
                # From the level before, without a return to normal between the two.
                times_s.pop()
                ranks.pop()
            times_s += [event.time_s, event.time_s if event.until_s is None else event.until_s]
            ranks += [event.rank, 0]
        look = {**run.style.alone, **line}
        axes.step([*times_s, end_s], [*ranks, ranks[-1]], where="post", label=watch.name, **look)
    axes.set_yticks([0, *sorted(names)], ["normal", *(names[rank] for rank in sorted(names))], fontsize=8)
    axes.set_ylim(-_TICK, max(names, default=1) + _TICK)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False, borderaxespad=0.2)


def kinds(events: Sequence[RecordedEvent]) -> list[str]:
    """The kinds of events that have a row of markers."""
    return list(dict.fromkeys(event.kind for event in events if event.kind not in (LEVEL, START)))


def markers(axes: Axes, run: Drawn) -> None:
    """One row for each kind of event: a mark at its instant, a line until its end."""
    shown = kinds(run.events)
    for row, kind in enumerate(shown):
        own = [event for event in run.events if event.kind == kind]
        look = _FAULT_MARKER if kind == FAULT else _MARKER
        begun_s, rows = [event.time_s for event in own], [row for _ in own]
        axes.hlines(rows, begun_s, [event.time_s + event.lasted_s for event in own], **look)
        axes.plot(begun_s, rows, "|", color="black", markersize=9)
    axes.set_yticks(range(len(shown)), [kind.replace("_", " ") for kind in shown], fontsize=8)
    axes.set_ylim(len(shown) - 1 + 0.5, -0.5)


@dataclass(frozen=True, slots=True)
class EventRow:
    """Events of a run that differ only in their instants: the first and the last, their number, and what they are."""

    label: str
    first_s: float
    until_s: float
    count: int
    source: str
    what: str
    why: str
    is_fault: bool = False


def event_rows(label: str, events: Sequence[RecordedEvent]) -> list[EventRow]:
    """The table of events: those that differ only in their instants are one row, at the place of the first."""
    alike: dict[tuple[str, str, str, str, str], list[RecordedEvent]] = {}
    for event in events:
        alike.setdefault((event.source, event.kind, event.level, event.cause, event.detail), []).append(event)
    rows = []
    for (source, kind, level, cause, detail), own in alike.items():
        what = level_shown(level) if kind == LEVEL else kind.replace("_", " ")
        why = detail or cause.replace("_", " ")
        place = next((f"at {event.position_m:.4f} m" for event in own if event.position_m is not None), "")
        until_s = max(event.time_s + event.lasted_s for event in own)
        count = sum(event.count for event in own)
        said = f"{why} {place}".strip()
        rows.append(EventRow(label, own[0].time_s, until_s, count, source, what, said, kind == FAULT))
    return rows
