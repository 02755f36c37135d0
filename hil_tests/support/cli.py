"""Runs the ``railhil`` command like a user."""

from __future__ import annotations

import atexit
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil

from hil_tests.support.warm import run_module
from railhil.cli.programs import PROGRAMS
from railhil.live.processes import process_name

#: The command in this process: the fixture ``here``.
Railhil = Callable[..., "Done"]
#: Enough for start-up and a run at a tenth of the usual speed.
TIMEOUT_S = 110


@dataclass(frozen=True, slots=True)
class Done:
    """A finished command."""

    exit_code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        """Standard output as JSON."""
        return json.loads(self.out)

    @property
    def said(self) -> list[str]:
        """Lines of standard error, without the one printed when the batch is compiled for the first time."""
        lines = self.err.splitlines()
        return [line for line in lines if line.strip() and not line.startswith("compiling the batch")]

    def one_line(self) -> str:
        """The error message on standard error, which must be a single line without a traceback."""
        lines = [line for line in self.said if not line.startswith(("bus: ", "compiling "))]
        assert len(lines) == 1, self.err
        assert "Traceback" not in self.err
        return lines[0]


def command(*arguments: str | Path) -> list[str]:
    """Command line of ``railhil`` with this Python."""
    return [sys.executable, "-m", "railhil.cli", *map(str, arguments)]


def railhil(*arguments: str | Path, cwd: Path | None = None, text: str = "", anew: bool = False) -> Done:
    """Run a command to its end, in a process of its own that has its modules already.

    :param text: its standard input.
    :param anew: in a new Python, for what depends on the start: other modules of the same names, other hash values.
    """
    done = railhil_process(*arguments, environment=os.environ, cwd=cwd, text=text, anew=anew)
    return Done(done.returncode, done.stdout, done.stderr)


def railhil_process(
    *arguments: str | Path, environment: Mapping[str, str], cwd: Path | None = None, text: str = "", anew: bool = False
) -> subprocess.CompletedProcess[str]:
    """:func:`railhil` with an environment other than that of the tests."""
    if anew:
        return subprocess.run(
            command(*arguments), capture_output=True, text=True, timeout=TIMEOUT_S, cwd=cwd, input=text,
            env=dict(environment), check=False,
        )  # fmt: skip
    module, *words = map(str, ("railhil.cli", *arguments))
    if words and words[0] in PROGRAMS:
        # The command becomes that program, which would load everything again.
        module, words = PROGRAMS[words[0]], words[1:]
    return run_module(module, words, environment=environment, cwd=cwd, text=text)


def complaint(done: Done, exit_code: int = 2) -> str:
    """The one line with which a command refused its input."""
    assert done.exit_code == exit_code, done.err
    return done.one_line()


class Started:
    """A command that keeps running while the test acts on it."""

    def __init__(self, *arguments: str | Path) -> None:
        self.process = subprocess.Popen(command(*arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        # A test that fails before the command has ended leaves it running: it would go on beside all others.
        atexit.register(self.process.kill)

    def child(self, role: str) -> psutil.Process:
        """The process of a node; waits until it exists."""
        found: psutil.Process = wait_for(lambda: node_of(psutil.Process(self.process.pid), role))
        return found

    def finish(self) -> tuple[Done, float]:
        """Wait for the end; also returns the seconds that it took."""
        start_s = time.monotonic()
        out, err = self.process.communicate(timeout=TIMEOUT_S)
        return Done(self.process.returncode, out, err), time.monotonic() - start_s


def node_of(command: psutil.Process, role: str) -> psutil.Process | None:
    """The process of a node that a command has started, if there is one."""
    children: list[psutil.Process] = command.children()
    return next((child for child in children if child.name() == process_name(role)), None)


def wait_for(look: Callable[[], Any], timeout_s: float = 30.0) -> Any:
    """Poll until ``look`` gives something true."""
    deadline_s = time.monotonic() + timeout_s
    while time.monotonic() < deadline_s:
        try:
            found = look()
        except (psutil.NoSuchProcess, FileNotFoundError):
            found = None
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError("did not happen in time")
