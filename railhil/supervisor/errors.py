"""What is said when something cannot be written."""

from __future__ import annotations

import errno
from pathlib import Path

from railhil.common.errors import InputError
from railhil.common.exit_codes import TOOL_ERROR

#: What the operating system says when there is no room.
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


class RecordFailed(Exception):
    """What was asked for cannot be written (disk full); what has reached the log stays there."""

    exit_code = TOOL_ERROR


def not_written(key: str, path: Path, kind: str, error: OSError) -> InputError | RecordFailed:
    """The one line for a file or folder of the user's that cannot be written: bad input, unless the disk is full.

    :param key: option that named it.
    :param kind: ``file`` or ``folder``.
    """
    reason = (error.strerror or str(error)).lower()
    if error.errno in NO_ROOM:
        return RecordFailed(f"{path} cannot be written: {reason}")
    return InputError("command line", key, str(path), f"a {kind} that can be written ({reason})")
