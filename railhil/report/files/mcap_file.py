"""The telegrams and signals of a run as MCAP: ROS 2 messages in CDR, a topic per port."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from mcap.writer import CompressionType, Writer

from railhil.bus.ros2 import MESSAGE_ENCODING, SCHEMA_ENCODING, SIGNALS_TOPIC, Field, Message, PortMessage, ros_name
from railhil.common.version import full_version
from railhil.dbc import DBC
from railhil.report.files.content import Content

#: Beginning of the topics of the ports, such as ``/telegrams/trn_speed``.
TELEGRAMS = "/telegrams"
#: Name of the metadata record with the facts of the run.
METADATA = "railhil"


def write_mcap(content: Content, path: Path) -> None:
    """Write every accepted telegram at its instant and every row of ``signals.csv``, in the order of time.

    The DBC is an attachment. The messages' times are ns since the start, which is 1970 if the run has none.
    """
    start_ns = content.start_ns
    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD)
        writer.start(library=f"railhil {full_version()}")
        writer.add_metadata(METADATA, content.facts)
        writer.add_attachment(start_ns, start_ns, DBC, "text/plain", content.dbc)
        topics = list(_topics(content))
        channels = [
            writer.register_channel(topic, MESSAGE_ENCODING, _schema(writer, kind)) for topic, kind, *_ in topics
        ]
        payloads = [rows.tobytes() for _, _, rows, *_ in topics]
        every = [
            zip(times_ns.tolist(), order.tolist(), [at] * len(order), range(len(order)), strict=True)
            for at, (*_, times_ns, order) in enumerate(topics)
        ]
        for time_ns, _, at, number in sorted(chain.from_iterable(every)):
            size = topics[at][1].size
            stamp_ns = start_ns + time_ns
            data = payloads[at][number * size : (number + 1) * size]
            writer.add_message(channels[at], stamp_ns, data, stamp_ns, number)
        writer.finish()  # type: ignore[no-untyped-call]


def _schema(writer: Writer, kind: Message) -> int:
    return int(writer.register_schema(kind.name, SCHEMA_ENCODING, kind.schema.encode()))


_Topic = tuple[str, Message, npt.NDArray[np.void], npt.NDArray[np.int64], npt.NDArray[np.int64]]


def _topics(content: Content) -> Iterator[_Topic]:
    """Topic, message, payloads, instants in ns and places in the order of the record, shape (n,) each."""
    trace = content.trace
    for port in content.ports:
        kind = PortMessage(port)
        rows = _blank(kind, trace.count(port.name))
        for field, signal in zip(kind.fields, port.signals, strict=True):
            rows[field.name] = trace.numbers(port.name, signal.name)
        times_ns = np.array(trace.times_ns(port.name), dtype=np.int64)
        yield f"{TELEGRAMS}/{ros_name(port.name)}", kind, rows, times_ns, trace.order(port.name)
    header, table = content.signals
    if len(table):
        units = content.units
        kind_of_table = Message("Signals", [Field(ros_name(name), "float64", f"[{units[name]}]") for name in header])
        rows = _blank(kind_of_table, len(table))
        for field, column in zip(kind_of_table.fields, table.T, strict=True):
            rows[field.name] = column
        # Rows come after the telegrams of their instant.
        last = np.full(len(table), np.iinfo(np.int64).max)
        yield SIGNALS_TOPIC, kind_of_table, rows, np.rint(table[:, 0] * 1e9).astype(np.int64), last


def _blank(kind: Message, count: int) -> npt.NDArray[np.void]:
    """Payloads with header and zeros, shape (count,)."""
    layout: Any = kind.columns
    rows: npt.NDArray[np.void] = np.frombuffer(bytearray(kind.blank * count), np.dtype(layout).newbyteorder("<"))
    return rows
