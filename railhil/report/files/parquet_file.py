"""The table of signals, and the telegrams, as Parquet."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from railhil.bus.ros2 import PortMessage
from railhil.record.trace import FloatArray
from railhil.report.files.content import TIME_UTC, Content

#: Column with the port of a telegram.
PORT = "port"


def write_parquet(content: Content, path: Path) -> None:
    """Write the columns of ``signals.csv`` as float64 with their units, and the facts of the run as metadata.

    Metadata of a field: ``unit`` and ``comment``; of the schema: ``railhil.scenario``, ``railhil.seed``,
    ``railhil.certificate`` etc.
    """
    header, rows = content.signals
    fields = [_field(name, pa.float64(), content.units[name], comment=content.comments[name]) for name in header]
    _write(content, path, rows[:, 0], fields, [pa.array(np.ascontiguousarray(column)) for column in rows.T])


def write_telegrams(content: Content, path: Path) -> None:
    """Write one row for each accepted telegram, in the order of the record: its time, its port, and its signals in the
    columns ``PORT.Signal``, with the types of the MCAP. The columns of other ports have no value in this row.

    Metadata of a field: ``unit``, ``comment``, and ``values``, the words of its values as JSON; of the schema as of the
    signals.
    """
    trace, ports = content.trace, content.ports
    places = [trace.order(port.name) for port in ports]
    count = sum(map(len, places))
    time_s, owner = np.zeros(count), np.full(count, -1)
    fields, columns = [_field("time_s", pa.float64(), "s")], []
    for number, (port, place) in enumerate(zip(ports, places, strict=True)):
        time_s[place], owner[place] = trace.times_s(port.name), number
        for signal, message in zip(port.signals, PortMessage(port).fields, strict=True):
            values = trace.numbers(port.name, signal.name)
            every = np.zeros(count, values.dtype)
            every[place] = values
            words = {"values": json.dumps(dict(signal.values))} if signal.values else {}
            kind = pa.type_for_alias(message.kind)
            fields.append(_field(f"{port.name}.{signal.name}", kind, signal.unit, comment=signal.comment, **words))
            columns.append(pa.array(every, kind, mask=owner != number))
    names = pa.DictionaryArray.from_arrays(owner.astype(np.int16), [port.name for port in ports])
    fields.insert(1, pa.field(PORT, names.type))
    _write(content, path, time_s, fields, [pa.array(time_s), names, *columns])


def _field(name: str, kind: Any, unit: str, **metadata: str) -> Any:
    return pa.field(name, kind, metadata={"unit": unit, **metadata})


def _write(content: Content, path: Path, time_s: FloatArray, fields: list[Any], columns: list[Any]) -> None:
    if content.start is not None:
        kind = pa.timestamp("ns", "UTC")
        fields.insert(0, pa.field(TIME_UTC, kind))
        columns.insert(0, pa.array(content.start_ns + np.rint(time_s * 1e9).astype(np.int64), kind))
    schema = pa.schema(fields, {f"railhil.{name}": text for name, text in content.facts.items()})
    pq.write_table(pa.Table.from_arrays(columns, schema=schema), path, compression="zstd")
