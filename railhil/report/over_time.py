"""The figures of a page that every system has: reactions and events, and all further signals over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from railhil.charts.figure import FREE, TIME, Area, Bounds, Chart, Curve, Figure, FloatArray, Look
from railhil.judge.events.event import FAULT, LEVEL, START, RecordedEvent
from railhil.judge.record import Record
from railhil.judge.signals import drawn_table
from railhil.record.trace import Trace
from railhil.report.display_columns import (
    ERROR,
    NOTE,
    SIGNAL,
    STATE,
    ColumnGroup,
    Shown,
    ShownColumn,
    grouped,
    shown_columns,
    with_error,
)
from railhil.report.display_columns import LEVEL as LEVEL_KIND
from railhil.report.styles import Style
from railhil.report.tables import event_rows, has_unusual

#: Height of a chart, of one with the speed, and of each name of a value, px.
_HEIGHT_PX, _SPEED_PX, _NAME_PX = 110, 190, 18
#: Charts of the signals that are open at first.
_OPEN = 5


@dataclass(frozen=True, slots=True)
class RunColumns:
    """The displayed columns of a run, NaN where there is no line.

    ``number``: of the run on the page. ``values``: by name, in the units of the columns, without the columns that the
    run does not have.
    """

    label: str
    number: int
    style: Style
    shown: Shown
    time_s: FloatArray
    values: dict[str, FloatArray]
    events: Sequence[RecordedEvent]

    def curve(self, column: ShownColumn, label: str, look: Look | None = None) -> Curve:
        """A column over time."""
        is_step = column.kind in (STATE, LEVEL_KIND, NOTE) or column.name == self.shown.command
        values = self.values[column.name]
        return Curve(label, self.time_s, values, look, column.unit, is_step, run=self.number, column=column.name)


def columns_of(run: Record, number: int, style: Style) -> RunColumns:
    """The columns that a record has.

    :param number: of the run on the page.
    """
    notes = run.certificate.get("notes")
    return _columns(run.label, number, style, run.scenario, run.trace, notes, run.events)


def signal_charts(scenario: Any, trace: Trace) -> list[Chart]:
    """All signals of a record over time, for a separate picture."""
    run = _columns("train", -1, Style(), scenario, trace, None, ())
    columns = [column for column in run.shown.columns if column.name in run.values]
    made = [_chart(group, [run], set()) for group in grouped(columns, run.shown.command)]
    return [replace(chart, x_label=TIME if place == len(made) - 1 else "") for place, chart in enumerate(made)]


def _columns(
    label: str, number: int, style: Style, scenario: Any, trace: Trace, notes: Any, events: Sequence[RecordedEvent]
) -> RunColumns:
    shown = with_error(shown_columns(scenario, trace.contract, notes))
    header, table = drawn_table(scenario, trace, notes)
    found: dict[str, FloatArray] = {}
    for column in shown.columns:
        if column.name == ERROR:
            values = table[:, header.index(shown.target)] - table[:, header.index(shown.speed)]
        else:
            values = table[:, header.index(column.name)]
        if np.isfinite(values).any() and (column.kind != NOTE or np.nan_to_num(values).any()):
            found[column.name] = values * column.factor
    return RunColumns(label, number, style, shown, table[:, 0], found, events)


def reactions(runs: Sequence[RunColumns]) -> list[Figure]:
    """A figure for each run in which something unusual happened: its speed, the levels of its watches, its events."""
    shown = [run for run in runs if has_unusual(run.events)]
    return [_reactions(run, place if len(runs) > 1 else 0) for place, run in enumerate(shown, 1)]


def _reactions(run: RunColumns, place: int) -> Figure:
    """
    :param place: among the figures of several runs; 0: there is only one.
    """
    title = "Reactions and events over time" + (f": {run.label}" if place else "")
    caption = (
        "Speed with the levels of the watches below it, and the instants of all other events; a bar lasts as long as "
        "its event."
    )
    end_s = float(run.time_s[-1])
    charts = []
    pair = [column for name in (run.shown.target, run.shown.speed) if (column := _known(run, name)) is not None]
    if pair:
        curves = [
            run.curve(one, one.label, Look("target", 2.5)) if one.name == run.shown.target
            else run.curve(one, run.label, run.style.look)
            for one in pair
        ]  # fmt: skip
        charts.append(Chart(curves, y_label=f"speed ({pair[0].unit})", y_bounds=(0.0, None), height_px=_SPEED_PX,
                            x_bounds=(0.0, end_s), sync=TIME, areas=list(_faults(run))))  # fmt: skip
    levels = [one for one in run.shown.columns if one.kind == LEVEL_KIND and one.name in run.values]
    if levels:
        charts.append(levels_chart([(run, one) for one in levels], (0.0, end_s), is_named=False))
    rows = _event_rows(run)
    names = {float(-place): kind.replace("_", " ") for place, kind in enumerate(rows)}
    marks = [mark for place, marks in enumerate(rows.values()) for mark in _bars(run, marks, -place)]
    charts.append(
        Chart(
            x_label=TIME,
            x_bounds=(0.0, end_s),
            y_bounds=(0.5 - len(rows), 0.5),
            areas=marks,
            y_names=names,
            sync=TIME,
            height_px=_NAME_PX * max(1, len(rows)),
        )
    )
    name = f"reactions-{place}" if place else "reactions"
    return Figure(name, title, caption, charts)


def _known(run: RunColumns, name: str) -> ShownColumn | None:
    return run.shown.named(name) if name in run.values else None


def _event_rows(run: RunColumns) -> dict[str, list[RecordedEvent]]:
    """The events other than levels, by kind."""
    found: dict[str, list[RecordedEvent]] = {}
    for event in run.events:
        if event.kind not in (LEVEL, START):
            found.setdefault(event.kind, []).append(event)
    return found


def _bars(run: RunColumns, events: Sequence[RecordedEvent], row: int) -> Iterator[Area]:
    for event in events:
        kind = "fault" if event.kind == FAULT else "event"
        until_s = event.time_s + event.lasted_s
        said = event.detail or event.cause.replace("_", " ") or event.kind.replace("_", " ")
        text = f"{event.time_s:.2f} s {said} ({event.source})"
        yield Area((event.time_s, until_s), (row - 0.32, row + 0.32), kind, text, run.number)


def _faults(run: RunColumns) -> Iterator[Area]:
    """Injected faults, as long as they were active."""
    for row in event_rows("", [event for event in run.events if event.kind == FAULT]):
        yield Area(
            (row.first_s, row.until_s), None, "fault", f"{row.first_s:.2f} s {row.why} ({row.source})", run.number
        )


def signals(runs: Sequence[RunColumns], drawn: Sequence[Figure]) -> tuple[list[Figure], list[Figure]]:
    """The columns over time that no figure of the page has yet: the charts that are open at first, and the others.

    :param drawn: the other figures of the page.
    """
    known = {
        (curve.run, curve.column)
        for figure in drawn
        for chart in figure.charts
        if chart.sync == TIME
        for curve in chart.curves
    }
    columns: dict[str, ShownColumn] = {}
    for run in runs:
        columns |= {one.name: one for one in run.shown.columns if one.name in run.values and one.name not in columns}
    left = [
        column
        for column in columns.values()
        if any((run.number, column.name) not in known and column.name in run.values for run in runs)
    ]
    groups = grouped(left, runs[0].shown.command) if runs else []
    figures = [(_signals(group, runs, known), _is_open(group, runs)) for group in groups]
    opened = [figure for figure, is_open in figures if is_open][:_OPEN]
    return opened, [figure for figure, _ in figures if figure not in opened]


def _is_open(group: ColumnGroup, runs: Sequence[RunColumns]) -> bool:
    """Whether a chart is open at first; the position is the axis of other charts."""
    places = {run.shown.position for run in runs}
    is_place = any(column.name in places for column in group.columns) or group.title == "position"
    return group.columns[0].kind in (SIGNAL, LEVEL_KIND) and not is_place and _moves(group, runs)


def _moves(group: ColumnGroup, runs: Sequence[RunColumns]) -> bool:
    """Whether any of its columns ever changes."""
    return any(
        np.nanmax(run.values[column.name]) > np.nanmin(run.values[column.name])
        for run in runs
        for column in group.columns
        if column.name in run.values
    )


def _signals(group: ColumnGroup, runs: Sequence[RunColumns], known: set[tuple[int, str]]) -> Figure:
    """One chart of some columns of all runs."""
    unit = f" ({group.unit})" if group.unit else ""
    title = f"{group.title[:1].upper()}{group.title[1:]}{unit} over time"
    return Figure(f"signal-{group.columns[0].name}", title, "", [_chart(group, runs, known)])


def _chart(group: ColumnGroup, runs: Sequence[RunColumns], known: set[tuple[int, str]]) -> Chart:
    shown = [
        (run, column)
        for column in group.columns
        for run in runs
        if column.name in run.values and (run.number, column.name) not in known
    ]
    bounds = (0.0, max(float(run.time_s[-1]) for run in runs))
    if group.columns[0].kind == LEVEL_KIND:
        return levels_chart(shown, bounds, len(runs) > 1, TIME)
    return _curves(group, shown, bounds, len(runs) > 1)


def _curves(
    group: ColumnGroup, shown: Sequence[tuple[RunColumns, ShownColumn]], bounds: tuple[float, float], is_named: bool
) -> Chart:
    curves: list[Curve] = []
    targets: list[Curve] = []
    numbers = {column.name: place for place, column in enumerate(group.columns)}
    for run, column in shown:
        if column.name == run.shown.target:
            # A target that several runs followed is one line.
            target = run.curve(column, column.label, Look("target", 2.5))
            if not any(_is_part(target, one) for one in targets):
                targets = [*(one for one in targets if not _is_part(one, target)), target]
            continue
        label = f"{run.label}: {column.label}" if is_named and len(group.columns) > 1 else column.label
        label = run.label if is_named and len(group.columns) == 1 else label
        look = run.style.dashed(numbers[column.name]) if is_named else Look(str(numbers[column.name] % 7))
        curves.append(run.curve(column, label, look))
    names = _names(group.columns[0], curves)
    y_bounds: Bounds = (min(names) - 0.5, max(names) + 0.5) if names else FREE
    height_px = _SPEED_PX if group.title == "speed" else max(_HEIGHT_PX, _NAME_PX * len(names))
    return Chart([*targets, *curves], TIME, group.unit, bounds, y_bounds, y_names=names, sync=TIME, height_px=height_px)


def _is_part(curve: Curve, whole: Curve) -> bool:
    """Whether a curve is the beginning of another one, or all of it: runs of one target end at other instants."""
    return np.array_equal(curve.y, whole.y[: len(curve.y)], equal_nan=True)


def _names(column: ShownColumn, curves: Sequence[Curve]) -> dict[float, str]:
    """Words of the values that occur, where the values of a column have words."""
    if not column.words:
        return {}
    seen = sorted({value for curve in curves for value in np.unique(curve.y[np.isfinite(curve.y)]).tolist()})
    return {value: column.words.get(int(value), f"{value:g}").replace("_", " ") for value in seen}


def levels_chart(
    shown: Sequence[tuple[RunColumns, ShownColumn]], bounds: tuple[float, float], is_named: bool, x_label: str = ""
) -> Chart:
    """Levels of watches, 0 is normal: only the names of those that occur."""
    curves: list[Curve] = []
    names = {0.0: shown[0][1].words.get(0, "0").replace("_", " ")}
    for place, (run, column) in enumerate(shown):
        label = column.label.removesuffix(" level")
        look = Look("ink" if place % 2 else run.style.look.colour, 1.6, (4.0, 2.0) if place % 2 else ())
        curves.append(run.curve(column, f"{run.label}: {label}" if is_named else label, look))
        names |= _names(column, curves[-1:])
    ranked = dict(sorted(names.items()))
    return Chart(curves, x_label, "level", bounds, (-0.4, max(ranked) + 0.4), y_names=ranked, sync=TIME,
                 height_px=max(2, len(ranked)) * 22)  # fmt: skip
