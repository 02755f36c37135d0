"""A command ends at once, with all that is done at an exit."""

from __future__ import annotations

import subprocess
import sys

import pytest

PROGRAM = """
import atexit, os, sys, threading
from railhil.common.leaving import leave

atexit.register(lambda: os.write(1, b"at exit\\n"))
sys.stdout.write("written\\n")
"""


def ended(code: str, stdout: int | None = subprocess.PIPE) -> tuple[int, list[str]]:
    """Exit code, and lines in no order: it depends on buffers."""
    words = [sys.executable, "-c", PROGRAM + code]
    done = subprocess.run(words, stdout=stdout, stderr=subprocess.DEVNULL, text=True, check=False)
    return done.returncode, sorted((done.stdout or "").splitlines())


@pytest.mark.parametrize("code", [0, 1, 3, 130])
def test_what_is_registered_is_done_and_all_output_is_written(code: int) -> None:
    assert ended(f"leave({code}); print('taken apart')") == (code, ["at exit", "written"])


@pytest.mark.parametrize(
    "watched",
    [
        "sys.setprofile(lambda *_: None)",
        "sys.settrace(lambda *_: None)",
        "threading.Thread(target=threading.Event().wait, daemon=True).start()",
    ],
)
def test_a_watched_process_ends_as_usual(watched: str) -> None:
    code = f"{watched}; leave(2); print('returned'); sys.exit(5)"
    assert ended(code) == (5, ["at exit", "returned", "written"])


def test_output_that_cannot_be_written_is_told_as_by_python() -> None:
    with open("/dev/full", "w") as full:
        assert ended("leave(0); sys.exit(0)", full.fileno())[0] == ended("sys.exit(0)", full.fileno())[0] != 0
