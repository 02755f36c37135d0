"""Repeating a recorded run, by its certificate and log, and deriving its files again from the log: what has changed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.judge.cross_check import check_folder
from railhil.judge.events.event import write_events
from railhil.judge.folder import code_sha256, made_by
from railhil.judge.record import Record, checked_record
from railhil.judge.signals import write_signals
from railhil.record.blf_writer import start_ns, write_blf
from railhil.record.difference import first_difference
from railhil.record.documents import CERTIFICATE, read_certificate
from railhil.record.framelog import log_sha256, read_log
from railhil.record.hash_list import HASH_LIST
from railhil.scenarios.given import NO_CODE, NamedCode
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.scenario_documents import SCENARIO, read_scenario
from railhil.scenarios.system import DEFAULT, system_named

_CERTIFICATE = "a run folder with its certificate, or certificate.json"


@dataclass(frozen=True, slots=True)
class CertifiedRun:
    """A certified run.

    ``log``: its record, checked against the certificate; None if it is not beside it.
    """

    certificate_path: Path
    certificate: dict[str, Any]
    spec: RunSpec
    log: Path | None

    @property
    def sha256(self) -> str:
        """SHA-256 of its ``frames.log``, from the certificate."""
        return str(self.certificate["frames_sha256"])

    @property
    def telegrams_sha256(self) -> str:
        """SHA-256 of the frames of its wire contract alone; empty: the certificate does not have it."""
        return str(self.certificate.get("telegrams_sha256") or "")


def certified_run(text: str, code: NamedCode = NO_CODE) -> CertifiedRun:
    """The run of a run folder or of a certificate.

    :param code: that the command line names, for a run with code of the user.
    :raises InputError: there is no certificate, it describes no run, the log beside it is another one, or the run had
        other code.
    """
    given = Path(text)
    path = given / CERTIFICATE if given.is_dir() else given
    document = read_certificate(path, _CERTIFICATE)
    if document is None:
        raise InputError(path, "", Words("does not exist"), _CERTIFICATE)
    wanted = document.get("frames_sha256")
    if not wanted:
        raise InputError(path, "frames_sha256", Words(), _CERTIFICATE)
    log = next((log for log in _logs(path.parent) if log.is_file()), None)
    if log is not None:
        checked_record(str(log), None)
    elif (path.parent / HASH_LIST).is_file():
        # A certificate can be kept or sent alone.
        check_folder(path.parent, document)
    if log is not None and (found := log_sha256(log)) != wanted:
        raise InputError(log, "sha256", found, f"{wanted} ({path.name} beside it): a log that nobody changed")
    return CertifiedRun(path, document, RunSpec.from_json(document, path, code), log)


def _logs(folder: Path) -> tuple[Path, ...]:
    return folder / "frames.log", folder / BLF


def repeatable(run: CertifiedRun) -> None:
    """Refuse a run that cannot be repeated with the same bytes.

    :raises InputError: it kept real time, or its controller was not railhil's.
    """
    path = run.certificate_path
    if run.spec.is_realtime:
        allowed = "lockstep: a run in real time has other bytes each time (railhil replay compares its answers)"
        raise InputError(path, "pace", run.spec.pace, allowed)
    if run.certificate.get("foreign"):
        allowed = "a controller of railhil (railhil replay compares the answers of another one with it)"
        raise InputError(path, "foreign", Words("a controller of somebody else"), allowed)


def scenario_now(run: CertifiedRun, stored: bool) -> tuple[AnyScenario, str]:
    """The scenario with which to repeat a run, and its differences from the record's; empty: no differences.

    :param stored: if the scenario named in the certificate has changed or is gone, use the scenario of the run folder.
    :raises InputError: there is none.
    """
    wanted, path = run.certificate.get("scenario_sha256"), run.certificate_path.parent / SCENARIO
    kept = stored and path.is_file()
    try:
        scenario = run.spec.load()
    except InputError as error:
        if not kept:
            raise
        return read_scenario(path), f"scenario {run.spec.scenario} cannot be loaded ({error}): {SCENARIO} is used"
    if scenario.sha256 == wanted:
        return scenario, ""
    said = f"scenario {run.spec.scenario} has changed since the record"
    return (read_scenario(path), f"{said}: {SCENARIO} beside the certificate is used") if kept else (scenario, said)


def changes(run: CertifiedRun) -> list[str]:
    """One sentence for each part of the bench that differs from the record's: a cause of other bytes."""
    return document_changes(run.certificate, "the record")


def document_changes(document: Mapping[str, Any], since: str) -> list[str]:
    """:func:`code_changes` of a document that names its system and its law."""
    system = str(document.get("system") or DEFAULT)
    now = made_by(system, str(document.get("controller")), code_sha256())
    return code_changes(document, now | {"dbc_sha256": system_named(system).contract.sha256}, since)


def code_changes(then: Mapping[str, Any], now: Mapping[str, str | None], since: str) -> list[str]:
    """One sentence for each part of the code that differs from the code that made a document.

    :param then: the document; missing keys are not compared.
    :param now: :func:`railhil.judge.folder.made_by`, and further hashes.
    :param since: the thing that was made then.
    """
    differ = {key for key, value in now.items() if then.get(key) not in (None, value)}
    releases = {str(document.get("railhil")).partition("+")[0] for document in (then, now)}
    found = []
    # Another commit of one release may have the same code.
    if "railhil" in differ and (len(releases) > 1 or "code_sha256" in differ):
        found.append(f"{since} was made by railhil {then['railhil']}, this is {now['railhil']}")
    if "dbc_sha256" in differ:
        found.append(f"{since} has another wire contract (dbc_sha256): frames differ from the handshake on")
    if "code_sha256" in differ:
        found.append(f"the code of the bench has changed since {since} (code_sha256)")
    if "system_sha256" in differ and "code_sha256" not in differ:
        found.append(f"the code of its system has changed since {since} (system_sha256)")
    if "law_sha256" in differ:
        found.append(f"the distribution of the law has changed since {since} (law_sha256)")
    if "tuning_sha256" in differ:
        found.append(f"the code of the search has changed since {since} (tuning_sha256)")
    return found


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
    found = first_difference(logged, read_log(path), record.trace.contract, record.trace.contract)
    return "" if found is None else f"{BLF}: other frames than {record.log.name}: {found.sentence}"


def csv_difference(record: Record, name: str) -> str:
    """The first value in which ``signals.csv`` or ``events.csv`` differs from the log; empty: no difference, or no such
    file.

    The file was made by the code of the record, and other code may give other values.
    """
    path = record.log.with_name(name)
    if not path.is_file():
        return ""
    with TemporaryDirectory(prefix="railhil-") as private:
        again = Path(private) / name
        if name == SIGNALS:
            write_signals(record.scenario, record.trace, again, record.certificate.get("notes"))
        else:
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
