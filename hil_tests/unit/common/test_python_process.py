"""A forked process never goes on in the code of the command that started it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT

#: Starts a module as a process of its own. The signal comes to that process inside the fork (``fork``), or at its end,
#: among what it does at exit (``exit``); this command's handler for it raises, as that of `railhil run` does.
_START = """
import ctypes, functools, os, signal, sys
from pathlib import Path
from railhil.common.python_process import start_module

def end(number, frame):
    sys.exit(128 + number)

number = getattr(signal, sys.argv[1])
signal.signal(number, end)
if sys.argv[2] == "fork":
    # Not a Python function, in which the handler would already run.
    os.register_at_fork(after_in_child=functools.partial(ctypes.CDLL(None)["raise"], int(number)))
parent = os.getpid()
try:
    process = start_module("child", "child", [sys.argv[1], sys.argv[2]], Path("output.txt"))
    print(process.wait(60))
finally:
    if os.getpid() != parent:
        Path("strayed").touch()
"""
_CHILD = """
import atexit, os, signal, sys
from railhil.common.exit_codes import run_guarded

def main():
    if sys.argv[2] == "exit":
        atexit.register(os.kill, os.getpid(), getattr(signal, sys.argv[1]))
    return 7

sys.exit(run_guarded("child", main))
"""


@pytest.mark.parametrize(
    ("name", "moment", "code"),
    [
        # As a new interpreter: these end it before it has handlers, Ctrl-C is held back until the module listens.
        ("SIGTERM", "fork", -15),
        ("SIGHUP", "fork", -1),
        ("SIGUSR1", "fork", -10),
        ("SIGINT", "fork", 130),
        ("SIGTERM", "exit", 7),
        ("SIGINT", "exit", 7),
    ],
)
def test_a_signal_ends_the_new_process_and_nothing_else(tmp_path: Path, name: str, moment: str, code: int) -> None:
    (tmp_path / "child.py").write_text(_CHILD)
    done = subprocess.run(
        [sys.executable, "-c", _START, name, moment], capture_output=True, text=True, check=False, timeout=60,
        cwd=tmp_path, env={"PYTHONPATH": f"{ROOT}:{tmp_path}"},
    )  # fmt: skip
    assert done.stderr == ""
    assert done.stdout.split() == [str(code)]
    assert not (tmp_path / "strayed").exists()
