"""The report of runs that have just been recorded."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.common.extras import install_command

if TYPE_CHECKING:
    from railhil.judge.record import Record
    from railhil.judge.result import Result


def as_recorded(result: Result) -> Record:
    """A run that has just ended, as recorded in its folder."""
    from railhil.judge.record import Record
    from railhil.record.documents import read_certificate

    certificate = read_certificate(result.place) or {}
    record = Record(result.log, result.scenario, result.trace, result.invalid, certificate)
    return record.copy_with(score=result.score, events=result.events)


def report_line(runs: Sequence[Record], folder: Path, notes: Sequence[str] = ()) -> str:
    """Write ``report.html``; returns the line that says where, or why there is none. The record is complete without
    it."""
    from railhil.record.hash_list import REPORT

    try:
        from railhil.report.page import write_report
    except ImportError as error:
        return f"no report: {error.name} is not installed ({install_command('report')})"
    path = folder / REPORT
    try:
        write_report(runs, path, notes)
    except OSError as error:
        return f"no report: {path} cannot be written ({(error.strerror or str(error)).lower()})"
    return f"report {path}"
