"""Rows of an index by some conditions, in groups, and as a table of the terminal."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime, timedelta
from fnmatch import fnmatchcase
from typing import Any, TypeAlias

from rich.table import Table

from railhil.common.digits import count_of
from railhil.common.errors import InputError, did_you_mean
from railhil.common.output import number, table, whole
from railhil.index.find import FILE
from railhil.index.tables import STAMP, Index
from railhil.record.hash_list import HASH_LIST

Row: TypeAlias = dict[str, Any]
#: Key of the requirements of a folder in its row: verdict by id.
REQUIREMENT = "requirement"
_AGO = re.compile(r"(\d+) ?([hdw])")
_UNITS = {"h": "hours", "d": "days", "w": "weeks"}
#: Before a date that is only that of a file.
_ABOUT = "~"
#: Folders that a sentence names.
_NAMED_MAX = 6


def all_rows(index: Index) -> list[Row]:
    """A row for each folder, in the order of the instants: its columns, for a run also its facts and scores, and
    whether it is new in the index."""
    found = {row["folder"]: row for row in index.tables["folders"].drop_columns([STAMP]).to_pylist()}
    for row in found.values():
        row |= {REQUIREMENT: {}, "is_new": row["folder"] in index.new}
    for run in index.tables["runs"].to_pylist():
        found[run["folder"]] |= run
    for one in index.tables["requirements"].to_pylist():
        found[one["folder"]][REQUIREMENT][one["id"]] = one["verdict"]
    return sorted(found.values(), key=lambda row: (row["made"], row["folder"]))


def keys(index: Index) -> list[str]:
    """Names that conditions, groups and orders may have."""
    names = (*index.tables["folders"].column_names, *index.tables["runs"].column_names, REQUIREMENT, "is_new")
    return [name for name in dict.fromkeys(names) if name != STAMP]


def check_key(index: Index, option: str, key: str) -> None:
    """Refuse a name that no row has. Raises InputError."""
    known = keys(index)
    if key not in known:
        raise InputError("command line", option, key, ", ".join(known), did_you_mean(key, known))


def instant(text: str, now: datetime) -> datetime:
    """A day or an instant (UTC) in ISO 8601, or ``3d``, ``12h``, ``2w`` ago.

    :raises ValueError: it is none of these.
    """
    if ago := _AGO.fullmatch(text):
        return now - timedelta(**{_UNITS[ago[2]]: int(ago[1])})
    found = datetime.fromisoformat(text)
    return found if found.tzinfo else found.replace(tzinfo=UTC)


def chosen(rows: Iterable[Row], where: Iterable[tuple[str, str]], since: datetime | None = None) -> list[Row]:
    """The rows that fulfil all conditions.

    :param where: keys, each with a pattern of its value, with ``*`` and ``?``.
    """
    conditions = list(where)
    return [
        row
        for row in rows
        if (since is None or row["made"] >= since)
        and all(any(fnmatchcase(one, pattern) for one in _texts(row.get(key))) for key, pattern in conditions)
    ]


def _texts(value: Any) -> list[str]:
    """The texts of a value that a pattern may match: of a list those of its items."""
    if isinstance(value, list | dict):
        return [str(one) for one in value] or [""]
    return ["" if value is None else str(value).lower() if isinstance(value, bool) else str(value)]


def in_order(rows: Sequence[Row], key: str) -> list[Row]:
    """The rows by the values of a key; those without one come first."""
    values = {id(row): row.get(key) for row in rows}
    is_number = all(isinstance(one, int | float) or one is None for one in values.values())
    return sorted(
        rows,
        key=lambda row: (
            (value := values[id(row)]) is not None,
            (value or 0) if is_number else ", ".join(_texts(value)),
        ),
    )


def groups(rows: Iterable[Row], key: str) -> list[Row]:
    """A row for each value of a key: number of folders, of each verdict, and the newest instant.

    A folder counts in each of its requirements, with the verdict of this requirement.
    """
    found: dict[str, Row] = {}
    for row in rows:
        verdicts: Row = row[key] if key == REQUIREMENT else dict.fromkeys(_texts(row.get(key)), row["verdict"])
        for text, verdict in verdicts.items():
            group = found.setdefault(text, {key: text, "folders": 0, "verdicts": {}, "newest": row["made"]})
            group["folders"] += 1
            group["newest"] = max(group["newest"], row["made"])
            if verdict:
                group["verdicts"][verdict] = group["verdicts"].get(verdict, 0) + 1
    return sorted(found.values(), key=lambda group: str(group[key]))


def as_json(row: Row) -> Row:
    """The row for a JSON document: without values that its folder does not have."""
    return {
        key: value.isoformat() if isinstance(value, datetime) else value
        for key, value in row.items()
        if value is not None and value != {}
    }


def _minute(made: datetime, dated_by: str = "") -> str:
    return f"{_ABOUT if dated_by == FILE else ''}{made:%Y-%m-%d %H:%M}"


def doubts(rows: Sequence[Row]) -> list[str]:
    """Sentences on what the index cannot vouch for in these rows."""
    dated = [row["folder"] for row in rows if row["dated_by"] == FILE]
    unlisted = [row["folder"] for row in rows if not row["is_listed"] and not row["problem"]]
    return [
        f"{said}: {', '.join(found[:_NAMED_MAX])}{' ...' if len(found) > _NAMED_MAX else ''}"
        for found, said in (
            (
                dated,
                f"{_ABOUT} date of a file, which a copy may change, in {count_of(len(dated), 'folder')}",
            ),
            (unlisted, f"{count_of(len(unlisted), 'folder')} without {HASH_LIST}, checked against nothing"),
        )
        if found
    ]


def rows_table(rows: Iterable[Row]) -> Table:
    """The rows for a terminal."""
    heads = (whole("made (UTC)"), "folder", "kind", "scenario", "law", number("seed"), whole("verdict"), "")
    made = table(*heads, tight=True)
    for row in rows:
        style = "red" if row["problem"] else None
        cells = [row[key] for key in ("folder", "kind", "scenario", "law", "seed", "verdict")]
        shown = ["" if cell is None else str(cell) for cell in cells]
        made.add_row(_minute(row["made"], row["dated_by"]), *shown, row["problem"] or row["line"], style=style)
    return made


def groups_table(found: Sequence[Row], key: str) -> Table:
    """The groups for a terminal."""
    verdicts = list(dict.fromkeys(verdict for group in found for verdict in group["verdicts"]))
    made = table(key, *map(number, ("folders", *verdicts)), "newest (UTC)")
    for group in found:
        counts = (str(group["verdicts"].get(verdict, 0)) for verdict in verdicts)
        made.add_row(str(group[key]) or "-", str(group["folders"]), *counts, _minute(group["newest"]))
    return made
