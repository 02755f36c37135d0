"""The folder of a campaign: the manifest, which also serves as the lock, and parts that are complete or missing."""

from __future__ import annotations

import errno
import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pyarrow as pa

from railhil.campaign.manifest import MANIFEST, manifest, read_manifest
from railhil.campaign.plan import Chunk, Plan
from railhil.campaign.results_table import NotThePart, file_bytes, read_part
from railhil.campaign.work import origin_of
from railhil.common.errors import InputError, Words
from railhil.common.whole_file import whole_file
from railhil.supervisor.errors import RecordFailed, not_written
from railhil.supervisor.folder import run_folder

PARTS = "parts"
RESULTS = "results.parquet"
SUMMARY = "summary.json"
_DRAFTS = ".part-*"
#: Options that name a folder.
_OPTIONS = "--out, --resume"


def write_synced(path: Path, content: bytes) -> None:
    """Write a file atomically so that it survives a power cut. Raises OSError."""
    with whole_file(path) as draft, draft.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


class CampaignFolder:
    """An open campaign folder, locked for this process: see :func:`opened`."""

    def __init__(self, path: Path, plan: Plan) -> None:
        self.path = path
        self._plan = plan
        (path / PARTS).mkdir(exist_ok=True)
        # Left by a process that was killed while writing; no other process writes here now.
        for place in (path, path / PARTS):
            for draft in place.glob(_DRAFTS):
                draft.unlink()

    def part(self, chunk: Chunk) -> Path:
        """File of a chunk."""
        return self.path / PARTS / f"{chunk.name}.parquet"

    def read(self, chunk: Chunk) -> pa.Table:
        """The runs of a chunk. Raises :class:`NotThePart`, OSError (FileNotFoundError: not made yet)."""
        return read_part(
            self.part(chunk), origin_of(self._plan, chunk), chunk.entry.label, chunk.seeds, self._plan.judging
        )

    def missing(self) -> tuple[list[Chunk], list[str]]:
        """Chunks without a part, and a sentence for each file whose content did not match its name and that was
        removed."""
        left, complaints = [], []
        for chunk in self._plan.chunks():
            try:
                self.read(chunk)
            except FileNotFoundError:
                left.append(chunk)
            except NotThePart as why:
                left.append(chunk)
                complaints.append(f"{self.part(chunk)} is {why}: its {chunk.runs} runs are made again")
                self.part(chunk).unlink()
        return left, complaints

    def kept(self) -> int:
        """Number of finished runs, once :meth:`missing` has checked all parts."""
        return sum(chunk.runs for chunk in self._plan.chunks() if self.part(chunk).exists())

    def write_part(self, name: str, content: bytes) -> None:
        """Write a part. Raises RecordFailed."""
        self._write(Path(PARTS) / f"{name}.parquet", content)

    def write_results(self) -> pa.Table:
        """Join all parts into ``results.parquet``, sorted by law and seed.

        :raises NotThePart: a part was damaged after it was written.
        :raises RecordFailed: the file cannot be written.
        """
        chunks = sorted(self._plan.chunks(), key=lambda chunk: (chunk.entry.label, chunk.index))
        table = pa.concat_tables([self.read(chunk).replace_schema_metadata() for chunk in chunks])
        self._write(Path(RESULTS), file_bytes(table, self._plan.subject_sha256))
        return table

    def write_summary(self, document: dict[str, Any]) -> None:
        """Write ``summary.json``. Raises RecordFailed."""
        self._write(Path(SUMMARY), (json.dumps(document, indent=2, allow_nan=False) + "\n").encode())

    def _write(self, name: Path, content: bytes) -> None:
        try:
            write_synced(self.path / name, content)
        except OSError as error:
            # Whatever the reason: the folder was writable before.
            why = (error.strerror or str(error)).lower()
            raise RecordFailed(f"{self.path / name} cannot be written: {why}") from error


def _check_same(path: Path, recorded: dict[str, Any], plan: Plan) -> None:
    """Refuse to mix two campaigns. Raises InputError naming the first difference."""
    ours = json.loads(json.dumps(plan.identity))
    for key in sorted(ours | recorded):
        if ours.get(key) != recorded.get(key):
            found, now = (json.dumps(side.get(key)) for side in (recorded, ours))
            raise InputError(
                path, f"campaign.{key}", Words(found), f"{now} to go on with it; another --out begins a new campaign"
            )


@contextmanager
def opened(out: str | None, plan: Plan) -> Iterator[CampaignFolder]:
    """Begin a campaign in a new or empty folder, or resume the one in it, with exclusive access.

    The lock (flock on the manifest) is released when the process ends, in whatever way.

    :param out: the folder; None: ``runs/<utc>-<scenario>-campaign/``.
    :raises InputError: the folder contains something else or a different campaign, is not writable, or is in use.
    :raises RecordFailed: the disk is full.
    """
    if out is None or not (Path(out) / MANIFEST).exists():
        path, _ = run_folder(out, plan.scenario.name, "campaign")
    else:
        path = Path(out)
    file = path / MANIFEST
    try:
        handle = os.open(file, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise not_written(_OPTIONS, path, "folder", error) from error
    with os.fdopen(handle, "r+b") as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
                raise not_written(_OPTIONS, path, "folder", error) from error
            raise InputError(path, "", Words("a campaign that is running there"), "one process at a time") from None
        try:
            # A process killed at this point leaves an empty or incomplete manifest, and no part.
            if not (path / PARTS).exists() and not _is_json(stream.read()):
                stream.seek(0)
                stream.truncate()
                stream.write((json.dumps(manifest(plan), indent=2) + "\n").encode())
                stream.flush()
                os.fsync(stream.fileno())
            _check_same(file, read_manifest(path).campaign, plan)
            folder = CampaignFolder(path, plan)
        except OSError as error:
            raise not_written(_OPTIONS, path, "folder", error) from error
        yield folder


def _is_json(content: bytes) -> bool:
    try:
        json.loads(content)
    except ValueError:
        return False
    return True
