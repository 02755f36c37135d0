"""Exclusive access to a folder that a process makes over hours."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from railhil.common.errors import InputError, Sentence
from railhil.common.user_files import lock_within, refuse_unwritable

#: Options that name a folder.
FOLDER_OPTIONS = "--out, --resume"


class InUse(InputError):
    """Another process has the folder, or makes this shard of it."""


def claim(descriptor: int, path: Path, kind: str, mode: int = fcntl.LOCK_EX, wait_s: float = 0.0) -> None:
    """Lock an open file (flock) until it is closed or the process ends in any way.

    :param wait_s: time to wait for others. :raises InUse: another process has it.
    """
    with refuse_unwritable(FOLDER_OPTIONS, path, "folder"):
        is_locked = lock_within(descriptor, wait_s, mode)
    if not is_locked:
        raise InUse(path, "", kind, Sentence(f"is in use by a {kind} that is running"))


@contextmanager
def claimed(path: Path, kind: str) -> Iterator[None]:
    """Exclusive access to a folder whose manifest is written anew again and again: the folder itself is locked.

    :raises InputError: another process has it, or it cannot be opened.
    """
    with refuse_unwritable(FOLDER_OPTIONS, path, "folder"):
        descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        claim(descriptor, path, kind)
        yield
    finally:
        os.close(descriptor)
