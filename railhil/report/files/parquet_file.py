"""The table of signals as Parquet."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from railhil.report.files.content import TIME_UTC, Content


def write_parquet(content: Content, path: Path) -> None:
    """Write the columns of ``signals.csv`` as float64 with their units, and the facts of the run as metadata.

    Metadata of a field: ``unit``; of the schema: ``railhil.scenario``, ``railhil.seed``, ``railhil.certificate`` etc.
    """
    header, rows = content.signals
    fields = [pa.field(name, pa.float64(), metadata={"unit": content.units[name]}) for name in header]
    columns = [pa.array(np.ascontiguousarray(column)) for column in rows.T]
    if content.start is not None:
        times_ns = content.start_ns + np.rint(rows[:, 0] * 1e9).astype(np.int64)
        kind = pa.timestamp("ns", "UTC")
        fields.insert(0, pa.field(TIME_UTC, kind))
        columns.insert(0, pa.array(times_ns, kind))
    schema = pa.schema(fields, {f"railhil.{name}": text for name, text in content.facts.items()})
    pq.write_table(pa.Table.from_arrays(columns, schema=schema), path, compression="zstd")
