"""The end of a process without taking its modules apart, which takes a fork of a large one a tenth of a second.

To be imported before everything else: what registers with :mod:`atexit` last is called first.
"""

from __future__ import annotations

import atexit
import os
import sys

_codes: list[int] = []


def end_with(code: int) -> None:
    """Let this process end with an exit code, after its threads and what it has registered with :mod:`atexit`."""
    _codes.append(code)


@atexit.register
def _end() -> None:
    if not _codes:
        return
    try:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
    except (OSError, ValueError):
        # Python itself says so, with an exit code of its own.
        return
    os._exit(_codes[-1])
