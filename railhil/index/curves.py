"""A few points of the signals of a run, for the page of an index.

The points are rows of ``signals.csv``: every 2**k-th one. Runs of one system have points at the same instants, so that
their difference is one of recorded values.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import pyarrow as pa
import pyarrow.csv as pc

from railhil.common.errors import InputError
from railhil.record.documents import read_certificate
from railhil.report.display_columns import Shown, ShownColumn, shown_columns
from railhil.scenarios.scenario_documents import SCENARIO, read_scenario

_SIGNALS: Final = "signals.csv"
#: Largest number of points of a curve.
POINTS_MAX: Final = 300


def shown_signals(folder: Path) -> Shown | None:
    """The columns of a run; None: its system is not installed, or a file is damaged."""
    try:
        notes = (read_certificate(folder) or {}).get("notes")
        return shown_columns(read_scenario(folder / SCENARIO), notes=notes)
    except InputError:
        return None


def speed_columns(root: Path, folders: Mapping[str, Sequence[str]]) -> dict[str, ShownColumn]:
    """The column of the speed by system; without those that are not installed or have none.

    :param folders: run folders of each system; one whose scenario can be read is enough.
    """
    found: dict[str, ShownColumn] = {}
    for system, own in folders.items():
        shown = next((shown for folder in own[:3] if (shown := shown_signals(root / folder))), None)
        if column := shown and shown.named(shown.speed):
            found[system] = column
    return found


def curves(folder: Path, columns: Iterable[ShownColumn]) -> dict[str, Any] | None:
    """Points of a run: ``time_s``, and ``columns``: label, unit, factor and values by name, a value that is not known
    is None.

    None: the run has no such file or columns, as one that was INVALID before its first row.
    """
    told = {one.name: [one.label, one.unit, one.factor] for one in columns}
    names = ["time_s", *told]
    try:
        table = pc.read_csv(folder / _SIGNALS, convert_options=pc.ConvertOptions(include_columns=names))
        step = 1
        while table.num_rows / step > POINTS_MAX:
            step *= 2
        rows = {name: table[name].cast(pa.float64()).to_pylist()[::step] for name in names}
    except (OSError, pa.ArrowException, KeyError):
        return None
    values = {name: [None if one is None or one != one else one for one in own] for name, own in rows.items()}
    return {"time_s": values["time_s"], "columns": {name: [*one, values[name]] for name, one in told.items()}}


def all_curves(folder: Path) -> dict[str, Any] | None:
    """:func:`curves` of all columns of a run."""
    shown = shown_signals(folder)
    return None if shown is None else curves(folder, shown.columns)
