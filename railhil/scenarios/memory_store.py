"""A law's memory in a folder with two slots, so that a record that is torn or damaged never costs more than one run.

::

    a.json, b.json      records, written by turns; the one with more runs is newer
    default.json        optional: a record to begin with while no slot can be used, put there by a person
    refused/            files of slots that could not be used, under their SHA-256

A record is written to the slot that the run did not begin with: temporary file, fsync, rename. Therefore the record
that the law has begun with stays if the new one is lost.
"""

from __future__ import annotations

import errno
import hashlib
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from railhil.common.errors import InputError, Words
from railhil.common.user_files import check_writable, given_bytes, lock_within, sync_folder, write_synced
from railhil.scenarios.memory import (
    LINE_DEFAULT,
    SLOT_A,
    SLOT_B,
    BadRecord,
    Memory,
    MemoryPlace,
    MemoryRecord,
    load_memory,
    next_slot,
    read_record,
    sort_memory,
)

#: Place in a store -> file.
SLOT_FILES: Mapping[str, str] = {SLOT_A: "a.json", SLOT_B: "b.json", LINE_DEFAULT: "default.json"}
_REFUSED = "refused"
#: A write of another run takes milliseconds.
_LOCK_WAIT_S = 5.0
_DRAFTS = ".part-*"
_ALLOWED = "a folder in which railhil keeps the memory of a law"


class StoreChanged(Exception):
    """Another program has written the store since it was read."""


@dataclass(frozen=True)
class MemoryStore:
    """The folder; it need not exist yet.

    :param wait_s: how long to wait for another program that has locked it.
    """

    path: Path
    wait_s: float = _LOCK_WAIT_S

    def file(self, slot: str) -> Path:
        """File of a place."""
        return self.path / SLOT_FILES[slot]

    def read(self, law: str | None = None) -> Memory:
        """The stored records, the newest first, then unusable places. A store that does not exist is empty.

        :param law: the law that asks; None: the law of the records.
        :raises InputError: the path is no folder or not ours, or a record is of another law.
        """
        try:
            is_file = self.path.exists() and not self.path.is_dir()
        except PermissionError:
            raise InputError(self.path, "", Words("cannot be read: permission denied"), _ALLOWED) from None
        if is_file:
            hint = f"copy it to FOLDER/{SLOT_FILES[LINE_DEFAULT]} to go on from it"
            raise InputError(self.path, "", Words("is a file"), _ALLOWED, hint)
        found = [self._read_place(slot) for slot in SLOT_FILES]
        there = [one for one in found if one is not None]
        for one in there:
            law = law or (None if one.record is None else one.record.law)
            if one.record is not None and one.record.law != law:
                raise InputError(self.file(one.slot), "law", one.record.law, f"{law}, the law of this store")
        return sort_memory(law or "", there, self.path)

    def _read_place(self, slot: str) -> MemoryPlace | None:
        try:
            return MemoryPlace(slot, read_record(self.file(slot)))
        except BadRecord as bad:
            if bad.fault == "unreadable" and not os.path.lexists(self.file(slot)):
                return None
            return MemoryPlace(slot, None, bad.fault, bad.error.difference)

    def check_writable(self) -> None:
        """Check before a run that a record can be written after it; leaves nothing behind. Raises OSError."""
        there = next(place for place in (self.path, *self.path.resolve().parents) if place.exists())
        check_writable(there / "new.json")

    def write(self, record: MemoryRecord, began: Memory, used: str, refused: Mapping[str, str]) -> str:
        """Write the memory that a law has left; returns the slot.

        :param began: the memory that the run began with.
        :param used: the place of the record that its law has used; empty: none.
        :param refused: slots whose content its law has refused.
        :raises StoreChanged: the store has another content than ``began``; it is left as it is.
        :raises OSError: it cannot be written; the record that the law began with is still there.
        """
        with self._lock():
            if self.read(record.law).sha256 != began.sha256:
                raise StoreChanged(str(self.path))
            for one in began.stored:
                if one.slot != LINE_DEFAULT and (one.fault or one.slot in refused):
                    self._set_aside(one.slot)
            slot = next_slot(used)
            write_synced(self.file(slot), record.content)
        return slot

    @contextmanager
    def _lock(self) -> Iterator[None]:
        """Lock out other processes, and remove files of a killed one.

        :raises OSError: the folder cannot be made, or another program keeps it locked.
        """
        self.path.mkdir(parents=True, exist_ok=True)
        handle = os.open(self.path, os.O_RDONLY)
        try:
            if not lock_within(handle, self.wait_s):
                reason = f"locked by another program for {self.wait_s:g} s"
                raise OSError(errno.EAGAIN, reason, str(self.path))
            for draft in self.path.glob(_DRAFTS):
                draft.unlink()
            yield
        finally:
            os.close(handle)

    def _set_aside(self, slot: str) -> None:
        """Move the file of a slot to ``refused/``, where the user can examine it. Raises OSError."""
        file = self.file(slot)
        try:
            name = hashlib.sha256(given_bytes(file)).hexdigest()[:16]
        except (OSError, InputError):
            # It could not be read before either; a folder, a pipe or a broken link keeps its name.
            name = "unreadable"
        place = self.path / _REFUSED
        place.mkdir(exist_ok=True)
        file.replace(place / f"{slot.lower()}-{name}.json")
        sync_folder(place)
        sync_folder(self.path)


def read_memory(path: Path) -> Memory:
    """The memory of a file (:func:`railhil.scenarios.memory.load_memory`) or of a store.

    :raises InputError: there is none, or a file is damaged; one line.
    """
    if not path.is_dir():
        return load_memory(path)
    found = MemoryStore(path).read()
    if found.newest is None:
        bad = [f"slot {one.slot} cannot be used: {one.detail}" for one in found.stored]
        raise InputError(path, "", Words("; ".join(bad) or "has no record"), _ALLOWED)
    return found
