"""The folder of a run before its record is there: made at the start, removed if the run never began."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from railhil.common.errors import InputError
from railhil.record.errors import not_written

#: Names in the run folder of what the nodes leave there: the controller its telemetry, the plant its timing.
TELEMETRY, TIMING = "telemetry.json", "timing.csv"
#: Free disk space required to begin a run: for the output of the nodes and the beginning of the log. A run of 3 min
#: takes 6 MB.
ROOM_MIN_BYTES = 128 * 1024


def run_folder(out: str | Path | None, scenario: str, controller: str) -> tuple[Path, bool]:
    """Make the folder of a new run.

    :param out: the folder itself if the user names one; it must be empty or not exist.
    :returns: the folder, and whether it was created here.
    :raises InputError: the named folder is not empty, cannot be created or cannot be written.
    :raises RecordFailed: there is not enough disk space.
    """
    if out is not None and not str(out).strip():
        raise InputError("command line", "--out", str(out), "name of an empty or new folder")
    stamp = time.strftime("%Y%m%dT%H%M%SZ", time.gmtime())
    folder = Path(out) if out is not None else Path("runs") / f"{stamp}-{scenario}-{controller}"
    made = False
    try:
        made = out is None or not folder.exists()
        if out is None:
            folder = _new_folder(folder)
        else:
            folder.mkdir(parents=True, exist_ok=True)
        occupied = any(folder.iterdir())
        # Leaves nothing behind; a check of permissions would not detect a read-only or full file system.
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(bytes(ROOM_MIN_BYTES))
            probe.flush()
    except OSError as error:
        if made and folder.is_dir():
            folder.rmdir()
        raise not_written("--out", folder, "folder", error) from None
    if occupied:
        raise InputError("command line", "--out", str(folder), "an empty or new folder")
    return folder, made


def _new_folder(wanted: Path) -> Path:
    """Create a folder of this name, with a number appended if it exists: runs started in the same second never share
    one."""
    wanted.parent.mkdir(parents=True, exist_ok=True)
    folder, serial = wanted, 1
    while True:
        try:
            folder.mkdir()
        except FileExistsError:
            serial += 1
            folder = wanted.with_name(f"{wanted.name}-{serial}")
        else:
            return folder


def discard_folder(folder: Path, made: bool) -> None:
    """Remove what a run that never began has left: the files, and the folder itself if it was created for the run."""
    for path in folder.iterdir():
        path.unlink()
    if made:
        folder.rmdir()
