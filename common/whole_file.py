"""Files that a user names: whole or not at all, and nothing that was there is lost by a failed attempt."""

from __future__ import annotations

import errno
import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_NEW_FILE_MODE = 0o666


def _mode(path: Path) -> int | None:
    """Mode of what a path leads to, None when nothing is there.

    :raises OSError: it cannot be found out (a loop of links, a file in place of a folder).
    """
    try:
        return path.stat().st_mode
    except FileNotFoundError:
        return None


def _new_file_mode() -> int:
    """Permissions of a new file. The mask can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return _NEW_FILE_MODE & ~mask


def check_writable(path: Path) -> None:
    """Try what :func:`whole_file` will need, before the work that fills the file; leaves nothing behind.

    :raises OSError: the file cannot be written.
    """
    mode = _mode(path)
    if mode is not None:
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if not os.access(path, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    if mode is None or stat.S_ISREG(mode):
        # Asking for permissions would not notice a read-only file system.
        tempfile.TemporaryFile(dir=path.resolve().parent).close()


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Where to write, inside ``with``, so that the file appears whole when the block ends, or not at all.

    That is a draft of its own beside the file, with the same suffix; it takes the place of what a link leads to, not
    of the link, and the permissions of the file that was there. What exists and is no regular file (a device, a pipe)
    is written to directly.

    :raises OSError: the file cannot be written. Whatever the block raises goes through; the draft is gone.
    """
    mode = _mode(path)
    if mode is not None and not stat.S_ISREG(mode):
        yield path
        return
    target = path.resolve()
    handle, name = tempfile.mkstemp(prefix=".part-", suffix=target.suffix, dir=target.parent)
    os.close(handle)
    draft = Path(name)
    try:
        yield draft
        draft.chmod(_new_file_mode() if mode is None else stat.S_IMODE(mode))
        draft.replace(target)
    finally:
        draft.unlink(missing_ok=True)
