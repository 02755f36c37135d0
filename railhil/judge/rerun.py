"""Repeating a recorded run: its certificate and log, and the changes since."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words
from railhil.judge.cross_check import check_folder
from railhil.judge.folder import code_sha256, made_by
from railhil.judge.record import checked_record
from railhil.record.documents import CERTIFICATE, read_certificate
from railhil.record.framelog import BLF_SUFFIX, log_sha256
from railhil.record.hash_list import HASH_LIST
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.plant_fmu import PlantFmu
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.stored import SCENARIO, read_scenario
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


def certified_run(text: str, fmu: PlantFmu | None = None) -> CertifiedRun:
    """The run of a run folder or of a certificate.

    :param fmu: that the command line names, for a run whose plant was one.
    :raises InputError: there is no certificate, it describes no run, the log beside it is another one, or its plant was
        another FMU.
    """
    given = Path(text)
    path = given / CERTIFICATE if given.is_dir() else given
    document = read_certificate(path, _CERTIFICATE)
    if document is None:
        raise InputError(path, "file", Words("no such file"), _CERTIFICATE)
    wanted = document.get("frames_sha256")
    if not wanted:
        raise InputError(path, "frames_sha256", Words("no such key"), _CERTIFICATE)
    log = next((log for log in _logs(path.parent) if log.is_file()), None)
    if log is not None:
        checked_record(str(log), None)
    elif (path.parent / HASH_LIST).is_file():
        # A certificate can be kept or sent alone.
        check_folder(path.parent, document)
    if log is not None and (found := log_sha256(log)) != wanted:
        raise InputError(log, "sha256", found, f"{wanted} ({path.name} beside it): a log that nobody changed")
    return CertifiedRun(path, document, RunSpec.from_json(document, path, fmu), log)


def _logs(folder: Path) -> tuple[Path, ...]:
    return folder / "frames.log", folder / f"frames{BLF_SUFFIX}"


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
    found = []
    if "railhil" in differ:
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
