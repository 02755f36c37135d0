"""Processes that must not outlive the one that has started them."""

from __future__ import annotations

import ctypes
import signal

#: prctl(2): a signal for the process when the thread that has started it ends.
_PR_SET_PDEATHSIG = 1


def end_with_parent() -> None:
    """Let the kernel kill this process when the thread that has started it ends: a parent that is killed ends nobody.

    Only Linux can do so; elsewhere nothing happens. What this process starts itself does not inherit it.
    """
    prctl = getattr(ctypes.CDLL(None), "prctl", None)
    if prctl is not None:
        prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
