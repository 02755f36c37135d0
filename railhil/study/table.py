"""Rows as Parquet files, in parts and in ``results.parquet``: one row per run, the same bytes for the same rows."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from railhil.study.plan import C, P, Study

RESULTS = "results.parquet"
#: Metadata key that identifies the part and study of a file.
_ORIGIN = b"railhil.campaign"


class NotThePart(Exception):
    """The content of a file does not match its name; the text gives the reason."""


def file_bytes(table: pa.Table, origin: str) -> bytes:
    """The table as a Parquet file with checksums; the same bytes for the same rows, in any order of collection."""
    buffer = BytesIO()
    whole = table.combine_chunks().replace_schema_metadata({_ORIGIN: origin.encode()})
    pq.write_table(whole, buffer, compression="zstd", write_page_checksum=True)
    return buffer.getvalue()


def read_table(path: Path, columns: pa.Schema) -> pa.Table:
    """A table of runs with these columns. Raises :class:`NotThePart`, OSError."""
    content = path.read_bytes()
    try:
        # Only this thread reads. `pq.read_table` leaves the content to threads of pyarrow, which give it back when they
        # come to it: at the end of the process that aborts it ("terminate called without an active exception", Arrow
        # issues 34314 and 50482).
        with pq.ParquetFile(pa.BufferReader(content), pre_buffer=False, page_checksum_verification=True) as file:
            table = file.read(use_threads=False)
    except (pa.ArrowException, OSError) as error:
        raise NotThePart("torn or damaged") from error
    if not table.schema.remove_metadata().equals(columns):
        raise NotThePart("with other columns")
    return table


def read_part(path: Path, study: Study[P, C], plan: P, chunk: C) -> pa.Table:
    """The rows of a chunk.

    :raises NotThePart: incomplete, damaged, or with other runs.
    :raises OSError: it cannot be read at all.
    """
    table = read_table(path, study.columns(plan))
    if (table.schema.metadata or {}).get(_ORIGIN, b"") != plan.origin(chunk).encode():
        raise NotThePart("of other runs")
    study.check_rows(table, plan, chunk)
    return table


def numbers(table: pa.Table, name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    """A column as float64, NaN where it is null."""
    column: np.ndarray[Any, np.dtype[np.float64]] = table[name].to_numpy(zero_copy_only=False).astype(np.float64)
    return column


def row(table: pa.Table, index: int) -> Mapping[str, Any]:
    """One run as a mapping of its columns."""
    found: Mapping[str, Any] = table.slice(index, 1).to_pylist()[0]
    return found
