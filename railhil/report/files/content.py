"""Content of a run folder for the exporters."""

from __future__ import annotations

import json
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import cached_property

from railhil.common.errors import InputError
from railhil.common.streams import escape_controls
from railhil.dbc import Port
from railhil.dbc.text import dbc_text
from railhil.judge.record import Record
from railhil.judge.signals import signal_table, signal_units
from railhil.record.trace import FloatArray, Trace
from railhil.report.display_columns import Shown, shown_columns

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
#: Years that BLF (none before 1990 in python-can) and 64-bit nanoseconds can express.
_START_MIN, _START_MAX = datetime(1990, 1, 2, tzinfo=UTC), datetime(2262, 1, 1, tzinfo=UTC)
_ALLOWED = "date and time with its zone, 1990 to 2262, like 2026-11-22T18:42:55Z"
#: Time 0 of a run without a start in files that must have one.
NO_START = datetime(2000, 1, 1, tzinfo=UTC)
#: Column of the tables with the absolute time, if the run has a start.
TIME_UTC = "time_utc"


@dataclass(frozen=True)
class Content:
    """A record with its certificate, and the instant in UTC at which its time 0 is set (None: it is not)."""

    record: Record
    start: datetime | None = None

    @property
    def trace(self) -> Trace:
        """The telegrams of the record."""
        return self.record.trace

    @property
    def start_ns(self) -> int:
        """Time 0 in ns since 1970; 0 without a start."""
        return 0 if self.start is None else (self.start - _EPOCH) // timedelta(microseconds=1) * 1000

    @cached_property
    def ports(self) -> tuple[Port, ...]:
        """The ports with telegrams in the record."""
        return tuple(port for port in self.trace.contract.ports if self.trace.count(port.name))

    @cached_property
    def signals(self) -> tuple[list[str], FloatArray]:
        """Header and rows of ``signals.csv``, which has no rows in a record without truth."""
        return signal_table(self.record.scenario, self.trace, self.record.certificate.get("notes"))

    @cached_property
    def units(self) -> dict[str, str]:
        """Unit of each column of :attr:`signals`, empty for numbers without one."""
        return signal_units(self.record.scenario, self.trace, self.record.certificate.get("notes"))

    @cached_property
    def shown(self) -> Shown:
        """How the columns of :attr:`signals` are shown."""
        return shown_columns(self.record.scenario, self.trace.contract, self.record.certificate.get("notes"))

    @cached_property
    def comments(self) -> dict[str, str]:
        """Comment of each column of :attr:`signals`: the name for readers, and the comment of the port table."""
        comments = {"time_s": "time since the start", **{column.name: column.label for column in self.shown.columns}}
        for name, port, signal in self.record.judging.columns:
            comment = self.trace.contract.port(port).signal(signal).comment
            if not comment.lower().startswith(comments[name]):
                comments[name] += f": {comment}" if comment else ""
            else:
                comments[name] = comment
        return comments

    @cached_property
    def certificate(self) -> str:
        """The certificate as one line of JSON."""
        return json.dumps(self.record.certificate, ensure_ascii=False, separators=(",", ":"))

    @property
    def facts(self) -> dict[str, str]:
        """The certificate, and its most requested parts, as texts."""
        document = self.record.certificate
        facts = {
            name: escape_controls(str(document.get(name)))
            for name in ("scenario", "controller", "seed", "verdict", "frames_sha256")
        }
        if self.start is not None:
            facts["start"] = self.start.isoformat()
        return {**facts, "certificate": self.certificate}

    @property
    def dbc(self) -> bytes:
        """The DBC with which the record was made."""
        return dbc_text(self.trace.contract).encode()


def parsed_start(text: str) -> datetime:
    """The start of the run from the command line, in UTC.

    :raises InputError: no instant, no time zone, or a year that the files cannot hold.
    """
    try:
        found = datetime.fromisoformat(text)
    except ValueError:
        raise InputError("command line", "--start", text, _ALLOWED) from None
    if found.tzinfo is None or not _START_MIN <= found <= _START_MAX:
        raise InputError("command line", "--start", text, _ALLOWED)
    return found.astimezone(UTC)
