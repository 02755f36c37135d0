"""Display of the columns of ``signals.csv``: names, units, words; the roles speed, target and command; the columns that
share a chart. The page of a run, the panel and ``railhil plot`` take it from here.

All of it comes from the system's declarations; nothing here knows a system.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from railhil.dbc import Contract, Signal
from railhil.judge.judging import Judging, judging_of
from railhil.judge.signals import signal_table, signal_units
from railhil.record.notes import ReportedNote
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import System

#: Unit of a column -> unit as shown, and the factor between them.
_DISPLAYED = {
    "m/s": ("km/h", 3.6),
    "N": ("kN", 0.001),
    "permil": ("‰", 1.0),
    "m/s2": ("m/s²", 1.0),
    "m2": ("m²", 1.0),
    "1": ("", 1.0),
}
#: Endings of column names that only state the unit.
_ENDINGS = ("_mps2", "_mps", "_kmh", "_permil", "_kn", "_n", "_m", "_s", "_1")
SIGNAL, NOTE, LEVEL, STATE = "signal", "note", "level", "state"
#: Target less speed, as a column of its own: two lines of a speed lie too close to be told apart.
ERROR = "tracking_error"
#: Title of the chart with it.
TRACKING_ERROR = "tracking error"
_SPEED, _LAW, _LEVELS = "speed", "law", "reactions"
#: Title of the chart of a unit; other charts have the unit as title.
_TITLES = {
    "km/h": _SPEED,
    "notch": "command",
    "m/s²": "acceleration",
    "kN": "force",
    "m": "position",
    "‰": "grade",
    "s": "duration",
}
#: Order of the charts; the command's chart comes after the second, others follow.
_ORDER = (_SPEED, TRACKING_ERROR, "acceleration", "force", _LAW)


@dataclass(frozen=True, slots=True)
class ShownColumn:
    """One column after the time.

    ``name``: in ``signals.csv``; ``label``: for readers. ``unit`` and ``factor``: the displayed unit, and the factor
    from the value of the table. ``kind``: ``signal``, ``note`` (of the law), ``level`` (place in a reaction ladder) or
    ``state`` (a number with words). ``words``: of its values, if they have some.
    """

    name: str
    label: str
    unit: str
    factor: float
    kind: str
    words: Mapping[int, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Shown:
    """The columns in the order of ``signals.csv`` without the time, and the names of those with a role.

    ``speed``, ``target``, ``position``, ``command``: empty if there is none.
    """

    columns: tuple[ShownColumn, ...]
    speed: str
    target: str
    position: str
    command: str

    def named(self, name: str) -> ShownColumn | None:
        """The column of that name."""
        return next((column for column in self.columns if column.name == name), None)


@dataclass(frozen=True, slots=True)
class ColumnGroup:
    """Columns that share a chart."""

    title: str
    unit: str
    columns: tuple[ShownColumn, ...]


def grouped(columns: Iterable[ShownColumn], command: str = "") -> list[ColumnGroup]:
    """Columns of one unit share a chart; the notes of a law have their own, so have the tracking error, the levels of
    the watches, and each column whose values have words.

    :param command: name of the column of the command.
    """
    groups: dict[tuple[str, str], list[ShownColumn]] = {}
    for column in columns:
        title = _TITLES.get(column.unit, column.unit or "numbers")
        if column.kind == LEVEL:
            title = _LEVELS
        elif column.name == ERROR:
            title = TRACKING_ERROR
        elif column.words:
            title = column.label
        elif column.kind == NOTE:
            title = _LAW
        groups.setdefault((title, column.unit), []).append(column)

    def rank(group: ColumnGroup) -> tuple[int, bool, int]:
        place = _ORDER.index(group.title) if group.title in _ORDER else len(_ORDER)
        return min(place, 2), command not in {one.name for one in group.columns}, place

    return sorted((ColumnGroup(*key, tuple(found)) for key, found in groups.items()), key=rank)


def with_error(shown: Shown) -> Shown:
    """The columns, and the tracking error if there are speed and target."""
    speed = shown.named(shown.speed)
    if speed is None or not shown.target:
        return shown
    return replace(shown, columns=(*shown.columns, replace(speed, name=ERROR, label="target less speed")))


def shown_columns(scenario: AnyScenario, contract: Contract | None = None, notes: Any = None) -> Shown:
    """The columns of a scenario's records.

    :param contract: contract of the record; None: the system's own.
    :param notes: the law's declaration of its notes, as in the certificate; None: not known.
    """
    system, judging = scenario.installed_system, judging_of(scenario)
    empty = Trace(contract or system.contract)
    header, _ = signal_table(scenario, empty, notes)
    units = signal_units(scenario, empty, notes)
    statuses = judging.status.every if judging.status else ()
    told = {note.name: (note, status.port) for status in statuses for note in status.recorded(empty, notes)}
    words = _words(judging, empty.contract, told.values())
    levels = {f"{watch.name}_level" for watch in judging.watches}
    columns = tuple(
        describe_column(name, units.get(name, ""), words.get(name, {}), told.get(name, (None,))[0], name in levels)
        for name in header[1:]
    )
    by_signal = {(port, signal): name for name, port, signal in judging.columns}
    truth = system.truth
    speed = by_signal.get((truth.port, truth.speed), "") if truth else ""
    position = by_signal.get((truth.port, truth.position), "") if truth else ""
    speed_unit = next((column.unit for column in columns if column.name == speed), "km/h")
    target = next((one.name for one in columns if one.unit == speed_unit and "target" in one.name), "")
    return Shown(columns, speed, target, position, _command(system, by_signal, columns))


def _command(system: System, by_signal: Mapping[tuple[str, str], str], columns: Sequence[ShownColumn]) -> str:
    """The first command that the system names, else the first column of that name."""
    for place in system.named.values():
        port, _, signal = place.partition(".")
        if (port, signal) in by_signal:
            return by_signal[port, signal]
    return next((one.name for one in columns if one.kind == SIGNAL and "command" in one.name), "")


def describe_column(
    name: str, unit: str, words: Mapping[int, str], note: ReportedNote | None = None, is_level: bool = False
) -> ShownColumn:
    """The display of a column from its name and unit: label without the ending that only states the unit.

    :param words: of its values; empty: they are numbers.
    :param note: the note of the law that it has; None: it is none.
    """
    shown, factor = _DISPLAYED.get(unit, (unit, 1.0))
    ending = next((end for end in _ENDINGS if name.endswith(end)), "") if unit else ""
    # Of a unit of the train: "true speed 1".
    label = re.sub(r"(?<=[a-z])(?=\d)", " ", name.removesuffix(ending).replace("_", " "))
    if note is not None:
        label, words = f"{note.title.replace('_', ' ')} {note.symbol}".strip(), words or _of_bits(note.bits)
    kind = LEVEL if is_level else NOTE if note is not None else STATE if words else SIGNAL
    return ShownColumn(name, label, shown, factor, kind, words)


def _of_bits(bits: Sequence[str]) -> dict[int, str]:
    """Words of the values of a bit field."""
    if not bits:
        return {}
    return {
        value: "+".join(name for place, name in enumerate(bits) if value >> place & 1) or "none"
        for value in range(2 ** len(bits))
    }


def _words(
    judging: Judging, contract: Contract, notes: Iterable[tuple[ReportedNote, str]]
) -> dict[str, dict[int, str]]:
    """Words of columns: of levels in the order of the ladder, of others by their raw value.

    :param notes: the notes with their ports.
    """
    found = {
        name: dict(item.values)
        for name, port, signal in (*judging.columns, *((note.name, port, note.signal) for note, port in notes))
        if (item := _signal(contract, port, signal)) is not None and item.values
    }
    for watch in judging.watches:
        if (item := _signal(contract, watch.port, watch.level)) is not None:
            names = {rank: item.values.get(raw, str(raw)) for rank, raw in enumerate(watch.ladder)}
            found[f"{watch.name}_level"] = names
    return found


def _signal(contract: Contract, port: str, name: str) -> Signal | None:
    signals = (item for entry in contract.ports if entry.name == port for item in entry.signals)
    return next((item for item in signals if item.name == name), None)
