"""The frames of a run in Vector's formats, BLF and ASC, written by python-can."""

from __future__ import annotations

from pathlib import Path

from can.io import ASCWriter, BLFWriter

from railhil.bus.frame import to_message
from railhil.report.files.content import NO_START, Content


def write_blf_file(content: Content, path: Path) -> None:
    """Write the frames with time stamps that begin at the start of the run, to the microsecond.

    BLF has no place for a certificate.
    """
    start_s = content.start_ns / 1e9
    with BLFWriter(path) as writer:
        for time_ns, frame in content.record.frames():
            writer.on_message_received(to_message(frame, start_s + time_ns / 1e9))


def write_asc(content: Content, path: Path) -> None:
    """Write the frames with the times of the run, in s since its start, which is the date of the file, in UTC.

    Comments name scenario, controller, seed, verdict and hash. ASC has no place for the data of an error frame.
    """
    start = content.start or NO_START
    # Vector's tools want three digits behind the point.
    date = f"{start:%a %b %d %H:%M:%S}.{start.microsecond // 1000:03d} {start:%Y}"
    facts = [f"// railhil {name}: {text}\n" for name, text in content.facts.items() if name != "certificate"]
    with path.open("w", encoding="utf-8", newline="\n") as stream, ASCWriter(stream) as writer:
        # The writer's own head has the time of now, and its times begin with the first frame.
        stream.seek(0)
        stream.truncate()
        stream.write(f"date {date}\nbase hex  timestamps absolute\ninternal events logged\n")
        stream.writelines([*facts, f"Begin Triggerblock {date}\n"])
        writer.header_written = True
        writer.log_event("Start of measurement", 0.0)
        for time_ns, frame in content.record.frames():
            writer.on_message_received(to_message(frame, time_ns / 1e9))
