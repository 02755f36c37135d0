"""A recorded run as a user names it: its log, the certificate beside it, and whether the two belong together."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from railhil.bus.ident import PltIdent
from railhil.common.errors import InputError, Words
from railhil.dbc import Contract, recorded_contract
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.stored import SCENARIO, any_judged_sha256, earlier_scenario, read_scenario
from railhil.scenarios.system import system_named
from railhil.supervisor.documents import CERTIFICATE, read_certificate
from railhil.supervisor.framelog import log_sha256, read_log
from railhil.supervisor.trace import Trace, trace_of

_BESIDE = "a certificate beside the log, or --scenario"


@dataclass(frozen=True, slots=True)
class Record:
    """A record whose parts fit together.

    ``invalid``: why the bench could not be trusted when it was made, or that the log is not the one that was made
    then; ``certificate``: empty when none is of this log.
    """

    log: Path
    #: Of its system: what the system's own parts make of it, they know.
    scenario: Any
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


def _recorded_scenario(log: Path, name: str | None) -> AnyScenario:
    """The scenario that a log was recorded with: by name, else of its folder, else what the certificate names.

    A folder of version 0.1.0 has no scenario; the shipped ones of that version are kept with their hashes.

    :raises InputError: none of them says it.
    """
    if name is not None:
        return load_any(name)
    if (log.parent / SCENARIO).is_file():
        return read_scenario(log.parent / SCENARIO)
    path = log.parent / CERTIFICATE
    document = read_certificate(log.parent, _BESIDE)
    if document is None:
        raise InputError(path, "file", Words("no such file (the run did not come to its end)"), _BESIDE)
    scenario = document.get("scenario")
    if scenario is None:
        raise InputError(path, "scenario", Words("no such key"), _BESIDE)
    earlier = earlier_scenario(str(document.get("scenario_sha256")))
    if earlier is not None:
        return earlier
    return load_any(str(scenario), document.get("settings", ()))


def checked_record(text: str, name: str | None) -> Record:
    """Log, scenario and telegrams of a record, after all of them were compared with each other.

    The SHA-256 in the certificate is compared last: that a log belongs to another scenario says more than that it
    is not the one that was certified.

    :param text: log or run folder.
    :param name: scenario when the user names one. A certificate that is broken is then left aside; a log that is not
        the one that it certifies is a record all the same, INVALID.
    :raises InputError: one line for the first thing that does not fit.
    """
    log = log_path(text)
    scenario = _recorded_scenario(log, name)
    try:
        document = read_certificate(log.parent, _BESIDE) or {}
    except InputError:
        if name is None:
            raise
        document = {}
    _check_judged(log, scenario, document, name)
    contract = system_named(scenario.system).contract
    trace = _trace(log, scenario, recorded_contract(log.parent, document.get("dbc_sha256"), contract))
    wanted, found = document.get("frames_sha256"), log_sha256(log)
    if wanted != found:
        if name is None:
            raise InputError(log, "sha256", found, f"{wanted} ({CERTIFICATE} beside it): a log that nobody changed")
        if wanted is not None:
            other = f"{log.name} (sha256 {found}) is not the log that {CERTIFICATE} beside it is of (sha256 {wanted})"
            return Record(log, scenario, trace, other)
        document = {}
    invalid = str(document.get("line") or "no reason given") if document.get("verdict") == "INVALID" else ""
    return Record(log, scenario, trace, invalid, document)


def _check_judged(log: Path, scenario: AnyScenario, document: dict[str, Any], name: str | None) -> None:
    """The limits in the folder must be those of the run; a scenario that the user names may have others."""
    wanted, found = document.get("judged_sha256"), any_judged_sha256(scenario)
    if name is None and wanted is not None and wanted != found:
        allowed = f"{wanted} ({CERTIFICATE}): limits that nobody changed"
        raise InputError(log.parent / SCENARIO, "judged_sha256", found, allowed)


def _trace(log: Path, scenario: AnyScenario, contract: Contract) -> Trace:
    """Telegrams of a log, after its handshake was compared with scenario and DBC."""
    trace = trace_of(read_log(log), contract)
    ident = trace.ident(PltIdent)
    if ident is None:
        raise InputError(log, "PLT_IDENT", Words("no such telegram"), "a log that railhil recorded from its start")
    wanted_wire = int(contract.sha256[:8], 16)
    if ident.wire_hash != wanted_wire:
        allowed = f"{wanted_wire:08x} (the DBC that the record says it was made with)"
        raise InputError(log, "DBC hash", f"{ident.wire_hash:08x}", allowed)
    wanted = int(scenario.sha256[:8], 16)
    if ident.scenario_hash != wanted:
        raise InputError(log, "scenario hash", f"{ident.scenario_hash:08x}", f"{wanted:08x} ({scenario.name})")
    return trace
