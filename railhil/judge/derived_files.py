"""Checks whether the files of a run folder that were derived from its log still agree with it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory

from railhil.judge.events.event import EVENTS, write_events
from railhil.judge.record import Record
from railhil.judge.signals import write_signals
from railhil.record.blf_reader import read_blf
from railhil.record.blf_writer import start_ns, write_blf
from railhil.record.difference import first_difference
from railhil.record.framelog import read_log

#: Names in a run folder.
BLF, SIGNALS = "frames.blf", "signals.csv"
#: Computed columns may differ in their last digit between two mathematical libraries.
_SAME = 1e-8


def blf_difference(record: Record) -> str:
    """The first frame in which ``frames.blf`` differs from the log beside it; empty: no difference, or no such file.

    :raises InputError: it is no BLF.
    """
    path = record.log.with_name(BLF)
    if not path.is_file():
        return ""
    with TemporaryDirectory(prefix="railhil-") as private:
        again = Path(private) / BLF
        write_blf(record.log, again)
        if again.read_bytes() == path.read_bytes():
            return ""
    # Another library may have compressed the same frames.
    first = start_ns(next(read_log(record.log))[0])
    logged = ((time_ns - first, frame) for time_ns, frame in read_log(record.log))
    found = first_difference(logged, read_blf(path), record.trace.contract, record.trace.contract)
    return "" if found is None else f"{BLF}: other frames than {record.log.name}: {found.sentence}"


def signals_difference(record: Record) -> str:
    """The first value in which ``signals.csv`` differs from the log; empty: no difference, or no such file.

    The file was made by the code of the record, and other code may give other values.
    """
    path = record.log.with_name(SIGNALS)
    if not path.is_file():
        return ""
    with TemporaryDirectory(prefix="railhil-") as private:
        again = Path(private) / SIGNALS
        write_signals(record.scenario, record.trace, again, record.certificate.get("notes"))
        if again.read_bytes() == path.read_bytes():
            return ""
        return next(_other_values(path, again, record.log.name), "")


def events_difference(record: Record) -> str:
    """The first value in which ``events.csv`` differs from the log and the faults of the certificate; empty: no
    difference, or no such file.

    The file was made by the code of the record, and other code may give other events.
    """
    path = record.log.with_name(EVENTS)
    if not path.is_file():
        return ""
    with TemporaryDirectory(prefix="railhil-") as private:
        again = Path(private) / EVENTS
        write_events(record.events, again)
        if again.read_bytes() == path.read_bytes():
            return ""
        return next(_other_values(path, again, record.log.name), "")


def _other_values(path: Path, again: Path, log: str) -> Iterator[str]:
    with path.open(encoding="utf-8", errors="replace") as old, again.open(encoding="utf-8") as new:
        header: list[str] = []
        for number, (was, now) in enumerate(zip_longest(old, new, fillvalue=""), 1):
            cells, wanted = was.rstrip("\n").split(","), now.rstrip("\n").split(",")
            header = header or wanted
            if len(cells) != len(wanted):
                yield f"{path.name}: line {number}: {len(cells)} values, {len(wanted)} from {log}"
            for name, found, given in zip(header, cells, wanted, strict=False):
                if not _is_same(found, given):
                    yield f"{path.name}: line {number}, {name}: {found or 'nothing'}, {given or 'nothing'} from {log}"


def _is_same(found: str, given: str) -> bool:
    try:
        return found == given or math.isclose(float(found), float(given), rel_tol=_SAME, abs_tol=_SAME)
    except ValueError:
        return False
