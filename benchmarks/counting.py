"""Processes that only count: a load beside the measurement."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

from benchmarks.processes import end

_COUNT = "n = 0\nwhile True: n += 1"


@contextmanager
def counting(processes: int) -> Iterator[None]:
    """This many counting processes during the block."""
    with ExitStack() as stack:
        for _ in range(processes):
            stack.callback(end, subprocess.Popen([sys.executable, "-c", _COUNT], stdin=subprocess.DEVNULL))
        yield
