"""All rows as tables of pyarrow, kept beside the folders and made again where a folder has changed."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any, Final

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from railhil.common.user_files import whole_file
from railhil.index.find import INDEX, Found, find_folders
from railhil.index.rows import EVENT, FACTS, FAULT, LISTS, REACTION, REQUIREMENT, Rows, foreign_rows, rows_of

#: Column of the table ``folders``, not shown: what the folder was when it was read.
STAMP: Final = "stamp"
_KINDS: Mapping[type, pa.DataType] = {str: pa.string(), float: pa.float64(), int: pa.int64()}
_MADE = pa.field("made", pa.timestamp("ms", tz="UTC"))
_NUMBERS = {"seed": pa.int64(), "run_number": pa.int64(), "frames": pa.int64(), "perturbed": pa.bool_()}
_COMMON = ("scenario", "system", "law", "seed", "version", "verdict", "line")
_TEXTS = ("host", "operator", "command", "parameters", "memory_sha256", "why", "ended")


def _schema(names: Iterable[str], **others: pa.DataType) -> list[pa.Field]:
    return [pa.field(name, _NUMBERS.get(name, pa.string())) for name in names] + [
        pa.field(name, kind) for name, kind in others.items()
    ]


def _typed(columns: Mapping[str, type]) -> list[pa.Field]:
    return [pa.field(name, _KINDS[kind]) for name, kind in columns.items()]


_FOLDER = pa.field("folder", pa.string())
#: Columns of each table. ``runs`` has each score of the runs, too, and ``signed_`` before those with a sign.
SCHEMAS: Final[Mapping[str, pa.Schema]] = {
    "folders": pa.schema(
        [_FOLDER, pa.field("kind", pa.string()), _MADE, pa.field("dated_by", pa.string()), *_schema(_COMMON),
         pa.field("problem", pa.string()), pa.field("is_listed", pa.bool_()), pa.field("is_signed", pa.bool_()),
         pa.field("has_report", pa.bool_()), pa.field(STAMP, pa.string())]
    ),
    "runs": pa.schema(
        [_FOLDER, _MADE, *_schema((*_COMMON, *(name for name in FACTS if name != "seed"), *_TEXTS)),
         *(pa.field(name, pa.list_(pa.string())) for name in LISTS),
         *(pa.field(name, pa.float64()) for name in ("sim_time_s", "wall_time_s", "speed_factor"))]
    ),
    "requirements": pa.schema([_FOLDER, *_typed(REQUIREMENT)]),
    "faults": pa.schema([_FOLDER, *_typed(FAULT)]),
    "events": pa.schema([_FOLDER, *_typed(EVENT)]),
    "reactions": pa.schema([_FOLDER, *_typed(REACTION), pa.field("failures", pa.string())]),
    "figures": pa.schema(
        [_FOLDER, *_schema(("law", "score", "unit", "figure"), value=pa.float64(), runs=pa.int64())]
    ),
}  # fmt: skip
#: What rows mean beside their columns: another number when they are read in another way.
_READING = 4
_FORMAT = sha256(f"{_READING} {[str(one) for one in SCHEMAS.values()]}".encode()).digest()


@dataclass
class Index:
    """The tables of the folders below ``root``.

    ``new``: folders that were read now. ``remarks``: directories that cannot be read, and why the index was not kept.
    """

    root: Path
    tables: dict[str, pa.Table]
    new: frozenset[str] = frozenset()
    remarks: list[str] = field(default_factory=list)

    @property
    def score_keys(self) -> list[str]:
        """Names of the scores in the table ``runs``, without those with a sign."""
        fixed = {*SCHEMAS["runs"].names}
        return [
            name for name in self.tables["runs"].column_names if name not in fixed and not name.startswith("signed_")
        ]


def open_index(
    root: Path, again: bool = False, progress: Callable[[int, int], None] = lambda done, total: None
) -> Index:
    """The index of a directory, brought up to date.

    :param again: read every folder again.
    :param progress: called with the number of folders read and of those to read.
    :raises InputError: there is no such directory.
    """
    found, remarks = find_folders(root)
    kept = {} if again else _read(root)
    stamps = dict(zip(*(kept["folders"][name].to_pylist() for name in ("folder", STAMP)), strict=True)) if kept else {}
    changed = [one for one in found if stamps.get(one.folder) != one.stamp]
    same = [one.folder for one in found if stamps.get(one.folder) == one.stamp]
    read: list[tuple[Found, Rows]] = []
    for done, one in enumerate(changed):
        progress(done, len(changed))
        rows = rows_of(root, one)
        if (root / one.folder).is_dir():
            read.append((one, rows))
        else:
            remarks.append(f"{root / one.folder} is left out: it was removed while it was read")
    if kept and not changed and len(same) == len(stamps):
        # Making a table, even an empty one, would load pandas.
        return Index(root, kept, remarks=remarks)
    tables = {name: _joined(kept.get(name), made, same) for name, made in _tables(read).items()}
    index = Index(root, tables, frozenset(one.folder for one in changed), remarks)
    _write(index)
    return index


#: Errors of rows whose values are not of their columns: a text for a number, a number of too many digits.
_UNFIT = (pa.ArrowException, OverflowError, TypeError, ValueError)


def _tables(read: Sequence[tuple[Found, Rows]]) -> dict[str, pa.Table]:
    """The rows of all folders by table; of a folder whose rows do not fit a row that says so."""
    rows: Rows = {name: [] for name in SCHEMAS}
    for one, found in read:
        for name, more in found.items():
            rows[name] += more
        rows["folders"][-1][STAMP] = one.stamp
    try:
        return {name: _table(rows[name], schema) for name, schema in SCHEMAS.items()}
    except _UNFIT:
        return _tables([(one, found if _fits(found) else foreign_rows(one)) for one, found in read])


def _fits(found: Rows) -> bool:
    try:
        for name, more in found.items():
            _table(more, SCHEMAS[name])
    except _UNFIT:
        return False
    return True


def _table(rows: Sequence[Mapping[str, Any]], schema: pa.Schema) -> pa.Table:
    """:param rows: numbers under other keys than those of the schema are columns, too."""
    more = dict.fromkeys(key for row in rows for key in row if key not in schema.names)
    return pa.Table.from_pylist(list(rows), pa.schema([*schema, *(pa.field(name, pa.float64()) for name in more)]))


def _joined(kept: pa.Table | None, made: pa.Table, same: Sequence[str]) -> pa.Table:
    """The rows of the folders that are as they were, and the new ones, in the order of the folders."""
    if kept is not None:
        kept = kept.filter(pc.is_in(kept["folder"], pa.array(same, pa.string())))
        made = pa.concat_tables([kept.replace_schema_metadata(), made], promote_options="default")
    return made.take(pc.sort_indices(made, [("folder", "ascending")]))


def read_parquet(path: Path) -> pa.Table:
    """A table that was kept. ``pq.read_table`` would load pandas, half a second.

    :raises OSError: there is none. :raises pa.ArrowException: it is damaged.
    """
    with pq.ParquetFile(path, page_checksum_verification=True) as file:
        return file.read()


def _read(root: Path) -> dict[str, pa.Table]:
    """The tables that were kept; none if one is missing, damaged, or of another format or time than the others."""
    found: dict[str, pa.Table] = {}
    try:
        for name in SCHEMAS:
            found[name] = read_parquet(root / INDEX / f"{name}.parquet")
    except (OSError, pa.ArrowException):
        return {}
    marks = {tuple(sorted((one.schema.metadata or {}).items())) for one in found.values()}
    has_columns = all({*SCHEMAS[name].names} <= {*one.column_names} for name, one in found.items())
    is_whole = has_columns and len(marks) == 1 and dict(next(iter(marks))).get(b"format") == _FORMAT
    return found if is_whole else {}


def _write(index: Index) -> None:
    """Keep the tables. A directory that cannot be written has no index: it is made again each time."""
    folder = index.root / INDEX
    # Tables of two processes that write at once do not go together.
    stamps = "\n".join(index.tables["folders"][STAMP].to_pylist())
    mark = {b"format": _FORMAT, b"folders": sha256(stamps.encode()).digest()}
    try:
        folder.mkdir(exist_ok=True)
        for name, table in index.tables.items():
            with whole_file(folder / f"{name}.parquet") as draft:
                pq.write_table(table.replace_schema_metadata(mark), draft, compression="zstd", write_page_checksum=True)
    except OSError as error:
        shutil.rmtree(folder, ignore_errors=True)
        index.remarks.append(f"the index is not kept: {folder} cannot be written ({error.strerror})")
