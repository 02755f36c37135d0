"""Recorded runs as messages for the pages; of a law that learns also its errors and its memory from run to run.

A sequence that is being recorded is read again when another run has ended.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.judge.cross_check import check_folder
from railhil.judge.judging import judging_of, sequence_measures
from railhil.judge.record import Record, checked_record
from railhil.panel.branches import Branches
from railhil.panel.events import describe_event
from railhil.panel.layout import Chart, Layout, Rows, make_layout
from railhil.panel.wire import REPLACE, encode_batch
from railhil.record.documents import read_certificate, read_score
from railhil.record.trace import FloatArray
from railhil.report.display_columns import ShownColumn
from railhil.report.recorded import distinct_labels
from railhil.scenarios.memory import MEMORY_AFTER, BadRecord, read_record
from railhil.scenarios.model import AnyScenario

#: File that ``railhil sequence run`` writes beside its run folders, and the names of these.
SEQUENCE, _RUNS = "sequence.json", "run[0-9]*"


def find_run_folders(texts: Sequence[str]) -> tuple[list[str], list[str]]:
    """The run folders of a command line: the folders whose curves are shown, and all of them.

    A recorded sequence shows the curves of its first and its last run.

    :raises InputError: a sequence has no finished run.
    """
    shown: list[str] = []
    every: list[str] = []
    for text in texts:
        folder = Path(text)
        if not (folder / SEQUENCE).is_file():
            shown.append(text)
            every.append(text)
            continue
        # A run that was interrupted has no certificate yet.
        runs = sorted(str(one) for one in folder.glob(_RUNS) if read_certificate(one) is not None)
        if not runs:
            raise InputError(folder, "", Words("is a sequence without a finished run"), "one finished run or more")
        shown += dict.fromkeys((runs[0], runs[-1]))
        every += runs
    return shown, every


def make_learning_charts(scenario: AnyScenario, folders: Sequence[str]) -> list[dict[str, Any]]:
    """Charts over the number of the run: the system's measures of a sequence, and each number in the memory.

    ``data`` of a chart: numbers of the runs, then a list for each of its ``series``, None where there is no value.

    :returns: empty unless the folders are runs of one law with a memory, each with a number of its own.
    :raises InputError: a file is damaged.
    """
    runs: dict[int, tuple[Mapping[str, float | None], dict[str, float]]] = {}
    laws = set()
    for folder in map(Path, folders):
        certificate, score = read_certificate(folder), read_score(folder)
        if certificate is None or score is None or not (folder / MEMORY_AFTER).is_file():
            continue
        laws.add(certificate["controller"])
        number = int(certificate.get("run_number") or 0)
        if number in runs:
            return []
        try:
            record = read_record(folder / MEMORY_AFTER)
        except BadRecord as bad:
            raise bad.error from None
        runs[number] = {**score["scores"], **score["signed"]}, dict(_find_numbers(record.values))
    if len(runs) < 2 or len(laws) > 1:
        return []
    numbers = sorted(runs)
    charts = []
    for measure in sequence_measures(scenario, judging_of(scenario)):
        criterion, limit = measure.criterion, measure.converged
        errors = [runs[number][0].get(criterion.signed or criterion.key) for number in numbers]
        lines = [("limit", limit), *([("-limit", -limit)] if criterion.signed else [])]
        charts.append(
            {
                "title": f"{criterion.title} by run",
                "unit": criterion.unit,
                "series": [criterion.title, *(name for name, _ in lines)],
                "data": [numbers, errors, *([value] * len(numbers) for _, value in lines)],
            }
        )
    for name in dict.fromkeys(name for number in numbers for name in runs[number][1]):
        kept = [runs[number][1].get(name) for number in numbers]
        charts.append({"title": f"memory: {name}", "unit": "", "series": [name], "data": [numbers, kept]})
    return charts


def _find_numbers(values: Any, name: str = "") -> Iterator[tuple[str, float]]:
    """The numbers with a decimal point in a memory, without counters, keys and histories, by their place."""
    if isinstance(values, Mapping):
        for key, value in values.items():
            yield from _find_numbers(value, f"{name} {key}".strip())
    elif isinstance(values, list) and all(isinstance(one, Mapping) for one in values):
        for place, one in enumerate(values, start=1):
            yield from _find_numbers(one, name if len(values) == 1 else f"{name} {place}")
    elif isinstance(values, float):
        yield name, values


#: Wall time between two readings of a folder.
_LOOK_S = 0.5


class LiveSequence:
    """The sequences among some folders; a complete one does not change any more, and checking it costs one stat.

    :param folders: as given by the user.
    """

    def __init__(self, scenario: AnyScenario, folders: Sequence[str]) -> None:
        self._scenario = scenario
        self._folders = list(folders)
        self._files = [path for folder in folders if (path := Path(folder) / SEQUENCE).is_file()]
        self._stamps = self._read_stamps()
        self._look_s = time.monotonic()

    def look(self) -> list[dict[str, Any]] | None:
        """The charts of :func:`make_learning_charts`, if another run has ended since the last reading; else None."""
        now_s = time.monotonic()
        if not self._files or now_s - self._look_s < _LOOK_S:
            return None
        self._look_s = now_s
        stamps = self._read_stamps()
        if stamps == self._stamps:
            return None
        try:
            charts = make_learning_charts(self._scenario, find_run_folders(self._folders)[1])
        except InputError:
            # The next run is being written: at the next reading it is complete, or has not begun.
            return None
        self._stamps = stamps
        return charts

    def _read_stamps(self) -> list[int]:
        # ``railhil sequence run`` writes it anew after each run, when the folder of the run is complete.
        return [path.stat().st_mtime_ns if path.exists() else 0 for path in self._files]


#: Rows of a run for a page; a longer run is divided into equal parts with the smallest and largest value of each
#: column.
ROWS_MAX = 40_000


class RecordedRuns:
    """Run folders of one system beside each other; a recorded sequence has its first and last run and its learned
    values.

    :param requirements: files or systems whose sentences judge the runs, besides their own.
    :raises InputError: a folder cannot be read, or belongs to another system than the first, or a sentence does not
        fit.
    """

    def __init__(self, folders: Sequence[str], requirements: Sequence[str] = ()) -> None:
        asked, (folders, every) = list(folders), find_run_folders(folders)
        records = [checked_record(folder, None) for folder in folders]
        if requirements:
            from railhil.cli.score import further_required

            records = [further_required(record, requirements) for record in records]
        for place in map(Path, set(every).difference(folders)):
            # Only two runs of a sequence are read as records; the charts over its runs show all of them.
            check_folder(place, read_certificate(place))
        first = records[0].scenario
        for folder, record in zip(folders, records, strict=True):
            if record.scenario.system != first.system:
                allowed = f"a run of system {first.system}, as in {folders[0]}"
                raise InputError(folder, "system", record.scenario.system, allowed)
        layouts = [_make_layout(record) for record in records]
        self.layout = merge_layouts(layouts)
        # Runs of a sequence differ in their numbers.
        self._names = _name_runs(records) if asked == folders else [Path(folder).name for folder in folders]
        self._records = records
        self._learning = make_learning_charts(first, every)
        self._growing = LiveSequence(first, asked)
        self.branches = Branches([record.folder for record in records])
        self._rows = [
            thin_rows(_arrange(_make_rows(one, layout), layout, self.layout), self.layout.position)
            for one, layout in zip(records, layouts, strict=True)
        ]

    def describe(self) -> dict[str, Any]:
        """The first message to a page."""
        runs = [
            {"name": name, "facts": {"scenario": one.scenario.name, "verdict": _describe_verdict(name, one)}}
            for name, one in zip(self._names, self._records, strict=True)
        ]
        return {
            "kind": "recorded",
            "runs": runs,
            "layout": self.layout.as_json(),
            "learning": self._learning,
            "branches": True,
        }

    def read_past(self) -> list[str | bytes]:
        """All rows and events."""
        several = len(self._records) > 1
        events = [
            describe_event(event, f"{name} " if several else "")
            for name, record in zip(self._names, self._records, strict=True)
            for event in record.events
        ]
        events.sort(key=lambda event: float(event["time_s"]))
        rows: list[str | bytes] = [encode_batch(REPLACE, number, rows) for number, rows in enumerate(self._rows)]
        messages = [*rows, json.dumps({"events": events, "replace": True}), self.branches.describe()]
        if any(record.score.requirements for record in self._records):
            # Runs without requirements do not load their language.
            from railhil.panel.requirements import describe_outcomes

            names = self._names if several else [""]
            judged = [record.score.requirements for record in self._records]
            messages.append(describe_outcomes(zip(names, judged, strict=True)))
        return messages

    def look(self) -> list[str | bytes]:
        """The news are learned values of a sequence in progress, and branches."""
        news = self.branches.look()
        charts = self._growing.look()
        if charts is None:
            return news
        self._learning = charts
        return [*news, json.dumps({"learning": charts})]

    def list_frames(self) -> str:
        """There is no bus."""
        return ""

    def execute(self, command: dict[str, Any]) -> str:
        """A recorded run takes no orders, but branches (:meth:`railhil.panel.branches.Branches.begin`)."""
        return self.branches.begin(command) if command.get("do") == "branch" else "a recorded run takes no orders"

    @property
    def report(self) -> None:
        """Each run has its own."""

    def watch(self, can_ids: set[int]) -> None:
        """Frames are not shown."""

    def list_kinds(self) -> list[dict[str, Any]]:
        """A recorded run takes no faults."""
        return []


def thin_rows(rows: FloatArray, position: int = -1) -> FloatArray:
    """At most about :data:`ROWS_MAX` rows: each part of a longer table gives its smallest and its largest values; gaps
    remain gaps.

    :param position: place of its column; -1: there is none.
    """
    parts = ROWS_MAX // 2
    if len(rows) <= ROWS_MAX:
        return rows
    edges = np.linspace(0, len(rows), parts + 1).astype(int)[:-1]
    unknown = np.isnan(rows)
    lows = np.minimum.reduceat(np.where(unknown, np.inf, rows), edges)
    highs = np.maximum.reduceat(np.where(unknown, -np.inf, rows), edges)
    found = np.empty((2 * parts, rows.shape[1]))
    found[0::2], found[1::2] = lows, highs
    found[~np.isfinite(found)] = np.nan
    found[1::2][np.logical_or.reduceat(unknown, edges)] = np.nan
    if position >= 0:
        found[1::2, 1 + position] = highs[:, 1 + position]
    return found


def merge_layouts(layouts: Sequence[Layout]) -> Layout:
    """One layout for runs whose laws report different notes: all columns, charts merged by title and unit."""
    columns: list[ShownColumn] = []
    for layout in layouts:
        names = {column.name for column in columns}
        columns += [column for column in layout.columns if column.name not in names]
    place = {column.name: at for at, column in enumerate(columns)}

    def find_place(layout: Layout, at: int) -> int:
        return place[layout.columns[at].name] if at >= 0 else -1

    charts: dict[tuple[str, str], list[int]] = {}
    for layout in layouts:
        for chart in layout.charts:
            known = charts.setdefault((chart.title, chart.unit), [])
            known += [at for one in chart.columns if (at := find_place(layout, one)) not in known]
    first = layouts[0]
    return replace(
        first,
        columns=tuple(columns),
        charts=tuple(Chart(title, unit, tuple(places)) for (title, unit), places in charts.items()),
        tracks=tuple(dict.fromkeys(find_place(layout, at) for layout in layouts for at in layout.tracks)),
        lamps=tuple(replace(lamp, column=find_place(first, lamp.column)) for lamp in first.lamps),
        speed=find_place(first, first.speed),
        target=find_place(first, first.target),
        position=find_place(first, first.position),
        command=find_place(first, first.command),
        gauges=tuple(dict.fromkeys(find_place(layout, at) for layout in layouts for at in layout.gauges)),
        strip=tuple(dict.fromkeys(find_place(layout, at) for layout in layouts for at in layout.strip)),
        assumptions=tuple(dict.fromkeys(sentence for layout in layouts for sentence in layout.assumptions)),
    )


def _make_layout(record: Record) -> Layout:
    notes: Sequence[Mapping[str, Any]] | None = record.certificate.get("notes")
    return make_layout(record.scenario, record.trace.contract, notes)


def _make_rows(record: Record, layout: Layout) -> FloatArray:
    made = Rows(record.scenario, layout, record.certificate.get("notes"))
    return made.insert_gaps(made.make(record.trace))


def _arrange(rows: FloatArray, layout: Layout, wanted: Layout) -> FloatArray:
    """Rows with the columns of another layout, NaN where a run has none."""
    at = {column.name: place for place, column in enumerate(layout.columns, 1)}
    found = np.full((len(rows), 1 + len(wanted.columns)), np.nan)
    found[:, 0] = rows[:, 0]
    for place, column in enumerate(wanted.columns, 1):
        if column.name in at:
            found[:, place] = rows[:, at[column.name]]
    return found


def _name_runs(records: Sequence[Record]) -> list[str]:
    if len(records) == 1:
        return [f"{records[0].scenario.name} {records[0].label}"]
    return distinct_labels(records)


def _describe_verdict(name: str, record: Record) -> str:
    missed = record.trace.missed_polls
    polls = count_of(record.trace.polls, "poll")
    said = f"{name}: {record.verdict}, {missed} of {polls} missed ({record.folder.name})"
    return "; ".join((said, *record.notes))
