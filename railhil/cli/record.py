"""A recorded run as a user names it: its log, the certificate beside it, and whether the two belong together."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from railhil.bus.ident import PltIdent
from railhil.common.errors import InputError, Words
from railhil.dbc import wire_contract
from railhil.scenarios.load import load
from railhil.scenarios.model import Scenario
from railhil.supervisor.documents import CERTIFICATE, read_certificate
from railhil.supervisor.framelog import log_sha256, read_log
from railhil.supervisor.trace import Trace, trace_of

_BESIDE = "a certificate beside the log, or --scenario"


@dataclass(frozen=True, slots=True)
class Record:
    """A record whose parts fit together.

    ``invalid``: why the bench could not be trusted when it was made; ``certificate``: empty when none is of this log.
    """

    log: Path
    scenario: Scenario
    trace: Trace
    invalid: str = ""
    certificate: dict[str, Any] = field(default_factory=dict)


def log_path(text: str) -> Path:
    """Path of the log that a user named by itself or by its run folder.

    :raises InputError: there is no such file.
    """
    path = Path(text)
    log = path / "frames.log" if path.is_dir() else path
    if not log.is_file():
        found = Words("no such file" if not log.exists() else "no regular file")
        raise InputError(log, "file", found, "a candump log, a BLF of one, or a run folder with frames.log")
    return log


def _recorded_scenario(log: Path, name: str | None) -> Scenario:
    """The scenario that a log was recorded with: by name, else from the certificate beside the log.

    :raises InputError: neither says it.
    """
    if name is not None:
        return load(name)
    path = log.parent / CERTIFICATE
    document = read_certificate(log.parent, _BESIDE)
    if document is None:
        raise InputError(path, "file", Words("no such file (the run did not come to its end)"), _BESIDE)
    scenario = document.get("scenario")
    if scenario is None:
        raise InputError(path, "scenario", Words("no such key"), _BESIDE)
    return load(str(scenario), document.get("settings", ()))


def checked_record(text: str, name: str | None) -> Record:
    """Log, scenario and telegrams of a record, after all of them were compared with each other.

    The SHA-256 in the certificate is compared last: that a log belongs to another scenario says more than that it
    is not the one that was certified.

    :param text: log or run folder.
    :param name: scenario when the user names one; a certificate that is broken or not of this log is then left aside.
    :raises InputError: one line for the first thing that does not fit.
    """
    log = log_path(text)
    scenario = _recorded_scenario(log, name)
    trace = _trace(log, scenario)
    try:
        document = read_certificate(log.parent, _BESIDE) or {}
    except InputError:
        if name is None:
            raise
        document = {}
    wanted, found = document.get("frames_sha256"), log_sha256(log)
    if wanted != found:
        if name is None:
            raise InputError(log, "sha256", found, f"{wanted} ({CERTIFICATE} beside it): a log that nobody changed")
        document = {}
    invalid = str(document.get("line") or "no reason given") if document.get("verdict") == "INVALID" else ""
    return Record(log, scenario, trace, invalid, document)


def _trace(log: Path, scenario: Scenario) -> Trace:
    """Telegrams of a log, after its handshake was compared with scenario and DBC."""
    trace = trace_of(read_log(log))
    ident = trace.ident(PltIdent)
    if ident is None:
        raise InputError(log, "PLT_IDENT", Words("no such telegram"), "a log that railhil recorded from its start")
    wanted_wire = int(wire_contract().sha256[:8], 16)
    if ident.wire_hash != wanted_wire:
        raise InputError(log, "DBC hash", f"{ident.wire_hash:08x}", f"{wanted_wire:08x} (the DBC of this installation)")
    wanted = int(scenario.sha256[:8], 16)
    if ident.scenario_hash != wanted:
        raise InputError(log, "scenario hash", f"{ident.scenario_hash:08x}", f"{wanted:08x} ({scenario.name})")
    return trace
