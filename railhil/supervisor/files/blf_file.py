"""The frames of a run as BLF with absolute time."""

from __future__ import annotations

from pathlib import Path

from railhil.supervisor.files.content import Content
from railhil.supervisor.framelog import write_blf


def write_blf_file(content: Content, path: Path) -> None:
    """Write the frames with time stamps that begin at the start of the run, to the microsecond.

    BLF has no place for a certificate.
    """
    write_blf(content.record.log, path, content.start_ns / 1e9)
