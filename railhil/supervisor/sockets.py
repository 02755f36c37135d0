"""The folder for the socket of a run's own hub: gone after the run, and after a run that was killed at the next start.

Whose folder is still in use is known by a lock that the kernel gives back with the process, not by a process number:
containers that share /tmp have other ones.
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
#: All that is ever in such a folder; ``_DRAFT`` is the lock before it is held.
_DRAFT = "lock.new"


@contextmanager
def private_socket() -> Iterator[Path]:
    """Path for the socket of a hub, in a folder that only this user can enter and that is gone afterwards.

    :raises OSError: no folder can be made.
    """
    _remove_stale(Path(tempfile.gettempdir()))
    folder = Path(tempfile.mkdtemp(prefix=_PREFIX))
    lock = os.open(folder / _DRAFT, os.O_CREAT | os.O_EXCL | os.O_RDWR | os.O_CLOEXEC, 0o600)
    try:
        # Only a lock that is held bears the name that others look for.
        fcntl.flock(lock, fcntl.LOCK_EX)
        (folder / _DRAFT).rename(folder / _LOCK)
        yield folder / _SOCKET
    finally:
        _remove(folder)
        os.close(lock)


def _remove(folder: Path) -> None:
    for name in (_SOCKET, _LOCK, _DRAFT):
        (folder / name).unlink(missing_ok=True)
    # Somebody else's file in it is not ours to remove.
    with suppress(OSError):
        folder.rmdir()


def _remove_stale(parent: Path) -> None:
    """Remove the folders that killed runs of this user have left."""
    for folder in parent.glob(f"{_PREFIX}*"):
        # Another run may end, or look, at the same time.
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
