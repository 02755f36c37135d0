"""The frames of a run as BLF with absolute time."""

from __future__ import annotations

from pathlib import Path

from can.io.blf import BLFWriter

from railhil.bus.frame import to_message
from railhil.report.files.content import Content


def write_blf_file(content: Content, path: Path) -> None:
    """Write the frames with time stamps that begin at the start of the run, to the microsecond.

    BLF has no place for a certificate.
    """
    start_s = content.start_ns / 1e9
    with BLFWriter(path) as writer:
        for time_ns, frame in content.record.frames():
            writer.on_message_received(to_message(frame, start_s + time_ns / 1e9))
