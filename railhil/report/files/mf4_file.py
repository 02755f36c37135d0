"""A run as MF4 (ASAM MDF 4.11) by asammdf: the frames as bus logging, and the decoded telegrams with their units."""

from __future__ import annotations

import struct
from hashlib import md5
from pathlib import Path
from typing import Any

import numpy as np
from asammdf import MDF, Signal
from asammdf.blocks import v4_constants as v4
from asammdf.blocks.source_utils import Source
from can.util import len2dlc

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.dbc import DBC
from railhil.dbc import Signal as Entry
from railhil.record.framelog import CHANNEL
from railhil.report.files.content import NO_START, Content

#: Name of the group with the columns of ``signals.csv``.
SIGNALS = "signals"
_BUS_CHANNEL = 1
#: Place of the link to the first ##FH block, and of its time, zone and flags within the block (MDF 4.11, 5.5).
_FIRST_HISTORY, _HISTORY_TIME = 64 + 24 + 8, 40
_KINDS = ("CAN_DataFrame", "CAN_RemoteFrame", "CAN_ErrorFrame")


def write_mf4(content: Content, path: Path) -> None:
    """Write one record array for the frames (and one each for remote and error frames), one group for each port, and
    one for the table of signals. The certificate is the comment of the file, the DBC is attached.
    """
    start = content.start or NO_START
    file = MDF(version="4.11")
    file.header.start_time = start
    file.header.comment = content.certificate
    _append_frames(file, content)
    _append_ports(file, content)
    header, table = content.signals
    if len(table):
        columns = [
            Signal(
                column.copy(), table[:, 0].copy(), name=name, unit=content.units[name], comment=content.comments[name]
            )
            for name, column in zip(header[1:], table.T[1:], strict=True)
        ]
        file.append(columns, acq_name=SIGNALS, comment="signals.csv")
    start_ns = file.header.abs_time
    file.save(path, overwrite=True, compression=2)
    file.close()
    _overwrite_history(path, start_ns)


def _append_frames(file: MDF, content: Content) -> None:
    frames: dict[str, list[tuple[int, Frame]]] = {kind: [] for kind in _KINDS}
    for time_ns, frame in content.record.frames():
        frames[_KINDS[2 if frame.flags & ERROR else 1 if frame.flags & REMOTE else 0]].append((time_ns, frame))
    source = Source(source_type=v4.SOURCE_BUS, bus_type=v4.BUS_TYPE_CAN, name=CHANNEL, path=CHANNEL, comment="")
    dbc = content.dbc
    for kind, found in frames.items():
        if found:
            times_s = np.array([time_ns for time_ns, _ in found], dtype=np.int64) / 1e9
            attachment = (dbc, Path(DBC), md5(dbc, usedforsecurity=False).digest())
            rows = _frame_rows(kind, [frame for _, frame in found])
            logged = Signal(rows, times_s, name=kind, source=source, attachment=attachment)
            file.append(logged, acq_name=CHANNEL, acq_source=source, comment=kind)


def _frame_rows(kind: str, frames: list[Frame]) -> np.ndarray[Any, Any]:
    """The frames as one record array, shape (n,): with (n, 1), readers find nothing (asammdf's issue 1188)."""
    width = max(8, *(len(frame.data) for frame in frames))
    columns: dict[str, Any] = {
        "BusChannel": np.full(len(frames), _BUS_CHANNEL, "<u1"),
        "ID": np.array([frame.can_id for frame in frames], "<u4"),
        "IDE": np.array([frame.flags & EXTENDED for frame in frames], "<u1"),
        "DLC": np.array([len2dlc(len(frame.data)) for frame in frames], "<u1"),
        "DataLength": np.array([len(frame.data) for frame in frames], "<u1"),
        "Dir": np.zeros(len(frames), "<u1"),
    }
    if kind != "CAN_RemoteFrame":
        padded = b"".join(frame.data.ljust(width, b"\0") for frame in frames)
        columns["DataBytes"] = np.frombuffer(padded, "u1").reshape(-1, width)
        columns["EDL"] = np.array([bool(frame.flags & FD) for frame in frames], "<u1")
        columns["BRS"] = np.array([bool(frame.flags & BRS) for frame in frames], "<u1")
        columns["ESI"] = np.zeros(len(frames), "<u1")
    names = [(f"{kind}.{name}", values.dtype, values.shape[1:]) for name, values in columns.items()]
    rows = np.zeros(len(frames), names)
    for name, values in columns.items():
        rows[f"{kind}.{name}"] = values
    return rows


def _append_ports(file: MDF, content: Content) -> None:
    for port in content.ports:
        times_s = content.trace.times_s(port.name)
        columns = [
            Signal(
                content.trace.numbers(port.name, entry.name),
                times_s,
                name=entry.name,
                unit=entry.unit,
                comment=entry.comment,
                conversion=_words(entry),
            )
            for entry in port.signals
        ]
        file.append(columns, acq_name=port.name, comment=port.comment)


def _words(entry: Entry) -> dict[str, Any] | None:
    """The value table of a signal as asammdf's conversion from values to texts; other values stay numbers."""
    if not entry.values or entry.scale != 1:
        return None
    table: dict[str, Any] = {}
    for number, (value, word) in enumerate(entry.values.items()):
        table |= {f"val_{number}": value, f"text_{number}": word.encode()}
    return table


def _overwrite_history(path: Path, start_ns: int) -> None:
    """Set the times of the file's history to the start of the run: otherwise two exports of a run would differ."""
    with path.open("r+b") as stream:
        stream.seek(_FIRST_HISTORY)
        (at,) = struct.unpack("<Q", stream.read(8))
        while at:
            stream.seek(at + 24)
            (following,) = struct.unpack("<Q", stream.read(8))
            stream.seek(at + _HISTORY_TIME)
            stream.write(struct.pack("<QhhB", start_ns, 0, 0, v4.FLAG_HD_TIME_OFFSET_VALID))
            at = following
