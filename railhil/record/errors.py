"""Errors when something cannot be written."""

from __future__ import annotations

import errno
from pathlib import Path

from railhil.common.errors import InputError
from railhil.common.exit_codes import TOOL_ERROR

#: Errors of the operating system when the disk is full.
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


class RecordFailed(Exception):
    """Results cannot be written (disk full); the frames already in the log are kept."""

    exit_code = TOOL_ERROR


def not_written(key: str, path: Path, kind: str, error: OSError) -> InputError | RecordFailed:
    """The error for a user's file or folder that cannot be written: bad input, unless the disk is full.

    :param key: option that named it.
    :param kind: ``file`` or ``folder``.
    """
    reason = (error.strerror or str(error)).lower()
    if error.errno in NO_ROOM:
        return RecordFailed(f"{path} cannot be written: {reason}")
    return InputError("command line", key, str(path), f"a {kind} that can be written ({reason})")
