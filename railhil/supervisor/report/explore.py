"""The part of the report that a reader explores: signals, events and ladders of the runs as data for ``explore.js``."""

from __future__ import annotations

import re
from collections.abc import Sequence, Set
from dataclasses import replace
from typing import Any

import numpy as np

from railhil.common.plain_text import plain
from railhil.supervisor.events.event import LEVEL, START, RecordedEvent
from railhil.supervisor.report.assets import as_json
from railhil.supervisor.report.events_panel import event_rows
from railhil.supervisor.report.recorded import RecordedRun
from railhil.supervisor.report.styles import Style, styles
from railhil.supervisor.report.thinned import packed, seen_rows, text
from railhil.supervisor.shown import LEVEL as LEVEL_KIND
from railhil.supervisor.shown import NOTE, SIGNAL, STATE, Shown, shown_columns
from railhil.supervisor.signals import drawn_table
from railhil.supervisor.trace import FloatArray

#: Stretches of a curve of one run, each with two points at most; of many runs together at most so many.
_STRETCHES, _STRETCHES_TOGETHER, _STRETCHES_MIN = 500, 2000, 150
#: Of a column over which others are drawn: close enough that nobody sees the difference.
_FINE = 1e-6
#: Events of a run that are marked; of more of them the table has all.
_EVENTS_MAX = 200
#: Target less speed, in a chart of its own.
ERROR = "tracking_error"
#: What columns of several units differ in.
_NUMBER = re.compile(r"\d+")
#: Charts that are open at first.
_CHARTS_FIRST = 5


def explored(runs: Sequence[RecordedRun]) -> str:
    """The data of the runs that can be drawn as JSON, safe within a script element; empty if there are none.

    The same records give the same text.
    """
    drawn = [
        (run, style)
        for run, style in zip(runs, styles([run.controller for run in runs]), strict=True)
        if run.can_be_drawn
    ]
    if not drawn:
        return ""
    stretches = max(_STRETCHES_MIN, min(_STRETCHES, _STRETCHES_TOGETHER // len(drawn)))
    shown: dict[str, dict[str, Any]] = {}
    found: list[dict[str, Any]] = []
    over: list[str] | None = None
    first: list[str] = []
    roles: dict[str, str] = {}
    for run, style in drawn:
        columns = _with_error(shown_columns(run.scenario, run.trace.contract, run.certificate.get("notes")))
        document, steady, constant = _run(run, style, columns, stretches)
        found.append(document)
        over = steady if over is None else [name for name in over if name in steady]
        for column in columns.columns:
            shown.setdefault(column.name, _column(column))
        if not roles:
            moving = document["signals"].keys() - constant
            first = _first(columns, moving)
            roles = {"speed": columns.speed, "target": columns.target}
    document = {"runs": found, "columns": list(shown.values()), "over": over, "first": first, "error": ERROR, **roles}
    return as_json(document)


def _column(column: Any) -> dict[str, Any]:
    return {
        "name": column.name,
        "label": column.label,
        "unit": column.unit,
        "factor": column.factor,
        "kind": column.kind,
        "words": {str(value): word.replace("_", " ") for value, word in column.words.items()},
    }


def _with_error(shown: Shown) -> Shown:
    """The columns, and target less speed as one of its own: lines of a speed lie too close to be told apart."""
    speed = shown.named(shown.speed)
    if speed is None or not shown.target:
        return shown
    return replace(shown, columns=(*shown.columns, replace(speed, name=ERROR, label="target less speed")))


def _first(columns: Shown, moving: Set[str]) -> list[str]:
    """The columns that are drawn at first: speed and target, the command, and of each further unit the first one, with
    those that differ from it only in a number (of a unit of the train).

    :param moving: columns that are not constant; others are left out.
    """
    error = ERROR if columns.named(ERROR) else ""
    found = [name for name in (columns.speed, columns.target, error, columns.command) if name]
    # The position is what others are drawn over.
    units = {one.unit for name in (*found, columns.position) if (one := columns.named(name))}
    for column in columns.columns:
        if column.kind != SIGNAL or column.unit in {*units, ""} or column.name not in moving:
            continue
        if len(units) <= _CHARTS_FIRST:
            alike = [one.name for one in columns.columns if _NUMBER.sub("", one.name) == _NUMBER.sub("", column.name)]
            found += alike
            units.add(column.unit)
    return found


def _run(run: RecordedRun, style: Style, shown: Shown, stretches: int) -> tuple[dict[str, Any], list[str], set[str]]:
    """One run for the page; its position if it never decreases, over which others can be drawn; and the columns that
    never change."""
    header, table = drawn_table(run.scenario, run.trace, run.certificate.get("notes"))
    signals: dict[str, dict[str, Any]] = {}
    steady: list[str] = []
    constant: set[str] = set()
    reacted = {f"{event.source}_level" for event in run.events if event.kind == LEVEL}
    for column in shown.columns:
        if column.name == ERROR:
            values = table[:, header.index(shown.target)] - table[:, header.index(shown.speed)]
        else:
            values = table[:, header.index(column.name)]
        finite = np.isfinite(values)
        if not finite.any() or (column.kind == NOTE and not values[finite].any()):
            continue
        if column.name == shown.position and finite.all() and np.all(np.diff(values) >= 0) and np.ptp(values) > 0:
            steady.append(column.name)
            rows = seen_rows(values, 2 * stretches, _FINE)
        else:
            # The value of a state or level holds until the next: every change is needed.
            rows = seen_rows(values, len(values) if column.kind in (STATE, LEVEL_KIND) else stretches)
        signals[column.name] = packed(rows, values, table[:, 0])
        if np.ptp(values[finite]) == 0:
            constant.add(column.name)
        if column.name in reacted:
            signals[column.name]["used"] = True
    document = {
        "label": plain(run.label),
        "colour": style.law,
        "dash": style.dashes,
        "width": style.width,
        "time": _times(table[:, 0]),
        "signals": signals,
        "events": _events(run.events),
    }
    return document, steady, constant


def _times(time_s: FloatArray) -> dict[str, Any]:
    """Instants of the rows: start, step and number where the rows are evenly spaced, else each of them."""
    count = len(time_s)
    step_s = float(time_s[-1] - time_s[0]) / max(count - 1, 1)
    even = time_s[0] + step_s * np.arange(count)
    if np.abs(even - time_s).max() < 1e-6:
        return {"start": float(time_s[0]), "step": round(step_s, 9), "n": count}
    return {"n": count, "t": text(time_s.astype("<f8"))}


def _events(events: Sequence[RecordedEvent]) -> list[list[Any]]:
    """Marks: instant and end in s (null: none), words, whether it is an injected fault.

    Events that differ only in their instants are one mark, from the first to the last; of reactions, which the tracks
    show, only their beginning. If there are too many, the first ones, faults in any case.
    """
    rows = event_rows("", [event for event in events if event.kind != START])
    if len(rows) > _EVENTS_MAX:
        faults = [row for row in rows if row.is_fault]
        rows = faults + [row for row in rows if not row.is_fault][: max(0, _EVENTS_MAX - len(faults))]
    found = []
    for row in sorted(rows, key=lambda row: row.first_s):
        why = row.why or row.what
        said = f"{row.what}: {why}" if row.what.isupper() else why
        times = f", {row.count} times" if row.count > 1 and not row.is_fault else ""
        until_s = round(row.until_s, 4) if row.until_s > row.first_s and not row.what.isupper() else None
        found.append([round(row.first_s, 4), until_s, plain(f"{said} ({row.source}{times})"), row.is_fault])
    return found
