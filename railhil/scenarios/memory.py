"""A law's memory from run to run: records that the law has left, each a JSON file with a CRC.

::

    {"version": 1, "law": "mylaw", "key": "dalian_12 up", "runs": 3, "last_run": 3, "values": {"offset_m": -0.12},
     "crc32": "ccfa25ef"}

``key`` is chosen by the law and says where the values apply (train, platform, ...); only the law interprets ``values``.
``runs`` counts the runs that the law has learned from, ``last_run`` is the number of the last one. The CRC-32 (that of
zlib) covers everything except itself as canonical JSON: keys sorted, no blanks, ASCII.

A run begins with a :class:`Memory`: the records that its law may choose from, the best first, with the faults of the
others. :mod:`railhil.scenarios.memory_store` keeps them in two slots.
"""

from __future__ import annotations

import hashlib
import json
import zlib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from railhil.common.errors import InputError, Words
from railhil.common.user_files import given_bytes, json_object, refuse_unreadable, write_synced
from railhil.scenarios.validation import validate

VERSION = 1
#: Names in a run folder: the memory with which the run began, and the record that the law has left.
MEMORY_BEFORE, MEMORY_AFTER = "memory_before.json", "memory.json"
#: Places of a record: the two slots of a store, its default, and a file named by the user.
SLOT_A, SLOT_B, LINE_DEFAULT, NAMED_FILE = "A", "B", "default", "file"
#: Causes for which a record cannot be used, with their numbers on the bus: no file that can be read, no JSON, a number
#: that is not finite, another CRC, another version, missing or wrong fields, another key, values that the law refuses.
FAULTS: Mapping[str, int] = {
    "unreadable": 1,
    "json": 2,
    "not_finite": 3,
    "crc": 4,
    "version": 5,
    "fields": 6,
    "key": 7,
    "values": 8,
}
#: Number of hash digits that identify a memory in names and in the handshake.
_DIGEST_DIGITS = 8
_BYTES_MAX = 1_000_000
_ALLOWED = "a memory that railhil has written"


class _Part(BaseModel):
    model_config = ConfigDict(defer_build=True, extra="forbid", strict=True, allow_inf_nan=False)


class _Record(_Part):
    version: Literal[1]
    law: str = Field(min_length=1)
    key: str
    runs: int = Field(ge=1)
    last_run: int = Field(ge=0)
    values: dict[str, Any]
    crc32: str


class _Stored(_Part):
    slot: Literal["A", "B", "default", "file"]
    fault: Literal["", *FAULTS]  # type: ignore[valid-type]
    detail: str
    record: dict[str, Any] | None


class _Memory(_Part):
    """:meth:`Memory.as_json`."""

    law: str = Field(min_length=1)
    stored: list[_Stored]
    sha256: str


@dataclass(frozen=True)
class MemoryRecord:
    """The memory that a law has left after one run; see the top of this module."""

    law: str
    key: str
    runs: int
    last_run: int
    values: Mapping[str, Any]

    @property
    def document(self) -> dict[str, Any]:
        """The record with its CRC."""
        content = {"version": VERSION, **vars(self), "values": dict(self.values)}
        return content | {"crc32": crc32(content)}

    @property
    def text(self) -> str:
        """Content of its file, always the same for the same record."""
        return json.dumps(self.document, indent=2, sort_keys=True, allow_nan=False) + "\n"

    @property
    def content(self) -> bytes:
        """:attr:`text` as bytes."""
        return self.text.encode("ascii")

    @property
    def sha256(self) -> str:
        """Hash of :attr:`content`, and therefore of its file."""
        return hashlib.sha256(self.content).hexdigest()

    @property
    def digest(self) -> str:
        """First digits of the hash."""
        return self.sha256[:_DIGEST_DIGITS]


class BadRecord(Exception):
    """A record that cannot be used; ``fault`` is one of :data:`FAULTS`."""

    def __init__(self, fault: str, error: InputError) -> None:
        super().__init__(str(error))
        self.fault, self.error = fault, error


@dataclass(frozen=True)
class MemoryPlace:
    """One place of a memory: a record, or the fault of its content (``fault`` of :data:`FAULTS`)."""

    slot: str
    record: MemoryRecord | None
    fault: str = ""
    detail: str = ""

    def refuse(self, fault: str, detail: str) -> MemoryPlace:
        """The same place, found unusable."""
        return MemoryPlace(self.slot, None, fault, detail)

    def as_json(self) -> dict[str, Any]:
        """For :meth:`Memory.as_json`."""
        return vars(self) | {"record": None if self.record is None else self.record.document}


@dataclass(frozen=True)
class Memory:
    """The records that a law may begin a run with.

    :param stored: the best first: the slot of the last run, the other one, the default of the line; then unusable
        places. :param source: the store or file that it was read from, or whose name it has.
    """

    law: str
    stored: tuple[MemoryPlace, ...]
    source: Path

    @property
    def _content(self) -> dict[str, Any]:
        return {"law": self.law, "stored": [one.as_json() for one in self.stored]}

    @property
    def sha256(self) -> str:
        """Hash of the content as canonical JSON."""
        return hashlib.sha256(encode_canonical(self._content)).hexdigest()

    @property
    def digest(self) -> str:
        """First digits of the hash."""
        return self.sha256[:_DIGEST_DIGITS]

    @property
    def newest(self) -> MemoryRecord | None:
        """The record that a law begins with unless it refuses it."""
        return next((one.record for one in self.stored if one.record is not None), None)

    def as_json(self) -> dict[str, Any]:
        """The memory in a certificate and in a run folder: enough to begin the run again."""
        return self._content | {"sha256": self.sha256}

    def find_record(self, slot: str) -> MemoryRecord | None:
        """The record in that place."""
        return next((one.record for one in self.stored if one.slot == slot), None)

    def add_run(self, record: MemoryRecord, used: str, refused: Collection[str]) -> Memory:
        """The memory after one more run, as in a store that was written with the same arguments.

        :param used: the place of the record that the law began with; empty: none.
        :param refused: slots whose content the law has refused.
        """
        slot = next_slot(used)
        kept = [
            one
            for one in self.stored
            if one.slot != slot and (one.slot == LINE_DEFAULT or not (one.fault or one.slot in refused))
        ]
        return sort_memory(self.law, [MemoryPlace(slot, record), *kept], self.source)

    def move_to(self, source: Path) -> Memory:
        """The same memory, read from somewhere else."""
        return replace(self, source=source)


def sort_memory(law: str, stored: Iterable[MemoryPlace], source: Path) -> Memory:
    """A memory with its places in order: records first, slots before the default, the newest first."""

    def order(one: MemoryPlace) -> tuple[bool, bool, int]:
        return one.record is None, one.slot == LINE_DEFAULT, -(one.record.runs if one.record is not None else 0)

    return Memory(law, tuple(sorted(sorted(stored, key=lambda one: one.slot), key=order)), source)


def next_slot(used: str) -> str:
    """The slot for the record of a run that began with the record in place ``used``."""
    return SLOT_B if used == SLOT_A else SLOT_A


def encode_canonical(content: Any) -> bytes:
    """Canonical JSON: keys sorted, no blanks, ASCII.

    :raises ValueError: a number that is not finite.
    """
    return json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False).encode("ascii")


def crc32(content: Mapping[str, Any]) -> str:
    """CRC-32 of the canonical JSON of a record without its CRC, eight hexadecimal digits."""
    return f"{zlib.crc32(encode_canonical(content)):08x}"


def no_memory(law: str, source: Path) -> Memory:
    """The memory of a law that has not run yet."""
    return Memory(law, (), source)


def next_record(
    law: str, key: str, values: Mapping[str, Any], before: MemoryRecord | None, run: int
) -> MemoryRecord | None:
    """The record that a law leaves after a run; None if it has learned from this run, or a later one, before.

    :param before: the record with which it began the run.
    :param run: number of the run.
    """
    if before is not None and run <= before.last_run:
        return None
    return MemoryRecord(law, key, 1 if before is None else before.runs + 1, run, values)


def read_record(path: Path) -> MemoryRecord:
    """The record of a file.

    :raises BadRecord: it cannot be used.
    """
    return _record(_document(path), path)


def _document(path: Path) -> dict[str, Any]:
    """The JSON object of a file.

    :raises BadRecord: there is none.
    """
    try:
        with refuse_unreadable(path, _ALLOWED):
            content = given_bytes(path, _BYTES_MAX)
    except InputError as error:
        raise BadRecord("unreadable", error) from None
    try:
        return json_object(path, content, _ALLOWED)
    except InputError as error:
        raise BadRecord("json", error) from None


def _record(document: Mapping[str, Any], source: Path) -> MemoryRecord:
    """A record from its JSON object.

    :raises BadRecord: it cannot be used.
    """
    content = {key: value for key, value in document.items() if key != "crc32"}
    try:
        wanted = crc32(content)
    except ValueError:
        # NaN and infinity are not JSON, though Python reads them.
        error = InputError(source, "values", Words("a number that is not finite"), "finite numbers")
        raise BadRecord("not_finite", error) from None
    if "crc32" in document and document["crc32"] != wanted:
        allowed = f"{wanted}: values that nobody changed"
        raise BadRecord("crc", InputError(source, "crc32", document["crc32"], allowed))
    try:
        found = validate(_Record, dict(document), lambda keys: source)
    except InputError as error:
        raise BadRecord("version" if error.key == "version" else "fields", error) from None
    return MemoryRecord(found.law, found.key, found.runs, found.last_run, found.values)


def load_memory(path: Path) -> Memory:
    """The memory of a file: one record, or the memory that a run has begun with (``memory_before.json``,
    ``certificate.json``).

    :raises InputError: it cannot be read or is damaged: one line, and the file is left unchanged.
    """
    try:
        document = _document(path)
        if "crc32" not in document and isinstance(document.get("memory"), dict):
            document = document["memory"]
        elif "crc32" not in document and "frames_sha256" in document:
            raise InputError(path, "memory", Words(), "the certificate of a run that kept a memory (run --memory DIR)")
        if "stored" in document:
            return memory_from_json(document, path)
        record = _record(document, path)
    except BadRecord as bad:
        raise bad.error from None
    return Memory(record.law, (MemoryPlace(NAMED_FILE, record),), path)


def memory_from_json(document: Mapping[str, Any], source: Path) -> Memory:
    """The memory of a document made by :meth:`Memory.as_json`.

    :param source: the file that contains the document.
    :raises InputError: it is not a memory, or its values do not match its hash.
    """
    file = validate(_Memory, dict(document), lambda keys: source)
    stored = []
    for one in file.stored:
        if (one.record is None) != bool(one.fault):
            both = Words(f"slot {one.slot} with a record and a fault, or neither")
            raise InputError(source, "memory.stored", both, "one of the two")
        try:
            record = None if one.record is None else _record(one.record, source)
        except BadRecord as bad:
            raise bad.error from None
        stored.append(MemoryPlace(one.slot, record, one.fault, one.detail))
    found = Memory(file.law, tuple(stored), source)
    if file.sha256 != found.sha256:
        raise InputError(source, "memory.sha256", file.sha256, f"{found.sha256}: values that nobody changed")
    return found


def write_memory(memory: Memory, path: Path) -> None:
    """Write the document of :meth:`Memory.as_json`, completely or not at all. Raises OSError."""
    text = json.dumps(memory.as_json(), indent=2, sort_keys=True, allow_nan=False) + "\n"
    write_synced(path, text.encode("ascii"))
