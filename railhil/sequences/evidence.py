"""A recorded sequence: a folder of run folders, each with the memory before and after it, and one hash over all.

::

    run001/, run002/, ...   run folders, as of railhil run
    sequence.json           the request, a line per finished run, and the hash of the sequence
    SHA256SUMS              of a complete sequence: hashes of sequence.json and of the lists of the runs

The hash is the SHA-256 of one line per run, ``NUMBER MEMORY_BEFORE FRAMES MEMORY_AFTER`` and a line feed: the SHA-256
of the memory before it, of ``frames.log``, and of the record that it left, ``-`` if it left none. It is the same on
every transport.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from railhil.common.errors import InputError, Words, describe_os_error
from railhil.common.user_files import given_json, write_synced
from railhil.common.version import full_version
from railhil.dbc import ContractError
from railhil.judge.cross_check import check_folder
from railhil.record.documents import CERTIFICATE, read_certificate
from railhil.record.framelog import log_sha256, sha256_of
from railhil.record.hash_list import HASH_LIST, HASH_LIST_KEY, check_document, enter
from railhil.record.run_folder import recorded_by
from railhil.scenarios.memory import (
    MEMORY_AFTER,
    MEMORY_BEFORE,
    Memory,
    MemoryRecord,
    load_memory,
    no_memory,
    read_record,
)
from railhil.scenarios.memory import BadRecord as BadMemory
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.validation import validate
from railhil.sequences.plan import RUNS_MAX

SEQUENCE = "sequence.json"
_FORMAT = 1
_SHA256 = r"^[0-9a-f]{64}$"


class Made(BaseModel):
    """One finished run: its number, its verdict, and the hashes of its files."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)
    run: int = Field(ge=1)
    verdict: str
    memory_before_sha256: str = Field(pattern=_SHA256)
    frames_sha256: str = Field(pattern=_SHA256)
    memory_after_sha256: str | None = Field(pattern=_SHA256)

    @property
    def line(self) -> str:
        """Its line of the hash."""
        after = self.memory_after_sha256 or "-"
        return f"{self.run} {self.memory_before_sha256} {self.frames_sha256} {after}\n"


class _File(BaseModel):
    model_config = ConfigDict(extra="ignore", strict=True)
    format: Literal[1]
    runs: int = Field(ge=1, le=RUNS_MAX)
    first: dict[str, Any]
    made: list[Made]
    sha256: str | None


@dataclass(frozen=True, slots=True)
class Evidence:
    """A recorded sequence.

    :param first: its first run, with the memory that the sequence began with.
    :param runs: number of runs that were requested.
    :param made: the finished runs, in order.
    """

    first: RunSpec
    runs: int
    made: tuple[Made, ...]

    @property
    def complete(self) -> bool:
        """True if every run is finished."""
        return len(self.made) == self.runs

    @property
    def began(self) -> Memory:
        """The memory that the sequence began with."""
        return self.first.law.memory or no_memory(self.first.law.controller, Path(MEMORY_BEFORE))

    @property
    def sha256(self) -> str | None:
        """Hash of the sequence; None while it is not complete."""
        return sequence_sha256(self.made) if self.complete else None

    def as_json(self) -> dict[str, Any]:
        """Content of ``sequence.json``."""
        return {
            "format": _FORMAT,
            "railhil": full_version(),
            # Of the last entry; the certificate of each run has its own.
            "recorded": recorded_by(),
            "runs": self.runs,
            "first": self.first.as_json(),
            "made": [one.model_dump() for one in self.made],
            "sha256": self.sha256,
            # It is written when the sequence is complete: the runs have lists of their own.
            **({HASH_LIST_KEY: HASH_LIST} if self.complete else {}),
        }


def sequence_sha256(made: Sequence[Made]) -> str:
    """Hash of a sequence of runs, see the top of this module."""
    return hashlib.sha256("".join(one.line for one in made).encode("ascii")).hexdigest()


def run_name(number: int) -> str:
    """Folder of a run."""
    return f"run{number:03d}"


def write_evidence(evidence: Evidence, folder: Path) -> None:
    """Write ``sequence.json``, and the list of hashes of a complete sequence. Raises OSError."""
    content = (json.dumps(evidence.as_json(), indent=2, allow_nan=False) + "\n").encode("ascii")
    if evidence.complete:
        lists = [f"{run_name(one.run)}/{HASH_LIST}" for one in evidence.made]
        # Runs of an earlier version have none.
        hashes = {name: sha256_of(folder / name) for name in lists if (folder / name).is_file()}
        enter(folder, hashes, SEQUENCE, content)
    write_synced(folder / SEQUENCE, content)


def read_evidence(folder: Path) -> Evidence:
    """``sequence.json`` of a folder.

    :raises InputError: there is none, or it is damaged.
    """
    path = folder / SEQUENCE
    document = given_json(path, "a file of railhil sequence run")
    file = validate(_File, document, lambda keys: path)
    if document.get(HASH_LIST_KEY) or len(file.made) == file.runs:
        check_document(folder, SEQUENCE, document)
    made = tuple(file.made)
    evidence = Evidence(RunSpec.from_json(file.first, path), file.runs, made)
    if [one.run for one in made] != [*range(1, len(made) + 1)] or len(made) > file.runs:
        raise InputError(path, "made", [one.run for one in made], f"1, 2, ... to at most {file.runs}")
    if file.sha256 != evidence.sha256:
        raise InputError(path, "sha256", file.sha256, f"{evidence.sha256}: that of the lines in the file")
    return evidence


def left(folder: Path, began: Memory) -> tuple[Memory, MemoryRecord | None]:
    """The memory after a run in its folder, and the record that it left.

    :param began: the memory before it.
    :raises InputError: a file is damaged.
    """
    path = folder / MEMORY_AFTER
    certificate = read_certificate(folder)
    if certificate is None:
        raise InputError(folder / CERTIFICATE, "", Words("does not exist"), "that of a complete run")
    if not path.exists():
        return began, None
    try:
        record = read_record(path)
    except BadMemory as bad:
        raise bad.error from None
    return began.add_run(record, certificate["memory_used"] or "", certificate["memory_refused"]), record


def problems(folder: Path) -> Iterator[str]:
    """Differences between a sequence and its record, one sentence each; none for a sequence as it was recorded.

    :raises InputError: the folder has no sequence.
    """
    evidence = read_evidence(folder)
    if not evidence.complete:
        yield f"{len(evidence.made)} of {evidence.runs} runs are finished"
    yield from differences(folder, evidence)


def differences(folder: Path, evidence: Evidence) -> Iterator[str]:
    """Differences between the finished runs of a sequence and its record, one sentence each."""
    memory = evidence.began
    for one in evidence.made:
        place = folder / run_name(one.run)
        try:
            check_folder(place, read_certificate(place))
        except (InputError, ContractError) as error:
            yield str(error)
        try:
            found = load_memory(place / MEMORY_BEFORE)
            if not memory.sha256 == found.sha256 == one.memory_before_sha256:
                yield f"{place / MEMORY_BEFORE} is not the memory that run {one.run - 1} has left"
            if (frames := log_sha256(place / "frames.log")) != one.frames_sha256:
                yield f"{place / 'frames.log'} has SHA-256 {frames}, recorded {one.frames_sha256}"
            memory, record = left(place, found)
            after = None if record is None else record.sha256
            if after != one.memory_after_sha256:
                yield f"{place / MEMORY_AFTER} has SHA-256 {after}, recorded {one.memory_after_sha256}"
        except InputError as error:
            yield str(error)
        except OSError as error:
            yield f"{place}: {describe_os_error(error)}"
