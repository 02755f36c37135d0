"""What the panel shows of a system, from what the system declares: columns, charts, tracks, lamps.

The columns are those of ``signals.csv`` (:func:`railhil.supervisor.signals.signal_table`), with those that the system
declares for the panel only (``Judging.shown``); nothing here knows a system.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from railhil.dbc import Contract, Signal
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import System
from railhil.supervisor.judging import Judging, judging_of
from railhil.supervisor.notes import notes_of
from railhil.supervisor.signals import signal_table, signal_units
from railhil.supervisor.trace import Trace

#: Unit of a column -> unit of the page, and the factor between them.
_DISPLAYED = {"m/s": ("km/h", 3.6), "N": ("kN", 0.001), "permil": ("‰", 1.0), "m/s2": ("m/s²", 1.0)}
#: Endings of column names that only state the unit.
_ENDINGS = ("_mps2", "_mps", "_kmh", "_permil", "_kn", "_n", "_m", "_s", "_1")
#: Title of the chart of a unit, in the order of the page.
_TITLES = {"km/h": "speed", "notch": "command", "m/s²": "acceleration", "kN": "force", "m": "position", "‰": "grade"}
_SPEED, _LENGTH = "km/h", "m"
#: A speed less than the target, as a column of its own.
ERROR = "tracking_error_kmh"


@dataclass(frozen=True, slots=True)
class Column:
    """One column of the page.

    ``unit`` and ``factor``: as shown, and what the recorded value is multiplied by. ``kind``: ``signal``, ``note`` (of
    the law), ``level`` (of a reaction ladder), ``state`` (a number with words) or ``lamp`` (raw values of a lamp).
    ``words``: of the values of a level, a state, or a note that is a bit field.
    """

    name: str
    label: str
    unit: str
    factor: float
    kind: str
    words: Mapping[int, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves with one axis: places of their columns."""

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
class Layout:
    """Everything that the page needs to know before the first value.

    ``speed``, ``target``, ``position``, ``command``: places of the columns of the gauges; -1: there is none.
    The tracking error is a column if there are speed and target.
    """

    columns: tuple[Column, ...]
    charts: tuple[Chart, ...]
    tracks: tuple[int, ...]
    lamps: tuple[Lamp, ...]
    speed: int
    target: int
    position: int
    command: int

    def as_json(self) -> dict[str, Any]:
        """As the page gets it."""
        return asdict(self)


def layout_of(
    scenario: AnyScenario, system: System, contract: Contract, notes: Sequence[Mapping[str, Any]] | None
) -> Layout:
    """The layout for a scenario.

    :param notes: the law's declaration of its notes, as in a certificate; None: not known.
    """
    judging = judging_of(scenario)
    empty = Trace(contract)
    header, _ = signal_table(scenario, empty, notes)
    units = signal_units(scenario, empty, notes)
    told = _notes(judging, empty, notes)
    words = _words(judging, contract) | _bit_words(empty, notes)
    kinds = dict.fromkeys(told, "note") | {f"{watch.name}_level": "level" for watch in judging.watches}
    columns = [
        _column(name, units.get(name, ""), kinds.get(name, ""), words.get(name, {}), told.get(name, ""))
        for name in header[1:]
    ]
    columns += [_column(name, _unit(contract, port, signal), "", {}, "") for name, port, signal in judging.shown]
    names = [column.name for column in columns]
    truth = system.truth
    by_signal = {(port, signal): name for name, port, signal in judging.columns}
    speed = _place(names, by_signal.get((truth.port, truth.speed)) if truth is not None else None)
    position = _place(names, by_signal.get((truth.port, truth.position)) if truth is not None else None)
    target = next((at for at, one in enumerate(columns) if one.unit == _SPEED and "target" in one.name), -1)
    commands = [f"{port}.{signal}" for port, signal in by_signal]
    named = [value for value in system.named.values() if value in commands]
    command = _place(names, by_signal[tuple(named[0].split("."))] if named else None)  # type: ignore[index]
    if command < 0:
        command = next((at for at, one in enumerate(columns) if "command" in one.name and one.unit), -1)
    if speed >= 0 and target >= 0:
        columns.append(Column(ERROR, "tracking error", _SPEED, 1.0, "signal"))
    lamps = _lamps(judging, contract, len(columns))
    columns += [Column(f"{lamp.port}.{lamp.signal}", lamp.label, "", 1.0, "lamp") for lamp in lamps]
    tracks = tuple(at for at, one in enumerate(columns) if one.kind == "level")
    return Layout(tuple(columns), _charts(columns, command), tracks, lamps, speed, target, position, command)


def _place(names: Sequence[str], name: str | None) -> int:
    return names.index(name) if name in names else -1


def _column(name: str, unit: str, kind: str, words: Mapping[int, str], label: str) -> Column:
    shown, factor = _DISPLAYED.get(unit, (unit if unit != "1" else "", 1.0))
    ending = next((end for end in _ENDINGS if name.endswith(end)), "") if unit else ""
    plain = (label or name.removesuffix(ending)).replace("_", " ")
    if not kind and (words or name.endswith("_level")):
        kind = "state"
    return Column(name, plain, shown, factor, kind or "signal", words)


def _notes(judging: Judging, empty: Trace, notes: Any) -> dict[str, str]:
    """Columns of the law's notes, with their titles."""
    found = {
        note.name: note.title for status in (judging.status.every if judging.status else ()) for note in status.notes
    }
    told = {name for name, _, _ in judging.told(empty, notes)}
    titles = {note.name: f"{note.title} {note.symbol}".strip() for note in notes_of(empty, notes)} if told else {}
    return found | {name: titles[name] for name in told if name in titles}


def _words(judging: Judging, contract: Contract) -> dict[str, dict[int, str]]:
    """Words of the columns that have some: of levels in the order of the ladder, of others by their raw value."""
    found: dict[str, dict[int, str]] = {}
    for name, port, signal in judging.columns:
        if (item := _signal(contract, port, signal)) is not None and item.values:
            found[name] = dict(item.values)
    for watch in judging.watches:
        if (item := _signal(contract, watch.port, watch.level)) is not None:
            found[f"{watch.name}_level"] = {
                rank: item.values.get(raw, str(raw)) for rank, raw in enumerate(watch.ladder)
            }
    return found


def _bit_words(empty: Trace, notes: Any) -> dict[str, dict[int, str]]:
    """Words of the notes that are bit fields."""
    found = {}
    for note in notes_of(empty, notes):
        if note.bits:
            sets = range(1 << len(note.bits))
            found[note.name] = {
                value: "+".join(bit for place, bit in enumerate(note.bits) if value >> place & 1) or "none"
                for value in sets
            }
    return found


def _unit(contract: Contract, port: str, signal: str) -> str:
    found = _signal(contract, port, signal)
    return "" if found is None else found.unit


def _signal(contract: Contract, port: str, name: str) -> Signal | None:
    ports = (entry for entry in contract.ports if entry.name == port)
    return next((item for entry in ports for item in entry.signals if item.name == name), None)


def _charts(columns: Sequence[Column], command: int) -> tuple[Chart, ...]:
    """Curves of one unit share a chart; the law's notes have one for each unit, and the tracking error its own."""
    groups: dict[tuple[str, str], list[int]] = {}
    for at, column in enumerate(columns):
        if column.kind not in ("signal", "note"):
            continue
        title = _TITLES.get(column.unit, column.unit or "numbers")
        if column.kind == "note":
            title = "law"
        elif column.name == ERROR:
            title = "tracking error"
        groups.setdefault((title, column.unit), []).append(at)
    first = ["speed", "tracking error", "command", "acceleration", "force", "law"]
    found = [Chart(title, unit, tuple(places)) for (title, unit), places in groups.items() if title != "position"]
    return tuple(
        sorted(
            found,
            key=lambda chart: (
                0 if chart.title == "speed" else 1 if chart.title == "tracking error" else 2,
                command not in chart.columns,
                first.index(chart.title) if chart.title in first else len(first),
            ),
        )
    )


def _lamps(judging: Judging, contract: Contract, before: int) -> tuple[Lamp, ...]:
    """The lamps, whose columns follow so many others."""
    found = [
        (item.port, name, normal)
        for item in judging.interlocks
        for name, normal in item.normal.items()
        if _signal(contract, item.port, name) is not None
    ]
    return tuple(
        # A number that is 0 in normal operation says that there is none of something.
        Lamp(port, name, _label(name) if normal else f"no {_label(name)}", normal, before + place)
        for place, (port, name, normal) in enumerate(found)
    )


def _label(name: str) -> str:
    """Words of a signal's name: ``DoorsClosedLocked`` -> ``doors closed locked``."""
    return "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in name).strip()
