"""A folder of parts that are complete or missing, for work that survives any interruption.

Its manifest is also the lock. Used by campaigns and by ``railhil learn``.
"""

from __future__ import annotations

import errno
import fcntl
import json
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import pyarrow as pa

from railhil.campaign.results_table import NotThePart
from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.whole_file import DRAFTS, write_synced
from railhil.record.framelog import sha256_of
from railhil.record.hash_list import HASH_LIST, enter, read_hash_list, write_hash_list
from railhil.record.run_folder import RecordFailed, not_written, run_folder

PARTS = "parts"
RESULTS = "results.parquet"
SUMMARY = "summary.json"
#: Options that name a folder.
_OPTIONS = "--out, --resume"


class AnyChunk(Protocol):
    """The unit of work, of repetition and of loss: ``name`` of its part without suffix, and how many ``runs``."""

    @property
    def name(self) -> str: ...

    @property
    def runs(self) -> int: ...


C = TypeVar("C", bound=AnyChunk)


class PartsFolder(Generic[C]):
    """An open folder, locked for this process: see :func:`locked`.

    :param chunks: all that are wanted.
    :param read: the runs of a chunk from its file. Raises :class:`NotThePart`, OSError.
    """

    def __init__(self, path: Path, chunks: Sequence[C], read: Callable[[Path, C], pa.Table]) -> None:
        self.path = path
        self._chunks = chunks
        self._read = read
        #: As in the list; None in a folder of an earlier version, which has none.
        self._hashes = read_hash_list(path)
        # Left by a process that was killed while writing; no other process writes here now.
        for place in (path, path / PARTS):
            for draft in place.glob(DRAFTS):
                draft.unlink()

    def part(self, chunk: C) -> Path:
        """File of a chunk."""
        return self.path / PARTS / f"{chunk.name}.parquet"

    def read(self, chunk: C) -> pa.Table:
        """The runs of a chunk. Raises :class:`NotThePart`, OSError (FileNotFoundError: not made yet)."""
        path = self.part(chunk)
        table = self._read(path, chunk)
        if self._hashes is not None and self._hashes.get(path.relative_to(self.path).as_posix()) != sha256_of(path):
            raise NotThePart(f"not as listed in {HASH_LIST}")
        return table

    def _changed_results(self) -> Iterator[str]:
        """A sentence for each result that was changed since it was written, and that is made from the parts again."""
        for name in (RESULTS, SUMMARY):
            path, listed = self.path / name, (self._hashes or {}).get(name)
            if listed is not None and path.is_file() and sha256_of(path) != listed:
                yield f"{path} is not as listed in {HASH_LIST}: it is written again"

    def missing(self) -> tuple[list[C], list[str]]:
        """Chunks without a part, and a sentence for each file whose content did not match its name and that was
        removed."""
        left, complaints = [], list(self._changed_results())
        for chunk in self._chunks:
            try:
                self.read(chunk)
            except FileNotFoundError:
                left.append(chunk)
            except NotThePart as why:
                left.append(chunk)
                complaints.append(
                    f"{self.part(chunk)} is {why}: its {count_of(chunk.runs, 'run is', 'runs are')} made again"
                )
                self.part(chunk).unlink()
        return left, complaints

    @property
    def total(self) -> int:
        """Number of runs, once all parts are there."""
        return sum(chunk.runs for chunk in self._chunks)

    def kept(self) -> int:
        """Number of finished runs, once :meth:`missing` has checked all parts."""
        return sum(chunk.runs for chunk in self._chunks if self.part(chunk).exists())

    def write_part(self, name: str, content: bytes) -> None:
        """Write a part. Raises RecordFailed."""
        self.write(Path(PARTS) / f"{name}.parquet", content)

    def write_summary(self, document: dict[str, Any]) -> None:
        """Write ``summary.json``. Raises RecordFailed."""
        self.write(Path(SUMMARY), (json.dumps(document, indent=2, allow_nan=False) + "\n").encode())

    def write(self, name: Path, content: bytes) -> None:
        """Write a file of the folder, completely or not at all. Raises RecordFailed."""
        try:
            if self._hashes is not None:
                # Entered first: whatever is there after an interruption is listed.
                self._hashes = enter(self.path, self._hashes, name.as_posix(), content)
            write_synced(self.path / name, content)
        except OSError as error:
            # Whatever the reason: the folder was writable before.
            why = (error.strerror or str(error)).lower()
            raise RecordFailed(f"{self.path / name} cannot be written: {why}") from error


def check_same(path: Path, kind: str, recorded: dict[str, Any], ours: dict[str, Any]) -> None:
    """Refuse to mix the work of two requests.

    :param path: the manifest.
    :param kind: what is in the folder, such as ``campaign``.
    :param recorded: identity in the manifest.
    :param ours: identity of what is asked for.
    :raises InputError: naming the first difference.
    """
    ours = json.loads(json.dumps(ours))
    for key in sorted(ours | recorded):
        if ours.get(key) != recorded.get(key):
            found, now = (json.dumps(side.get(key)) for side in (recorded, ours))
            allowed = f"{now} to go on with it; another --out begins a new {kind}"
            raise InputError(path, f"{kind}.{key}", Words(found), allowed)


def _claim(descriptor: int, path: Path, kind: str) -> None:
    """Lock what is open (flock), until it is closed or the process ends in whatever way.

    :raises InputError: another process has it.
    """
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
            raise not_written(_OPTIONS, path, "folder", error) from error
        found = Words(f"a {kind} that is running there")
        raise InputError(path, "", found, "one process at a time") from None


@contextmanager
def claimed(path: Path, kind: str) -> Iterator[None]:
    """Exclusive access to a folder whose manifest is written anew again and again: the folder itself is locked.

    :raises InputError: another process has it, or it cannot be opened.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    except OSError as error:
        raise not_written(_OPTIONS, path, "folder", error) from error
    try:
        _claim(descriptor, path, kind)
        yield
    finally:
        os.close(descriptor)


@contextmanager
def locked(
    out: str | None,
    names: tuple[str, str],
    kind: str,
    manifest: str,
    document: dict[str, Any],
    check: Callable[[Path], None],
) -> Iterator[Path]:
    """Begin work in a new or empty folder, or resume that in it, with exclusive access.

    The lock (flock on the manifest) is released when the process ends, in whatever way.

    :param out: the folder; None: ``runs/<utc>-<names>/``.
    :param names: of the scenario, and of the command.
    :param kind: what is in the folder, such as ``campaign``.
    :param manifest: name of the manifest; ``document``: its content for new work.
    :param check: refuses a folder with other work (InputError).
    :raises InputError: the folder contains something else or other work, is not writable, or is in use.
    :raises RecordFailed: the disk is full.
    """
    if out is None or not (Path(out) / manifest).exists():
        path, _ = run_folder(out, *names)
    else:
        path = Path(out)
    try:
        handle = os.open(path / manifest, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise not_written(_OPTIONS, path, "folder", error) from error
    with os.fdopen(handle, "r+b") as stream:
        _claim(stream.fileno(), path, kind)
        try:
            # A process killed at this point leaves an empty or incomplete manifest, and no part.
            if not (path / PARTS).exists() and not _is_json(stream.read()):
                stream.seek(0)
                stream.truncate()
                stream.write((json.dumps(document, indent=2) + "\n").encode())
                stream.flush()
                os.fsync(stream.fileno())
            if not (path / PARTS).exists() and not (path / HASH_LIST).exists():
                write_hash_list(path, only=[manifest])
            check(path)
            (path / PARTS).mkdir(exist_ok=True)
        except OSError as error:
            raise not_written(_OPTIONS, path, "folder", error) from error
        yield path


def _is_json(content: bytes) -> bool:
    try:
        json.loads(content)
    except ValueError:
        return False
    return True
