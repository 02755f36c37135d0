"""The ``[[requirement]]`` of scenario files: a list in a file, by their ids while files are merged."""

from __future__ import annotations

from typing import Any

#: Keys of the sentences that judge the runs.
SENTENCES = ("requirement", "define")


def name_rows(table: dict[str, Any]) -> None:
    """Make the rows of ``requirement`` tables by their ids, which are then merged like others; wrong rows stay."""
    rows = table.get("requirement")
    if isinstance(rows, list) and all(isinstance(row, dict) and isinstance(row.get("id"), str) for row in rows):
        named = {row["id"]: {key: value for key, value in row.items() if key != "id"} for row in rows}
        if len(named) == len(rows):
            table["requirement"] = named


def list_rows(table: dict[str, Any]) -> None:
    """The reverse of :func:`name_rows`."""
    if isinstance(named := table.get("requirement"), dict):
        table["requirement"] = [{"id": name, **row} if isinstance(row, dict) else row for name, row in named.items()]
