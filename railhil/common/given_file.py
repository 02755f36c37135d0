"""Reads files that a user gives: regular ones, of a bounded size.

Opening a named pipe would wait for its writer, and a device has no end.
"""

from __future__ import annotations

import errno
import os
import stat
from io import BufferedReader
from pathlib import Path

from railhil.common.errors import InputError, Words

#: Largest file with settings, tables or results; the largest that railhil writes itself have some MB.
BYTES_MAX = 64_000_000
_ALLOWED = "a regular file"


def open_given(path: Path, bytes_max: int = BYTES_MAX) -> BufferedReader:
    """The file, open for reading.

    :raises InputError: it is no regular file, or a larger one.
    :raises OSError: it cannot be opened.
    """
    stream = open(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC), "rb")  # noqa: SIM115
    try:
        found = os.fstat(stream.fileno())
        if stat.S_ISDIR(found.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if not stat.S_ISREG(found.st_mode):
            kind = "a pipe" if stat.S_ISFIFO(found.st_mode) else "a device or socket"
            raise InputError(path, "", Words(kind), _ALLOWED)
        if found.st_size > bytes_max:
            raise InputError(path, "", Words(f"{found.st_size} bytes"), f"{_ALLOWED} of at most {bytes_max} bytes")
    except BaseException:
        stream.close()
        raise
    return stream


def given_bytes(path: Path, bytes_max: int = BYTES_MAX) -> bytes:
    """Content of the file, as :func:`open_given`."""
    with open_given(path, bytes_max) as stream:
        return stream.read(bytes_max)


def given_text(path: Path, encoding: str = "utf-8", errors: str = "strict") -> str:
    """Text of the file, as :func:`open_given`, with line ends as ``\\n``.

    :raises UnicodeDecodeError: it is no text.
    """
    text = given_bytes(path).decode(encoding, errors)
    return text.replace("\r\n", "\n").replace("\r", "\n")
