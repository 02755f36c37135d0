"""``railhil verify``: a folder of evidence against its list of hashes, and that list against its signature."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import FAIL, PASS
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.dbc import ContractError
from railhil.judge.events.event import EVENTS
from railhil.judge.record import checked_record
from railhil.judge.rerun import SIGNALS, blf_difference, document_changes, events_difference, signals_difference
from railhil.record.documents import CERTIFICATE, FAULT_TABLE, read_fault_table
from railhil.record.framelog import LOG_NAME
from railhil.record.hash_list import DOCUMENTS, HASH_LIST, Changed, changed_files, listed_files, read_hash_list
from railhil.record.run_folder import TELEMETRY
from railhil.record.signature import KEY, Signed, signed

_END = f"/{HASH_LIST}"


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "verify",
        examples=["railhil verify runs/mine", "railhil verify runs/mine --key ~/.ssh/id_ed25519.pub"],
        description="Exit code 0 when every file is as it was written, and signed with --key if that is given; else 1.",
    )
    parser.add_argument(
        "folder", type=Path, metavar="DIR", help="folder of a run, a comparison, a campaign, a sequence or faults"
    )
    parser.add_argument(
        KEY, type=Path, metavar="FILE", help="public SSH key that must have signed, or a file of allowed signers"
    )
    add_json_argument(parser)
    parser.set_defaults(work=work)


@dataclass
class _Found:
    """Results of the check: files that are as listed; faults, points that could not be checked, and remarks, a sentence
    each."""

    files: int = 0
    has_telemetry: bool = False
    problems: list[str] = field(default_factory=list)
    unchecked: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)


def work(namespace: argparse.Namespace) -> int:
    """Check and print."""
    folder: Path = namespace.folder
    if not folder.is_dir() or not any((folder / name).is_file() for name in (HASH_LIST, *DOCUMENTS)):
        found = Words("does not exist" if not folder.exists() else "has nothing to verify")
        raise InputError(folder, "", found, f"a folder with {HASH_LIST}, or with one of {', '.join(DOCUMENTS)}")
    seen = _Found()
    _look(folder, "", seen)
    signature = signed(folder, namespace.key) if (folder / HASH_LIST).is_file() else None
    said, is_good = _signature(signature, namespace.key)
    if not is_good:
        seen.problems.append(said)
    if namespace.json:
        print_json(_document(seen, said, signature))
        return FAIL if seen.problems else PASS
    console = Output()
    for line in (*seen.unchecked, *seen.remarks):
        console.say(line, style="bold yellow")
    for line in seen.problems:
        console.say(line, style="red")
    ending = count_of(len(seen.problems), "problem") if seen.problems else f"{count_of(seen.files, 'file')} as listed"
    if seen.has_telemetry:
        # The controller's own report does not follow from the log.
        ending += f", {TELEMETRY} compared with its hash alone"
    console.say(f"{folder}: {ending}; {said}")
    return FAIL if seen.problems else PASS


def _signature(found: Signed | None, key: Path | None) -> tuple[str, bool]:
    """The sentence on the signature, and whether it is as required."""
    if found is None:
        return "unsigned", key is None
    if not found.is_checked:
        return f"the signature is not checked: {found.said}", True
    if not found.by or found.is_good is False:
        return f"the signature is not good: {found.said}", False
    return f"signed with {found.by}" + (f" ({KEY} FILE says whose it is)" if found.is_good is None else ""), True


def _document(seen: _Found, said: str, signature: Signed | None) -> dict[str, Any]:
    return {
        "files": seen.files,
        "problems": seen.problems,
        "not_checked": seen.unchecked,
        "remarks": seen.remarks,
        "signature": said,
        "signed_by": None if signature is None or not signature.by else signature.by,
    }


def _look(folder: Path, place: str, seen: _Found) -> None:
    """Check a folder and the folders below it that have lists of their own.

    :param place: of the folder within the verified one.
    """
    try:
        hashes = read_hash_list(folder)
        changed: list[Changed] = []
        if hashes is None:
            covered = "the record and what stands in two of its files" if _has_certificate(folder) else "nothing"
            seen.unchecked.append(f"{place or folder}: a folder without {HASH_LIST}: only {covered} can be checked")
        else:
            changed = list(changed_files(folder, hashes))
            seen.problems += [f"{place}{one.sentence}" for one in changed]
            seen.files += len(hashes) - len(changed)
            if missed := _missed_document(hashes):
                seen.problems.append(f"{place}{missed}")
            more = [name for name in listed_files(folder) if name not in hashes]
            seen.unchecked += [f"{place}{name}: not in {HASH_LIST}" for name in more]
        if _has_certificate(folder) and not changed:
            _look_at_record(folder, place, seen)
        if (table := read_fault_table(folder)) is not None:
            seen.remarks += [f"{place}{FAULT_TABLE}: {said}" for said in document_changes(table, "the table")]
    except InputError as error:
        seen.problems.append(str(error))
        return
    for name in hashes or ():
        if name.endswith(_END) and (folder / name).is_file():
            below = name.removesuffix(HASH_LIST)
            _look(folder / below, f"{place}{below}", seen)


def _missed_document(hashes: Mapping[str, str]) -> str:
    """The fault of a list without the document of its kind of folder; empty: it has the document."""
    wanted = (CERTIFICATE,) if LOG_NAME in hashes else DOCUMENTS
    return "" if any(name in hashes for name in wanted) else f"{HASH_LIST}: no line of {' or '.join(wanted)}"


def _has_certificate(folder: Path) -> bool:
    return (folder / CERTIFICATE).is_file()


def _look_at_record(folder: Path, place: str, seen: _Found) -> None:
    """Check that log, certificate and the other files belong together, and that the derived files follow from the
    log."""
    try:
        record = checked_record(str(folder), None)
        seen.remarks += record.notes
        found = [blf_difference(record)]
        changes = document_changes(record.certificate, "the record")
        for name, difference in ((SIGNALS, signals_difference), (EVENTS, events_difference)):
            if changes and (folder / name).is_file():
                seen.unchecked.append(f"{place}{name}: not compared with the log: {changes[0]}")
            else:
                found.append(difference(record))
        seen.has_telemetry |= (folder / TELEMETRY).is_file()
        seen.problems += [f"{place}{said}" for said in found if said]
    except (InputError, ContractError) as error:
        seen.problems.append(str(error))
