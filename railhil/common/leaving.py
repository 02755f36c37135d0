"""The end of a command's process."""

from __future__ import annotations

import atexit
import contextlib
import os
import sys
import threading


def leave(code: int) -> None:
    """End this process at once, after all that is done at an exit and without taking its objects apart, which takes
    0.1 s for the libraries of a run.

    Returns, so that Python ends as usual, where somebody watches the process (a profiler, a debugger, ``python -i``),
    where other threads still run, and if not all output can be written.

    :param code: exit code.
    """
    watched = sys.getprofile() is not None or sys.gettrace() is not None or sys.flags.inspect
    if watched or threading.active_count() > 1:
        return
    atexit._run_exitfuncs()
    with contextlib.suppress(OSError, ValueError):
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
        os._exit(code & 0xFF)
