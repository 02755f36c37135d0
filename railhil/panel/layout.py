"""The panel's display of a system, from the system's declarations: columns, charts, tracks, lamps.

The columns are those of ``signals.csv`` (:func:`railhil.judge.signals.signal_table`), with those that the system
declares for the panel only (``Judging.shown``); nothing here knows a system.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from railhil.dbc import Contract
from railhil.judge.judging import Judging, judging_of
from railhil.report.display_columns import ERROR, LEVEL, NOTE, SIGNAL, STATE, ShownColumn, grouped, shown_columns
from railhil.scenarios.model import AnyScenario

_SPEED = "km/h"
_MPS = "m/s"
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
class Layout:
    """The data that the page needs before the first value.

    ``speed``, ``target``, ``position``, ``command``: places of the columns of the gauges; -1: there is none.
    The tracking error is a column if there are speed and target.
    """

    columns: tuple[ShownColumn, ...]
    charts: tuple[Chart, ...]
    tracks: tuple[int, ...]
    lamps: tuple[Lamp, ...]
    speed: int
    target: int
    position: int
    command: int

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
    columns += [_make_column(name, _find_unit(contract, port, signal)) for name, port, signal in judging.shown]
    names = [column.name for column in columns]
    speed, target, position, command = (
        names.index(name) if name else -1 for name in (shown.speed, shown.target, shown.position, shown.command)
    )
    if speed >= 0 and target >= 0:
        columns.append(ShownColumn(ERROR, "tracking error", _SPEED, 1.0, SIGNAL))
    lamps = _make_lamps(judging, contract, len(columns))
    columns += [ShownColumn(f"{lamp.port}.{lamp.signal}", lamp.label, "", 1.0, LAMP) for lamp in lamps]
    tracks = tuple(at for at, one in enumerate(columns) if one.kind == LEVEL)
    return Layout(tuple(columns), _make_charts(columns, command), tracks, lamps, speed, target, position, command)


def _make_column(name: str, unit: str) -> ShownColumn:
    """A column that only the panel has."""
    label = name.rpartition("_")[0].replace("_", " ") if unit else name.replace("_", " ")
    is_speed = unit == _MPS
    return ShownColumn(name, label, _SPEED if is_speed else unit, 3.6 if is_speed else 1.0, SIGNAL)


def _find_unit(contract: Contract, port: str, signal: str) -> str:
    return next(item.unit for item in contract.port(port).signals if item.name == signal)


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
