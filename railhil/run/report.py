"""The report of runs that have just been recorded."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.common.errors import describe_os_error
from railhil.common.extras import missing_library

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
    """Write ``report.html`` of some runs; returns the line of :func:`say_report`."""

    def write(path: Path) -> None:
        from railhil.report.page import write_report

        write_report(runs, path, notes)

    return say_report(folder, write)


def say_report(folder: Path, write: Callable[[Path], None]) -> str:
    """Write ``report.html``; returns the line with its path, or with the reason why there is none. The record is
    complete without it.

    :param write: writes the file. It imports what needs the extra ``report`` itself.
    """
    from railhil.record.hash_list import REPORT

    path = folder / REPORT
    try:
        write(path)
    except ImportError as error:
        return str(missing_library("no report", error, "report"))
    except OSError as error:
        return f"no report: {path} cannot be written ({describe_os_error(error)})"
    return f"report {path}"
