"""SQL over the tables of an index, by DuckDB. Statements see these tables and nothing else of the machine."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import duckdb
import pyarrow as pa

from railhil.common.errors import InputError, Words
from railhil.index.tables import STAMP, Index


def answer(index: Index, statement: str) -> pa.Table:
    """The rows of a statement.

    :raises InputError: it is no statement that these tables answer.
    """
    connection: Any = duckdb.connect(":memory:")
    try:
        for name, table in index.tables.items():
            shown = table.drop_columns([STAMP]) if STAMP in table.column_names else table
            connection.register(name, shown)
        # Neither files nor the network nor variables of Python, and a statement cannot allow them again.
        connection.execute(
            "SET enable_external_access = false; SET python_enable_replacements = false; SET lock_configuration = true"
        )
        found = connection.sql(statement)
        if found is None:
            raise InputError("railhil query", "SQL", statement, "a statement that has rows, as select")
        rows = found.to_arrow_table()
        # The rows are read by the names of their columns.
        return rows.rename_columns(_distinct(rows.column_names))
    except duckdb.Error as error:
        said = str(error).splitlines()[0]
        allowed = f"a statement over {', '.join(index.tables)}"
        raise InputError("railhil query", "SQL", Words(said), allowed) from None
    finally:
        connection.close()


def _distinct(names: Sequence[str]) -> list[str]:
    """The names, with a number behind those that were there before."""
    found: list[str] = []
    for name in names:
        serial = 1
        while (said := name if serial == 1 else f"{name}_{serial}") in found:
            serial += 1
        found.append(said)
    return found


def rows_of(answered: pa.Table) -> list[dict[str, Any]]:
    """The rows as values of Python.

    :raises InputError: Python has no such value, as an instant after the year 9999.
    """
    try:
        rows: list[dict[str, Any]] = answered.to_pylist()
        return rows
    except (ValueError, OverflowError) as error:
        raise InputError("railhil query", "SQL", Words(str(error)), "values within the years 1 to 9999") from None
