"""The folder for the socket of a run's own hub: it is removed after the run, or at the next start if the run was
killed.

Whether a folder is still in use is determined by a lock, which the kernel releases with the process, and not by a
process number, because containers that share /tmp have different ones.
"""

from __future__ import annotations

import fcntl
import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_PREFIX = "railhil-run-"
_LOCK = "lock"
_SOCKET = "hub.sock"
#: The only files in such a folder; ``_DRAFT`` is the lock file before it is locked.
_DRAFT = "lock.new"


@contextmanager
def private_socket() -> Iterator[Path]:
    """Path for the socket of a hub, in a folder that only this user can enter and that is removed afterwards.

    :raises OSError: no folder can be made.
    """
    _remove_stale(Path(tempfile.gettempdir()))
    folder = Path(tempfile.mkdtemp(prefix=_PREFIX))
    lock = os.open(folder / _DRAFT, os.O_CREAT | os.O_EXCL | os.O_RDWR | os.O_CLOEXEC, 0o600)
    try:
        # Only a locked file gets the name that other processes look for.
        fcntl.flock(lock, fcntl.LOCK_EX)
        (folder / _DRAFT).rename(folder / _LOCK)
        yield folder / _SOCKET
    finally:
        _remove(folder)
        os.close(lock)


def _remove(folder: Path) -> None:
    for name in (_SOCKET, _LOCK, _DRAFT):
        (folder / name).unlink(missing_ok=True)
    # Do not remove other files in it.
    with suppress(OSError):
        folder.rmdir()


def _remove_stale(parent: Path) -> None:
    """Remove the folders left by killed runs of this user."""
    for folder in parent.glob(f"{_PREFIX}*"):
        # Another run may end, or clean up, at the same time.
        with suppress(OSError):
            status = folder.lstat()
            if stat.S_ISDIR(status.st_mode) and status.st_uid == os.geteuid():
                _remove_unless_held(folder)


def _remove_unless_held(folder: Path) -> None:
    lock = os.open(folder / _LOCK, os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        _remove(folder)
    finally:
        os.close(lock)
