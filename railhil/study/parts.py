"""The folder of a study: its manifest, which is also the lock, and parts that are complete or missing.

Either one process has the folder, or any number of processes that make a shard each (``--shard K/N``). A part is
complete or missing, and every process makes the same bytes of it, so shards are independent of each other: their
folders may also be on different machines, and be copied into one. A shard lists the hashes of its parts in
``parts/shard-K-of-N.sha256``; the process that joins all parts enters them into ``SHA256SUMS``.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, Any, Generic

import pyarrow as pa

from railhil.common.digits import count_of
from railhil.common.errors import InputError, describe_os_error
from railhil.common.user_files import DRAFTS, RecordFailed, refuse_unwritable, sync_folder, write_synced
from railhil.record.documents import PARTS, SUMMARY
from railhil.record.framelog import sha256_of
from railhil.record.hash_list import HASH_LIST, enter, read_hash_list, write_hash_list, write_hashes
from railhil.record.run_folder import run_folder
from railhil.study.claim import FOLDER_OPTIONS, claim
from railhil.study.manifest import check_same, manifest_of, read_manifest
from railhil.study.plan import C, P, Shard, Study, sha256_of_json
from railhil.study.table import RESULTS, NotThePart, file_bytes, read_part

_SHARD_LISTS = "shard-*.sha256"
_LINE = re.compile(r"([0-9a-f]{64})  ([^\n]+)\n")


class ShardLists:
    """The lists of the shards of a folder: a line for each part, before it is written, and first the study's identity.

    :raises InputError: a list is of another plan or other code.
    """

    def __init__(self, parts: Path, head: str) -> None:
        self.files = sorted(parts.glob(_SHARD_LISTS))
        self._hashes: dict[str, set[str]] = {}
        for file in self.files:
            first, *lines = file.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True) or [""]
            # The first line is torn: the shard has made no part.
            if first.endswith("\n") and first != head:
                allowed = f"{head.strip()}: shards of one plan, made by one code"
                raise InputError(file, "line 1", first.strip(), allowed)
            for match in filter(None, map(_LINE.fullmatch, lines)):
                self._hashes.setdefault(match[2], set()).add(match[1])

    def has(self, name: str, sha256: str) -> bool:
        """Whether a shard has listed this file with this hash."""
        return sha256 in self._hashes.get(name, ())

    def existing(self, folder: Path) -> dict[str, str]:
        """Hashes of the listed files that exist as listed."""
        found = {name: sha256_of(folder / name) for name in sorted(self._hashes) if (folder / name).is_file()}
        return {name: sha256 for name, sha256 in found.items() if self.has(name, sha256)}


class PartsFolder(Generic[P, C]):
    """An open folder, locked for this process or for its shard: see :func:`opened`."""

    def __init__(self, path: Path, study: Study[P, C], plan: P, shard: Shard | None, listed: IO[bytes] | None) -> None:
        self.path, self._study, self._plan, self._listed = path, study, plan, listed
        self._all = plan.chunks()
        self._chunks = self._all if shard is None else shard.of(self._all)
        self._shards = ShardLists(path / PARTS, _head(study, plan))
        #: Hashes of the list; None in a folder of an earlier version, which has no list.
        self._hashes = read_hash_list(path)
        if shard is None:
            # The file was left by a process that was killed while writing; no other process writes here now.
            for place in (path, path / PARTS):
                for draft in place.glob(DRAFTS):
                    draft.unlink()
            self._take_over()

    def _take_over(self) -> None:
        """Enter the parts of the shards into the list of the folder. Raises RecordFailed."""
        if not self._shards.files:
            return
        with self._writing(self.path / HASH_LIST):
            if self._hashes is not None:
                self._hashes |= self._shards.existing(self.path)
                write_hashes(self.path, self._hashes)
            for file in self._shards.files:
                file.unlink()

    def part(self, chunk: C) -> Path:
        """File of a chunk."""
        return self.path / PARTS / f"{chunk.name}.parquet"

    def read(self, chunk: C) -> pa.Table:
        """The rows of a chunk. Raises :class:`NotThePart`, OSError (FileNotFoundError: not made yet)."""
        path = self.part(chunk)
        table = read_part(path, self._study, self._plan, chunk)
        if self._hashes is not None:
            name, sha256 = path.relative_to(self.path).as_posix(), sha256_of(path)
            if self._hashes.get(name) != sha256 and not self._shards.has(name, sha256):
                raise NotThePart(f"not as listed in {HASH_LIST}")
        return table

    def _changed_results(self) -> Iterator[str]:
        """A sentence for each result that was changed after it was written, and is made from the parts again."""
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
                unit = self._study.unit
                lost = count_of(chunk.runs, f"{unit} is", f"{unit}s are")
                complaints.append(f"{self.part(chunk)} is {why}: its {lost} made again")
                self.part(chunk).unlink()
        return left, complaints

    @property
    def total(self) -> int:
        """Number of runs, once all parts are there."""
        return sum(chunk.runs for chunk in self._chunks)

    def kept(self) -> int:
        """Number of finished runs, once :meth:`missing` has checked all parts."""
        return sum(chunk.runs for chunk in self._chunks if self.part(chunk).exists())

    def is_whole(self) -> bool:
        """Whether every part of the study is there, also those of other shards."""
        return all(self.part(chunk).exists() for chunk in self._all)

    def leading(self) -> int:
        """How many parts are there without a gap, from the first one on."""
        return next((place for place, chunk in enumerate(self._all) if not self.part(chunk).exists()), len(self._all))

    def cut(self) -> None:
        """Make the study one of its leading parts; parts behind a gap are removed. Raises RecordFailed."""
        assert self._study.cut is not None
        count = self.leading()
        surplus = [self.part(chunk) for chunk in self._all[count:] if self.part(chunk).exists()]
        with self._writing(self.path / HASH_LIST):
            for path in surplus:
                path.unlink()
            if self._hashes is not None:
                names = {path.relative_to(self.path).as_posix() for path in surplus}
                self._hashes = {name: sha256 for name, sha256 in self._hashes.items() if name not in names}
                write_hashes(self.path, self._hashes)
        self._plan = self._study.cut(self._plan, count)
        self._all = self._chunks = self._plan.chunks()

    def write_manifest(self) -> None:
        """Write the manifest of a study that was :meth:`cut`. It is written last, because it holds the lock."""
        self._write(Path(self._study.manifest), _manifest_bytes(self._study, self._plan))

    def write_part(self, name: str, content: bytes) -> None:
        """Write a part. Raises RecordFailed."""
        self._write(Path(PARTS) / f"{name}.parquet", content)

    def write_results(self) -> tuple[pa.Table, dict[str, Any]]:
        """Join all parts into ``results.parquet`` and summarise them in ``summary.json``.

        :raises NotThePart: a part was damaged after it was written.
        :raises RecordFailed: a file cannot be written.
        """
        table = pa.concat_tables([self.read(chunk).replace_schema_metadata() for chunk in self._all])
        self._write(Path(RESULTS), file_bytes(table, self._plan.results_origin))
        found = self._study.summary(self._plan, table)
        self._write(Path(SUMMARY), (json.dumps(found, indent=2, allow_nan=False) + "\n").encode())
        return table, found

    def _write(self, name: Path, content: bytes) -> None:
        """Write a file of the folder, completely or not at all. Raises RecordFailed."""
        with self._writing(self.path / name):
            # The hash is entered first, so that any file left by an interruption is listed.
            if self._listed is not None:
                self._listed.write(f"{hashlib.sha256(content).hexdigest()}  {name.as_posix()}\n".encode())
                _flush(self._listed)
            elif self._hashes is not None:
                self._hashes = enter(self.path, self._hashes, name.as_posix(), content)
            write_synced(self.path / name, content)

    @contextmanager
    def _writing(self, path: Path) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            # The reason does not matter: the folder was writable before.
            why = describe_os_error(error)
            raise RecordFailed(f"{path} cannot be written: {why}") from error


def _flush(stream: IO[bytes]) -> None:
    stream.flush()
    os.fsync(stream.fileno())


def _head(study: Study[P, C], plan: P) -> str:
    """First line of the list of a shard; ``sha256sum -c`` passes over it."""
    return f"# {study.kind} {sha256_of_json(plan.identity)}\n"


@contextmanager
def opened(
    study: Study[P, C], plan: P, out: str | None, shard: Shard | None = None, wait_s: float = 0.0
) -> Iterator[PartsFolder[P, C]]:
    """Begin a study in a new or empty folder, or resume the one in it.

    The lock (flock on the manifest) is released when the process ends, in whatever way.

    :param out: the folder; None: ``runs/<utc>-<scenario>-<kind>/``.
    :param shard: that this process makes, beside others; None: it has the folder alone.
    :param wait_s: time to wait for other processes. :raises InputError: the folder contains something else or another
        study, or is not writable.
    :raises InUse: it is in use.
    :raises RecordFailed: the disk is full.
    """
    path = _study_folder(study, plan, out, shard)
    with ExitStack() as held:
        with refuse_unwritable(FOLDER_OPTIONS, path, "folder"):
            handle = os.open(path / study.manifest, os.O_RDWR | os.O_CREAT, 0o666)
        stream = held.enter_context(os.fdopen(handle, "r+b"))
        claim(stream.fileno(), path, study.kind, fcntl.LOCK_EX if shard is None else fcntl.LOCK_SH, wait_s)
        listed: IO[bytes] | None = None
        with refuse_unwritable(FOLDER_OPTIONS, path, "folder"):
            is_begun = (path / PARTS).exists()
            # A process killed at this point leaves an empty or incomplete manifest, and no part.
            if shard is None and not is_begun and not _is_json(stream.read()):
                stream.seek(0)
                stream.truncate()
                stream.write(_manifest_bytes(study, plan))
                _flush(stream)
            if not is_begun and not (path / HASH_LIST).exists():
                write_hash_list(path, only=[study.manifest])
            check_same(study, path, read_manifest(path, study).identity, plan.identity)
            (path / PARTS).mkdir(exist_ok=True)
            if shard is not None:
                listed = held.enter_context(_shard_list(path, study, plan, shard))
        yield PartsFolder(path, study, plan, shard, listed)


def _study_folder(study: Study[P, C], plan: P, out: str | None, shard: Shard | None) -> Path:
    """The folder; with its manifest if it is for a shard.

    :raises InputError: it has other contents, or cannot be written.
    """
    if out is not None and (Path(out) / study.manifest).exists():
        return Path(out)
    if out is None or shard is None:
        return run_folder(out, plan.scenario.name, study.name)[0]
    path = Path(out)
    with refuse_unwritable(FOLDER_OPTIONS, path, "folder"):
        path.mkdir(parents=True, exist_ok=True)
        names = {item.name for item in path.iterdir() if not item.match(DRAFTS)}
        if names - {study.manifest, HASH_LIST, PARTS}:
            raise InputError("command line", "--out", out, "an empty or new folder")
        _make_manifest(path / study.manifest, _manifest_bytes(study, plan))
    return path


def _make_manifest(path: Path, content: bytes) -> None:
    """Make a complete file or none, unless it exists already: shards may begin at the same instant.

    :raises OSError: it cannot be written.
    """
    handle, draft = tempfile.mkstemp(prefix=DRAFTS.rstrip("*"), dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            _flush(stream)
        with suppress(FileExistsError):
            os.link(draft, path)
    finally:
        os.unlink(draft)


def _manifest_bytes(study: Study[P, C], plan: P) -> bytes:
    return (json.dumps(manifest_of(study, plan), indent=2) + "\n").encode()


@contextmanager
def _shard_list(path: Path, study: Study[P, C], plan: P, shard: Shard) -> Iterator[IO[bytes]]:
    """The list of a shard, locked for this process; it only grows. Raises InUse, OSError."""
    file, head = path / PARTS / f"shard-{shard.number}-of-{shard.count}.sha256", _head(study, plan).encode()
    with file.open("a+b") as stream:
        claim(stream.fileno(), path, f"{study.kind} of shard {shard}")
        stream.seek(0)
        content = stream.read()
        if b"\n" not in content:
            stream.truncate(0)
            stream.write(head)
        elif not content.endswith(b"\n"):
            # A torn line ends here; it belongs to no part.
            stream.write(b"\n")
        _flush(stream)
        sync_folder(file.parent)
        yield stream


def _is_json(content: bytes) -> bool:
    try:
        json.loads(content)
    except ValueError:
        return False
    return True
