"""The table of signals of a run, ``signals.csv``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from railhil.common.errors import did_you_mean
from railhil.judge.declared import Watch, ranks, reports
from railhil.judge.judging import Judging, judging_of
from railhil.record.notes import note_values
from railhil.record.sampling import Sampler, gap_after, holding_s, silences
from railhil.record.trace import FloatArray, Trace
from railhil.scenarios.model import AnyScenario


class Signals(Mapping[str, FloatArray]):
    """Columns of ``signals.csv`` by name: float64 arrays of equal shape (n,), one value per 20 ms, NaN where unknown.

    ``units``: unit of each column, empty for numbers without one.
    """

    def __init__(self, columns: Mapping[str, FloatArray], units: Mapping[str, str]) -> None:
        self._columns = dict(columns)
        self.units = dict(units)

    def __getitem__(self, name: str) -> FloatArray:
        """
        :raises KeyError: no such column; the message has the columns, and the one that was probably meant.
        """
        if name not in self._columns:
            hint = did_you_mean(str(name), self)
            raise KeyError(" ".join(filter(None, (f"no column {name!r};", hint, f"columns: {', '.join(self)}"))))
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        from railhil.charts.notebook import text_table

        return text_table(self._title, self._heads, self._rows())

    def _repr_html_(self) -> str:
        from railhil.charts.notebook import html_cell, html_table

        return html_cell(html_table(self._title, self._heads, self._rows(), numbers=(2, 3)))

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)

    _heads = ("column", "unit", "least", "most")

    @property
    def _title(self) -> str:
        return f"Signals: {len(self)} columns of {len(next(iter(self.values()), ()))} values"

    def _rows(self) -> list[tuple[str, str, str, str]]:
        """Name, unit, least and most of each column."""
        found = []
        for name, values in self.items():
            known = values[np.isfinite(values)]
            range_ = (f"{known.min():.6g}", f"{known.max():.6g}") if known.size else ("-", "-")
            found.append((name, self.units[name], *range_))
        return found

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with ``time_s`` as its index.

        :raises ModuleNotFoundError: pandas is not installed.
        """
        import pandas

        return pandas.DataFrame(self._columns).set_index("time_s")


def signal_table(scenario: AnyScenario, trace: Trace, notes: Any = None) -> tuple[list[str], FloatArray]:
    """Header and rows ``(n, columns)`` of the signals: one row per telegram of the truth port, with the last known
    values.

    :param notes: the law's declaration of its notes, as in the certificate; None: not known.
    """
    return table_of(judging_of(scenario), scenario, trace, notes)


def table_of(
    judging: Judging, scenario: AnyScenario, trace: Trace, notes: Any = None, holds_s: Mapping[str, float] | None = None
) -> tuple[list[str], FloatArray]:
    """As :func:`signal_table`, with the scenario's judging: for a panel, which makes this table 5 times a second.

    :param holds_s: values of a port that is silent for longer are unknown; None: the last value holds.
    """
    time_s = trace.times_s(judging.truth)
    found = [(header, port, trace.values(port, signal)) for header, port, signal in judging.columns]
    for status in judging.status.every if judging.status else ():
        reported = status.recorded(trace, notes)
        found += [(note.name, status.port, note_values(trace, note, status.port)) for note in reported]
    found += judging.told(trace, notes)
    watches = _watches(judging, trace)
    found += [(f"{watch.name}_level", watch.port, ranks(trace, watch)) for watch in watches]
    found += [(header, judging.truth, values) for header, _, values in judging.reckoned(scenario, trace)]
    sampler = Sampler(trace, time_s, holds_s)
    table: FloatArray = np.empty((len(time_s), 1 + len(found)))
    table[:, 0] = time_s
    for place, (_, port, values) in enumerate(found, start=1):
        table[:, place] = values if port == judging.truth else sampler.of(port, values)
    return ["time_s", *(header for header, _, _ in found)], table


def drawn_table(scenario: AnyScenario, trace: Trace, notes: Any = None) -> tuple[list[str], FloatArray]:
    """As :func:`signal_table`, for lines: NaN where a port is silent, and a row for each gap of the truth."""
    judging, holds_s = judging_of(scenario), holding_s(scenario, trace.contract)
    header, rows = table_of(judging, scenario, trace, notes, holds_s)
    truth = scenario.installed_system.truth
    place = (truth.port, truth.position) if truth else None
    position = next((header.index(name) for name, *where in judging.columns if tuple(where) == place), -1)
    after = silences(rows[:, 0], holds_s.get(judging.truth, np.inf))
    return header, np.insert(rows, after + 1, gap_after(rows[after], position), axis=0)


def _watches(judging: Judging, trace: Trace) -> list[Watch]:
    """The watches whose levels the record has."""
    return [watch for watch in judging.watches if reports(trace, watch)]


def signal_units(scenario: AnyScenario, trace: Trace, notes: Any = None) -> dict[str, str]:
    """Unit of each column of :func:`signal_table`, empty for numbers without one."""
    judging = judging_of(scenario)
    statuses = judging.status.every if judging.status else ()

    def unit(port: str, signal: str) -> str:
        return next(item.unit for item in trace.contract.port(port).signals if item.name == signal)

    return {
        "time_s": "s",
        **{header: unit(port, signal) for header, port, signal in judging.columns},
        **{note.name: note.unit for status in statuses for note in status.recorded(trace, notes)},
        **dict.fromkeys((header for header, _, _ in judging.told(trace, notes)), ""),
        **dict.fromkeys((f"{watch.name}_level" for watch in _watches(judging, trace)), ""),
        **{header: unit for header, unit, _ in judging.reckoned(scenario, trace)},
    }


def write_signals(scenario: AnyScenario, trace: Trace, path: Path, notes: Any = None) -> None:
    """Write ``signals.csv``: header with units, then one row per telegram of the truth port; unknown values are
    ``nan``."""
    header, rows = signal_table(scenario, trace, notes)
    np.savetxt(path, rows, fmt="%.10g", delimiter=",", header=",".join(header), comments="")
