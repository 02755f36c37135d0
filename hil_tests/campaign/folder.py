"""The folder of a campaign: the manifest, which is the lock too, and parts that exist whole or not at all."""

from __future__ import annotations

import errno
import fcntl
import json
import os
import platform
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pyarrow as pa

from bus.wholefile import whole_file
from hil_tests.campaign.plan import Chunk, Plan, Request
from hil_tests.campaign.table import NotThePart, file_bytes, read_part
from hil_tests.campaign.work import origin_of
from scenarios.canonical import canonical_json
from scenarios.errors import InputError, Words
from supervisor.folder import run_folder

MANIFEST = "campaign.json"
PARTS = "parts"
RESULTS = "results.parquet"
SUMMARY = "summary.json"
_FORMAT = 1
_DRAFTS = ".part-*"
_LIBRARIES = ("numpy", "numba", "pyarrow", "scipy")


class Unwritable(InputError):
    """The folder cannot be written (any more)."""

    def __init__(self, path: Path, error: OSError) -> None:
        why = (error.strerror or str(error)).lower()
        super().__init__(path, "", Words(why), "a folder that can be written; what is there goes on with --resume")


def read_manifest(folder: Path) -> dict[str, Any]:
    """``campaign.json`` of a folder.

    :raises InputError: there is none, or it is none.
    """
    path = folder / MANIFEST
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(path, "", Words((error.strerror or str(error)).lower()), "folder of a campaign") from None
    except ValueError:
        raise InputError(path, "", Words("no JSON"), "what `railhil campaign` has written") from None
    if not isinstance(document, dict) or document.get("format") != _FORMAT:
        raise InputError(path, "format", Words("something else"), f"{_FORMAT}, of a campaign of this railhil")
    return document


def request_of(folder: Path) -> Request:
    """The request that a folder's campaign began with. Raises InputError."""
    try:
        return Request.of(read_manifest(folder)["request"])
    except (KeyError, TypeError, AttributeError) as error:
        raise InputError(folder / MANIFEST, "request", Words(str(error)), "what a campaign has written") from None


def manifest(plan: Plan) -> dict[str, Any]:
    """Content of ``campaign.json``: ``campaign`` is what a continuation must repeat, the rest explains it."""
    return {
        "format": _FORMAT,
        "railhil": version("railhil"),
        "campaign": plan.identity,
        "request": plan.request_document(),
        "scenario": json.loads(canonical_json(plan.scenario)),
        "parameters": {
            entry.label: dict(entry.parameters.values) for entry in plan.entries if entry.parameters is not None
        },
        "machine": {"python": platform.python_version(), "system": platform.system(), "machine": platform.machine()},
        "libraries": {name: version(name) for name in _LIBRARIES},
    }


def write_synced(path: Path, content: bytes) -> None:
    """Write a file whole, and make it outlive a power cut. Raises OSError."""
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
        # Of a process that was killed while it wrote; nobody else writes here now.
        for place in (path, path / PARTS):
            for draft in place.glob(_DRAFTS):
                draft.unlink()

    def part(self, chunk: Chunk) -> Path:
        """File of a chunk."""
        return self.path / PARTS / f"{chunk.name}.parquet"

    def read(self, chunk: Chunk) -> pa.Table:
        """The runs of a chunk. Raises :class:`NotThePart`, OSError (FileNotFoundError: not made yet)."""
        return read_part(self.part(chunk), origin_of(self._plan, chunk), chunk.entry.label, chunk.seeds)

    def missing(self) -> tuple[list[Chunk], list[str]]:
        """Chunks that have no part yet, and a sentence for each file that was not what its name says: it is gone."""
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
        """Number of runs that are safe, once :meth:`missing` has looked at all parts."""
        return sum(chunk.runs for chunk in self._plan.chunks() if self.part(chunk).exists())

    def write_part(self, name: str, content: bytes) -> None:
        """Put a part in its place. Raises :class:`Unwritable`."""
        self._write(Path(PARTS) / f"{name}.parquet", content)

    def write_results(self) -> pa.Table:
        """Join all parts into ``results.parquet``, sorted by law and seed.

        :raises NotThePart: a part has gone bad since it was written.
        """
        chunks = sorted(self._plan.chunks(), key=lambda chunk: (chunk.entry.label, chunk.index))
        table = pa.concat_tables([self.read(chunk).replace_schema_metadata() for chunk in chunks])
        self._write(Path(RESULTS), file_bytes(table, self._plan.subject_sha256))
        return table

    def write_summary(self, document: dict[str, Any]) -> None:
        """Write ``summary.json``. Raises :class:`Unwritable`."""
        self._write(Path(SUMMARY), (json.dumps(document, indent=2, allow_nan=False) + "\n").encode())

    def _write(self, name: Path, content: bytes) -> None:
        try:
            write_synced(self.path / name, content)
        except OSError as error:
            raise Unwritable(self.path / name, error) from error


def _check_same(path: Path, recorded: Any, plan: Plan) -> None:
    """Refuse to mix two campaigns. Raises InputError naming the first difference."""
    ours = json.loads(json.dumps(plan.identity))
    if not isinstance(recorded, dict):
        raise InputError(path, "campaign", recorded, "what a campaign has written")
    for key in sorted(ours | recorded):
        if ours.get(key) != recorded.get(key):
            found, now = (json.dumps(side.get(key)) for side in (recorded, ours))
            raise InputError(
                path, f"campaign.{key}", Words(found), f"{now} to go on with it; another --out begins a new campaign"
            )


@contextmanager
def opened(out: str | None, plan: Plan) -> Iterator[CampaignFolder]:
    """Begin a campaign in a new or empty folder, or go on with the one that is there; nobody else may meanwhile.

    The lock (flock on the manifest) ends with the process, however it ends.

    :param out: the folder; None: ``runs/<utc>-<scenario>-campaign/``.
    :raises InputError: the folder holds something else, or a campaign that differs, cannot be written, or is in use.
    """
    if out is None or not (Path(out) / MANIFEST).exists():
        path, _ = run_folder(out, plan.scenario.name, "campaign")
    else:
        path = Path(out)
    file = path / MANIFEST
    try:
        handle = os.open(file, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise Unwritable(file, error) from error
    with os.fdopen(handle, "r+", encoding="utf-8") as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
                raise Unwritable(file, error) from error
            raise InputError(path, "", Words("a campaign that is running there"), "one process at a time") from None
        try:
            # A process that was killed right here has left an empty or torn manifest, and no part.
            if not (path / PARTS).exists() and not _is_json(stream.read()):
                stream.seek(0)
                stream.truncate()
                json.dump(manifest(plan), stream, indent=2)
                stream.write("\n")
                stream.flush()
                os.fsync(stream.fileno())
            _check_same(file, read_manifest(path).get("campaign"), plan)
            folder = CampaignFolder(path, plan)
        except OSError as error:
            raise Unwritable(path, error) from error
        yield folder


def _is_json(text: str) -> bool:
    try:
        json.loads(text)
    except ValueError:
        return False
    return True
