"""The panel's display of a system, from the system's declarations: columns and their rows, charts, tracks, lamps.

The columns are those of ``signals.csv`` (:func:`railhil.judge.signals.signal_table`), with those that the system
declares for the panel only (``Judging.shown``); nothing here knows a system.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from railhil.charts.curve_points import TOLERANCE, pick_bends
from railhil.dbc import Contract, Signal
from railhil.judge.declared import Place, ShownProfile
from railhil.judge.judging import Judging, judging_of
from railhil.judge.signals import table_of
from railhil.panel.history import is_gap
from railhil.record.sampling import Sampler, gap_after, holding_s, silences
from railhil.record.trace import FloatArray, Trace
from railhil.report.display_columns import (
    ERROR,
    LEVEL,
    NOTE,
    SIGNAL,
    STATE,
    TRACKING_ERROR,
    ShownColumn,
    describe_column,
    grouped,
    shown_columns,
)
from railhil.scenarios.model import AnyScenario

_SPEED = "km/h"
#: Kind of a column with the raw values of a lamp.
LAMP = "lamp"


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves on one axis: places of their columns."""

    title: str
    unit: str
    columns: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Lamp:
    """A state of the train that is on in normal operation: a signal of a port and its normal raw value.

    ``column``: place of its raw values among the columns.
    """

    port: str
    signal: str
    label: str
    normal: int
    column: int


@dataclass(frozen=True, slots=True)
class Desk:
    """An arrangement of tiles on the page: name, width in twelfths and height in rows of each, in their order.

    A tile that a page does not have is left out; one that is not named follows with the size of a chart.
    """

    name: str
    tiles: tuple[tuple[str, int, int], ...]


@dataclass(frozen=True, slots=True)
class Layout:
    """The data that the page needs before the first value.

    ``speed``, ``target``, ``position``, ``command``, ``applied``: places of the columns of the gauges; -1: there is
    none. ``gauges``: of the columns that stand at first sight beside these. The tracking error is a column if there are
    speed and target. ``places`` and ``profiles``: of the line that is drawn with the place of the train, ``strip``: the
    columns that are drawn over it; empty: there is none. ``assumptions``: what the scenario assumes, and what it is
    not. ``system``: its name, under which a page keeps arrangements of its tiles; ``desks``: those that it begins with.
    """

    columns: tuple[ShownColumn, ...]
    charts: tuple[Chart, ...]
    tracks: tuple[int, ...]
    lamps: tuple[Lamp, ...]
    speed: int
    target: int
    position: int
    command: int
    gauges: tuple[int, ...] = ()
    places: tuple[Place, ...] = ()
    strip: tuple[int, ...] = ()
    profiles: tuple[ShownProfile, ...] = ()
    applied: int = -1
    assumptions: tuple[str, ...] = ()
    system: str = ""
    desks: tuple[Desk, ...] = ()

    def as_json(self) -> dict[str, Any]:
        """The JSON form for the page."""
        return asdict(self)


#: The layout of a run of an unknown system.
NO_LAYOUT = Layout((), (), (), (), -1, -1, -1, -1)


def make_layout(scenario: AnyScenario, contract: Contract, notes: Sequence[Mapping[str, Any]] | None) -> Layout:
    """The layout for a scenario.

    :param notes: the law's declaration of its notes, as in a certificate; None: not known.
    """
    judging = judging_of(scenario)
    shown = shown_columns(scenario, contract, notes)
    # A level without words is no curve if the watch also has a level with words.
    columns = [
        replace(one, kind=STATE) if one.kind == SIGNAL and one.name.endswith("_level") else one for one in shown.columns
    ]
    for name, port, signal in judging.shown:
        found = _find_signal(contract, port, signal)
        columns.append(describe_column(name, found.unit, dict(found.values)))
    names = [column.name for column in columns]
    speed, target, position, command = (
        names.index(name) if name else -1 for name in (shown.speed, shown.target, shown.position, shown.command)
    )
    if speed >= 0 and target >= 0:
        columns.append(ShownColumn(ERROR, "tracking error", _SPEED, 1.0, SIGNAL))
    lamps = _make_lamps(judging, contract, len(columns))
    columns += [ShownColumn(f"{lamp.port}.{lamp.signal}", lamp.label, "", 1.0, LAMP) for lamp in lamps]
    tracks = tuple(at for at, one in enumerate(columns) if one.kind == LEVEL)
    gauges = tuple(at for at, one in enumerate(columns) if one.name in judging.gauges)
    applied = next((at for at, one in enumerate(columns) if one.name == judging.applied), -1)
    strip = tuple(at for at, one in enumerate(columns) if one.name in judging.strip)
    strip = strip or tuple(at for at in (speed, target) if at >= 0)
    has_line = position >= 0 and bool(strip)
    places = tuple(judging.places(scenario)) if has_line else ()
    profiles = tuple(map(_thin, judging.profiles(scenario))) if has_line else ()
    charts = _make_charts(columns, command)
    return Layout(
        tuple(columns),
        charts,
        tracks,
        lamps,
        speed,
        target,
        position,
        command,
        gauges,
        places,
        strip if places or profiles else (),
        profiles,
        applied,
        tuple(scenario.assumptions),
        scenario.system,
        _make_desks(charts, command),
    )


def _thin(profile: ShownProfile) -> ShownProfile:
    """The profile without the rows on the line between others; to 0.001 of its units."""
    if profile.is_step:
        return profile
    at, values = np.array(profile.rows).T
    # Of a train that stands, one row.
    rows = np.flatnonzero(np.diff(at, prepend=-np.inf) > 0.0)
    rows = rows[pick_bends(at[rows], values[rows], TOLERANCE * float(np.ptp(values)))]
    return replace(profile, rows=tuple(zip(at[rows].round(3).tolist(), values[rows].round(3).tolist(), strict=True)))


def _find_signal(contract: Contract, port: str, signal: str) -> Signal:
    return next(item for item in contract.port(port).signals if item.name == signal)


def _make_charts(columns: Sequence[ShownColumn], command: int) -> tuple[Chart, ...]:
    """Curves of signals and notes; the position belongs to the train in the page's own picture."""
    places = {column.name: at for at, column in enumerate(columns)}
    curves = [column for column in columns if column.kind in (SIGNAL, NOTE)]
    groups = grouped(curves, columns[command].name if command >= 0 else "")
    return tuple(
        Chart(group.title, group.unit, tuple(places[column.name] for column in group.columns))
        for group in groups
        if group.title != "position"
    )


def _make_desks(charts: Sequence[Chart], command: int) -> tuple[Desk, ...]:
    """What is watched stands first and large: to drive, to see what a fault does, the bus, all curves at once."""
    beside = [one.title for one in charts if command in one.columns or one.title == TRACKING_ERROR]
    # Two of them are as high as the picture of the line.
    small = dict.fromkeys((*beside[:2], "reaction ladders", "events", "values", "speed"), (4, 6))
    return (
        Desk("drive", (("line", 8, 12), *((title, *size) for title, size in small.items()))),
        Desk("faults", (("line", 8, 7), ("events", 4, 12), ("reaction ladders", 8, 5), ("values", 12, 4))),
        Desk("bus", (("frames", 8, 10), ("events", 4, 10), ("line", 12, 8))),
        Desk(
            "curves",
            tuple((title, 4, 4) for title in (*dict.fromkeys(one.title for one in charts), "reaction ladders")),
        ),
    )


def _make_lamps(judging: Judging, contract: Contract, before: int) -> tuple[Lamp, ...]:
    """The lamps; their columns follow the others."""
    found = [
        (item.port, name, normal)
        for item in judging.interlocks
        for name, normal in item.normal.items()
        if any(entry.name == item.port and name in {one.name for one in entry.signals} for entry in contract.ports)
    ]
    return tuple(
        # A number that is 0 in normal operation tells that something is absent.
        Lamp(port, name, _make_label(name) if normal else f"no {_make_label(name)}", normal, before + place)
        for place, (port, name, normal) in enumerate(found)
    )


def _make_label(name: str) -> str:
    """Words of a signal's name: ``DoorsClosedLocked`` -> ``doors closed locked``."""
    return "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in name).strip()


class Rows:
    """Makes rows of one layout.

    :param notes: the law's declaration of its notes; None: not known.
    """

    def __init__(self, scenario: AnyScenario, layout: Layout, notes: Any = None) -> None:
        self._scenario, self._layout, self._notes = scenario, layout, notes
        self._judging = judging_of(scenario)
        self._holds_s = holding_s(scenario, scenario.installed_system.contract)
        self._truth_holds_s = self._holds_s.get(self._judging.truth, np.inf)
        plain = [column for column in layout.columns if column.kind != LAMP and column.name != ERROR]
        self._factors = np.array([1.0, *(column.factor for column in plain)])
        self._has_error = any(column.name == ERROR for column in layout.columns)

    def make(self, trace: Trace, after_s: float = -1.0, before_s: float = np.inf) -> FloatArray:
        """One row for each telegram of the truth: time in s, then the columns in their shown units.

        :param after_s, before_s: only rows after the first and before the second; the present tick is not complete.
        :returns: shape (n, 1 + columns); unknown values are NaN.
        """
        layout = self._layout
        _, table = table_of(self._judging, self._scenario, trace, self._notes, self._holds_s)
        table = table[(table[:, 0] > after_s) & (table[:, 0] < before_s)]
        time_s, width = table[:, 0], table.shape[1]
        rows: FloatArray = np.empty((len(table), 1 + len(layout.columns)))
        rows[:, :width] = table
        sampler = Sampler(trace, time_s, self._holds_s)
        for place, (_, port, signal) in enumerate(self._judging.shown, start=width):
            rows[:, place] = sampler.signal(port, signal)
        plain = len(self._factors)
        rows[:, :plain] *= self._factors
        if self._has_error:
            rows[:, plain] = rows[:, 1 + layout.target] - rows[:, 1 + layout.speed]
        for lamp in layout.lamps:
            rows[:, 1 + lamp.column] = sampler.signal(lamp.port, lamp.signal)
        return rows

    def gap_after(self, rows: FloatArray) -> FloatArray:
        """For each row the row after which nothing is known (:func:`is_gap`)."""
        position = self._layout.position
        return gap_after(rows, 1 + position if position >= 0 else -1)

    def is_over(self, last_s: float, now_s: float) -> bool:
        """Whether the newest row, at ``last_s``, is out of date."""
        return bool(len(silences(np.array([last_s, now_s]), self._truth_holds_s)))

    def insert_gaps(self, rows: FloatArray, before: FloatArray | None = None) -> FloatArray:
        """The rows, with an additional one for each gap between them, so that no line is drawn across it.

        :param before: the row before them, shape (1 + columns,); None: there is none.
        """
        whole = rows if before is None else np.vstack((before, rows))
        last = silences(whole[:, 0], self._truth_holds_s)
        # A gap that is known already.
        last = last[~is_gap(whole[last], self._layout.position)]
        found: FloatArray = np.insert(whole, last + 1, self.gap_after(whole[last]), axis=0)
        return found if before is None else found[1:]
