"""The folders of runs and studies below a directory."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from railhil.common.errors import InputError, Words, describe_os_error
from railhil.judge.events.event import EVENTS
from railhil.record.documents import CERTIFICATE, PARTS, SCORE, SUMMARY
from railhil.record.framelog import LOG_NAME
from railhil.record.hash_list import DOCUMENTS, HASH_LIST, REPORT, SIGNATURE

#: The folder of the index, in the directory whose folders it has.
INDEX = ".railhil-index"
#: The kind of the folder of a run; the kind of every other folder is the name of its document.
RUN = "run"
#: Files whose contents are in the index, and those that say something by being there.
_READ = (*DOCUMENTS, SCORE, SUMMARY, EVENTS, HASH_LIST, SIGNATURE, REPORT, LOG_NAME)
#: What tells when a folder was made: its certificate, its name, or only the date of a file, which a copy changes.
RECORDED, NAME, FILE = "certificate", "name", "file"
#: The instant with which names of usual folders begin (:func:`railhil.record.run_folder.run_folder`).
_STAMP = re.compile(r"(\d{8}T\d{6}Z)-")


@dataclass(frozen=True, slots=True)
class Found:
    """One folder.

    ``folder``: below the directory, with ``/``; ``.`` for the directory itself. ``document``: the file that marks it as
    complete; empty: a run that did not come to its end. ``stamp``: differs when a file has changed that the index has
    read. ``made``: begin of the run or study where the name of the folder tells it, else the date of the document;
    ``dated_by``: which of both, :data:`NAME` or :data:`FILE`. ``names``: its files among those that the index knows.
    """

    folder: str
    document: str
    stamp: str
    made: datetime
    dated_by: str
    names: frozenset[str]

    @property
    def kind(self) -> str:
        """``run``, or the name of its document."""
        return RUN if self.document in ("", CERTIFICATE) else self.document.removesuffix(".json")


def find_folders(root: Path) -> tuple[list[Found], list[str]]:
    """All folders in the order of their names, and a sentence for each directory that cannot be read.

    Symbolic links are not followed.

    :raises InputError: there is no such directory.
    """
    allowed = "a directory with run folders"
    if not root.is_dir():
        raise InputError(root, "", Words("is no directory" if root.exists() else "does not exist"), allowed)
    unread: list[str] = []
    found: list[Found] = []
    # No recursion: folders may be nested deeper than calls of Python.
    places = [""]
    while places:
        below = places.pop()
        found += _look(root / below, below, unread, places)
    return sorted(found, key=lambda one: one.folder), unread


def has_runs_below(folder: Path) -> bool:
    """Whether a directory is shown by its index: it is no run and no sequence, and has folders of runs below it."""
    if not folder.is_dir() or any((folder / name).is_file() for name in (LOG_NAME, CERTIFICATE, "sequence.json")):
        return False
    return any(one.folder != "." for one in find_folders(folder)[0])


def _look(place: Path, below: str, unread: list[str], places: list[str]) -> Iterator[Found]:
    """The folder itself.

    :param unread: gets a sentence on what cannot be read. :param places: gets the folders in it.
    """
    files: dict[str, os.stat_result] = {}
    try:
        with os.scandir(place) as entries:
            for entry in entries:
                if entry.is_dir(follow_symlinks=False):
                    if entry.name != PARTS and not entry.name.startswith("."):
                        _enter(place, below, entry.name, unread, places)
                elif entry.name in _READ:
                    try:
                        files[entry.name] = entry.stat()
                    except OSError as error:
                        # A link that leads nowhere hides neither the other files nor the folders beside it.
                        unread.append(f"{place / entry.name} cannot be read: {describe_os_error(error)}")
    except OSError as error:
        unread.append(f"{place} cannot be read: {describe_os_error(error)}")
        return
    document = next((name for name in DOCUMENTS if name in files), "")
    if document or LOG_NAME in files:
        yield _found(place.name, below or ".", document, files)


def _enter(place: Path, below: str, name: str, unread: list[str], places: list[str]) -> None:
    try:
        name.encode()
    except UnicodeEncodeError:
        shown = name.encode(errors="backslashreplace").decode()
        unread.append(f"{place}/{shown} is left out: its name is not UTF-8 text")
        return
    places.append(f"{below}/{name}" if below else name)


def _found(name: str, below: str, document: str, files: Mapping[str, os.stat_result]) -> Found:
    # The log of a finished run is not read, and a page is only linked.
    read = {one: found for one, found in files.items() if one != REPORT and (one != LOG_NAME or not document)}
    # Who edits a file can set its date, but not that of its entry in the file system.
    stamp = " ".join(
        f"{one}:{found.st_mtime_ns}:{found.st_ctime_ns}:{found.st_size}" for one, found in sorted(read.items())
    )
    made, dated_by = _begin(name), NAME
    if made is None:
        made, dated_by = datetime.fromtimestamp(files[document or LOG_NAME].st_mtime, UTC), FILE
    names = frozenset(one for one, found in files.items() if stat.S_ISREG(found.st_mode))
    return Found(below, document, f"{stamp} {REPORT in files}", made, dated_by, names)


def _begin(name: str) -> datetime | None:
    """The instant in the name of a usual folder; None: there is none."""
    begun = _STAMP.match(name)
    try:
        return datetime.strptime(begun[1], "%Y%m%dT%H%M%SZ").replace(tzinfo=UTC) if begun else None
    except ValueError:
        # Digits that are no instant.
        return None
