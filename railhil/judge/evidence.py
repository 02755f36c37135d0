"""A folder of evidence against its list of hashes, and that list against its signature."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from railhil.common.errors import InputError, Words
from railhil.dbc import ContractError
from railhil.judge.events.event import EVENTS
from railhil.judge.record import Record, checked_record
from railhil.judge.rerun import SIGNALS, blf_difference, csv_difference, document_changes
from railhil.record.documents import CERTIFICATE, FAULT_TABLE, read_fault_table
from railhil.record.framelog import LOG_NAME
from railhil.record.hash_list import DOCUMENTS, HASH_LIST, Changed, changed_files, listed_files, read_hash_list
from railhil.record.run_folder import TELEMETRY
from railhil.record.signature import KEY, Signed


@dataclass
class Checked:
    """Results of a check: number of files that are as listed; faults, points that could not be checked, and remarks, a
    sentence each.

    ``hashes``: the list; None: the folder has none. ``record``: of a run folder that can be read.
    """

    files: int = 0
    has_telemetry: bool = False
    problems: list[str] = field(default_factory=list)
    unchecked: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    hashes: Mapping[str, str] | None = None
    record: Record | None = field(default=None, repr=False)

    def add(self, other: Checked) -> None:
        """Add the results of another folder."""
        self.files += other.files
        self.has_telemetry |= other.has_telemetry
        self.problems += other.problems
        self.unchecked += other.unchecked
        self.remarks += other.remarks


def refuse_no_evidence(folder: Path) -> None:
    """
    :raises InputError: a folder has nothing that can be checked.
    """
    if not folder.is_dir() or not is_evidence(folder):
        found = Words("does not exist" if not folder.exists() else "has nothing to verify")
        raise InputError(folder, "", found, f"a folder with {HASH_LIST}, or with one of {', '.join(DOCUMENTS)}")


def is_evidence(folder: Path) -> bool:
    """Whether a folder has a list of hashes, or a document that marks it as complete."""
    return any((folder / name).is_file() for name in (HASH_LIST, *DOCUMENTS))


def check_evidence(folder: Path, place: str = "") -> Checked:
    """Check a folder, and the folders below it that have lists of their own.

    :param place: of the folder within the verified one.
    """
    seen = check_folder_alone(folder, place)
    for below in folders_below(folder, seen):
        seen.add(check_evidence(folder / below, f"{place}{below}/"))
    return seen


def folders_below(folder: Path, seen: Checked) -> list[str]:
    """Names of the folders below that the list of a folder covers by lists of their own."""
    end = f"/{HASH_LIST}"
    return [name.removesuffix(end) for name in seen.hashes or () if name.endswith(end) and (folder / name).is_file()]


def check_folder_alone(folder: Path, place: str = "") -> Checked:
    """Check a folder without those below it that have lists of their own.

    :param place: stands before the names of its files.
    """
    seen = Checked()
    try:
        hashes = seen.hashes = read_hash_list(folder)
        changed: list[Changed] = []
        if hashes is None:
            covered = "the record and what stands in two of its files" if _has_certificate(folder) else "nothing"
            name = place.removesuffix("/") or folder
            seen.unchecked.append(f"{name}: a folder without {HASH_LIST}: only {covered} can be checked")
        else:
            changed = list(changed_files(folder, hashes))
            seen.problems += [f"{place}{one.sentence}" for one in changed]
            seen.files += len(hashes) - len(changed)
            if missed := _missed_document(hashes):
                seen.problems.append(f"{place}{missed}")
            more = [name for name in listed_files(folder) if name not in hashes]
            seen.unchecked += [f"{place}{name}: not in {HASH_LIST}" for name in more]
        if _has_certificate(folder) and not changed:
            _check_record(folder, place, seen)
        if (table := read_fault_table(folder)) is not None:
            seen.remarks += [f"{place}{FAULT_TABLE}: {said}" for said in document_changes(table, "the table")]
    except InputError as error:
        seen.problems.append(str(error))
    return seen


def _missed_document(hashes: Mapping[str, str]) -> str:
    """The fault of a list without the document of its kind of folder; empty: it has the document."""
    wanted = (CERTIFICATE,) if LOG_NAME in hashes else DOCUMENTS
    return "" if any(name in hashes for name in wanted) else f"{HASH_LIST}: no line of {' or '.join(wanted)}"


def _has_certificate(folder: Path) -> bool:
    return (folder / CERTIFICATE).is_file()


def _check_record(folder: Path, place: str, seen: Checked) -> None:
    """Check that log, certificate and the other files belong together, and that the derived files follow from the
    log."""
    try:
        record = seen.record = checked_record(str(folder), None)
        seen.remarks += record.notes
        found = [blf_difference(record)]
        changes = document_changes(record.certificate, "the record")
        for name in (SIGNALS, EVENTS):
            if changes and (folder / name).is_file():
                seen.unchecked.append(f"{place}{name}: not compared with the log: {changes[0]}")
            else:
                found.append(csv_difference(record, name))
        seen.has_telemetry |= (folder / TELEMETRY).is_file()
        seen.problems += [f"{place}{said}" for said in found if said]
    except (InputError, ContractError) as error:
        seen.problems.append(str(error))


def signature_sentence(found: Signed | None, key: Path | None) -> tuple[str, bool]:
    """The sentence on a signature, and whether it is as required.

    :param key: that must have signed; None: any signature, or none.
    """
    if found is None:
        return "unsigned", key is None
    if not found.is_checked:
        return f"the signature is not checked: {found.said}", True
    if not found.by or found.is_good is False:
        return f"the signature is not good: {found.said}", False
    return f"signed with {found.by}" + (f" ({KEY} FILE says whose it is)" if found.is_good is None else ""), True
