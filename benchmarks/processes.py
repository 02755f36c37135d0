"""Processes that the benchmarks start: the hub, and a whole ``railhil run`` on it."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from benchmarks.figures import MeasurementError, Setting
from bus.exitcodes import FAIL, PASS
from bus.select import HUB_INTERFACE
from hil_tests.cli import command

_READY = "railhil hub ready at "
#: Longer than a run on a machine ten times too busy.
_PATIENCE_S = 150.0
_LEAVE_S = 5.0


def end(process: subprocess.Popen[Any]) -> None:
    """End a process that was started here, and wait for it."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(_LEAVE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def hub_config(channel: str) -> dict[str, Any]:
    """Keyword arguments of ``can.Bus`` for a hub that may only just be starting."""
    return {"interface": HUB_INTERFACE, "channel": channel, "connect_timeout": "20"}


@contextmanager
def hub(channel: str) -> Iterator[tuple[str, int]]:
    """A hub process, ready.

    Gives the channel on which it really listens (TCP port 0 has become a real one) and the process id.

    :raises MeasurementError: the hub does not start.
    """
    process = subprocess.Popen([sys.executable, "-m", "bus.hub", "-c", channel], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        line = process.stdout.readline()
        if not line.startswith(_READY):
            raise MeasurementError(f"hub at {channel} did not start")
        yield line.removeprefix(_READY).split(": ")[0], process.pid
    finally:
        end(process)
        process.stdout.close()


@dataclass(frozen=True, slots=True)
class Finished:
    """A finished command: ``score.json``, hash of the frame log, and the wall time from the start to the exit."""

    score: dict[str, Any]
    frames_sha256: str
    wall_s: float


class RunCommand:
    """``railhil run`` in lockstep, recording, over a hub of its own; a context manager.

    :param out: run folder, must not exist.
    """

    def __init__(self, setting: Setting, arithmetic: str, out: Path) -> None:
        self._out = out
        self._started_ns = time.perf_counter_ns()
        words: list[str | Path] = ["run", setting.scenario_name, "--arithmetic", arithmetic, "-i", HUB_INTERFACE]
        self.process = subprocess.Popen(
            command(*words, "--out", out, "--json", "--quiet"),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def __enter__(self) -> RunCommand:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        end(self.process)
        for stream in (self.process.stdout, self.process.stderr):
            if stream is not None:
                stream.close()

    def finish(self) -> Finished:
        """Wait for the end of the command.

        :raises MeasurementError: the run is neither a pass nor a fail.
        """
        try:
            out, err = self.process.communicate(timeout=_PATIENCE_S)
        except subprocess.TimeoutExpired:
            raise MeasurementError(f"railhil run did not end within {_PATIENCE_S:g} s") from None
        wall_s = (time.perf_counter_ns() - self._started_ns) / 1e9
        if self.process.returncode not in (PASS, FAIL):
            words = err.strip().splitlines() or ["no message"]
            raise MeasurementError(f"railhil run ended with exit code {self.process.returncode}: {words[-1]}")
        certificate = json.loads((self._out / "certificate.json").read_text(encoding="utf-8"))
        return Finished(json.loads(out), certificate["frames_sha256"], wall_s)
