"""A few points of the speed of each run, kept with the index.

The points are rows of ``signals.csv``: every 2**k-th one. Runs of one system have points at the same instants, so that
their difference is one of recorded values.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import pyarrow as pa
import pyarrow.csv as pc
import pyarrow.parquet as pq

from railhil.common.errors import InputError
from railhil.common.user_files import whole_file
from railhil.index.find import INDEX
from railhil.index.tables import read_parquet
from railhil.report.display_columns import ShownColumn, shown_columns
from railhil.scenarios.scenario_documents import SCENARIO, read_scenario

_FILE: Final = "curves.parquet"
_SIGNALS: Final = "signals.csv"
#: Largest number of points of a curve.
POINTS_MAX: Final = 300
_NUMBERS = pa.list_(pa.float64())
_SCHEMA = pa.schema([("folder", pa.string()), ("stamp", pa.string()), ("time_s", _NUMBERS), ("speed", _NUMBERS)])


def speed_columns(root: Path, folders: Mapping[str, Sequence[str]]) -> dict[str, ShownColumn]:
    """The column of the speed by system; without those that are not installed or have none.

    :param folders: run folders of each system; one whose scenario can be read is enough.
    """
    found: dict[str, ShownColumn] = {}
    for system, own in folders.items():
        for folder in own[:3]:
            try:
                shown = shown_columns(read_scenario(root / folder / SCENARIO))
            except InputError:
                # The system is not installed, or this folder is damaged: the next one may do.
                continue
            if column := shown.named(shown.speed):
                found[system] = column
            break
    return found


def curves(root: Path, asked: Iterable[tuple[str, str]]) -> dict[str, tuple[list[float], list[float]]]:
    """Instants (s) and speeds (unit of ``signals.csv``) of runs by folder; without those that have no such file.

    :param asked: folder, and name of its column.
    """
    kept = _read(root)
    found = {}
    for folder, column in asked:
        try:
            file = (root / folder / _SIGNALS).stat()
        except OSError:
            # A run that was INVALID before its first row has none.
            continue
        stamp = f"{column}:{file.st_mtime_ns}:{file.st_size}"
        known = kept.get(folder)
        row = known if known is not None and known["stamp"] == stamp else _points(root, folder, column, stamp)
        if row is not None:
            found[folder] = row
    _write(root, [*found.values()])
    return {folder: (row["time_s"], row["speed"]) for folder, row in found.items()}


def _points(root: Path, folder: str, column: str, stamp: str) -> dict[str, Any] | None:
    try:
        table = pc.read_csv(
            root / folder / _SIGNALS, convert_options=pc.ConvertOptions(include_columns=["time_s", column])
        )
    except (OSError, pa.ArrowException, KeyError):
        return None
    step = 1
    while table.num_rows / step > POINTS_MAX:
        step *= 2
    time_s, speed = (table[name].cast(pa.float64()).to_pylist()[::step] for name in ("time_s", column))
    return {"folder": folder, "stamp": stamp, "time_s": time_s, "speed": speed}


def _read(root: Path) -> dict[str, dict[str, Any]]:
    try:
        return {row["folder"]: row for row in read_parquet(root / INDEX / _FILE).cast(_SCHEMA).to_pylist()}
    except (OSError, ValueError, pa.ArrowException):
        return {}


def _write(root: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    try:
        with whole_file(root / INDEX / _FILE) as draft:
            table = pa.Table.from_pylist(list(rows), _SCHEMA)
            pq.write_table(table, draft, compression="zstd", write_page_checksum=True)
    except OSError:
        # As the index itself, which has said so.
        return
