"""What faults do to a process of its own: signals that no process can refuse."""

from __future__ import annotations

import os
import signal
import subprocess


def kill_this_process() -> None:
    """End this process at once (SIGKILL)."""
    os.kill(os.getpid(), signal.SIGKILL)


def stop_this_process(duration_s: float) -> None:
    """Stop this process (SIGSTOP) and have it continued (SIGCONT) after a time on the wall clock in s."""
    number = str(os.getpid())
    # Stopped, it cannot continue itself.
    words = ["sh", "-c", 'kill -STOP "$1"; sleep "$2"; kill -CONT "$1"', "sh", number, f"{duration_s:g}"]
    with subprocess.Popen(words, stdin=subprocess.DEVNULL, start_new_session=True) as helper:
        helper.wait()
