"""Processes started by the benchmarks: the hub, and a complete ``railhil run`` on it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from benchmarks.figures import MeasurementError, Setting
from hil_tests.support.cli import command
from railhil.bus.can_settings import HUB_INTERFACE
from railhil.common.exit_codes import FAIL, PASS

_READY = "railhil hub ready at "
#: Longer than a run on a machine with ten times the load.
_PATIENCE_S = 300.0
_LEAVE_S = 5.0
#: In an emulated machine Python takes most of a minute to import a node.
_SLOW_START = ("--appear-timeout", "120")


def end(process: subprocess.Popen[Any]) -> None:
    """End a process started here, and wait for it."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(_LEAVE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def last_line(said: str) -> str:
    """The last line of a process on standard error, which says why it has ended."""
    return (said.strip().splitlines() or ["no message"])[-1]


@contextmanager
def hub(channel: str, *options: str) -> Iterator[tuple[str, int]]:
    """A hub process, ready; with the hub's own command-line ``options``.

    Yields the actual channel (TCP port 0 is replaced by the real one) and the process id.

    :raises MeasurementError: the hub does not start.
    """
    words = [sys.executable, "-m", "railhil.bus.hub", "-c", channel, *options]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stderr is not None
    try:
        line = process.stdout.readline()
        if not line.startswith(_READY):
            end(process)
            raise MeasurementError(f"hub at {channel} did not start: {last_line(process.stderr.read())}")
        yield line.removeprefix(_READY).split(": ")[0], process.pid
    finally:
        end(process)
        process.stdout.close()
        process.stderr.close()


def _output(process: subprocess.Popen[str], name: str, usual: Sequence[int]) -> str:
    """Standard output of a command, which is waited for.

    :raises MeasurementError: it does not end, or not with one of the ``usual`` exit codes.
    """
    try:
        out, err = process.communicate(timeout=_PATIENCE_S)
    except subprocess.TimeoutExpired:
        raise MeasurementError(f"{name} did not end within {_PATIENCE_S:g} s") from None
    if process.returncode not in usual:
        raise MeasurementError(f"{name} ended with exit code {process.returncode}: {last_line(err)}")
    return out


@dataclass(frozen=True, slots=True)
class Finished:
    """A finished command: ``score.json``, hash of the frame log, and the wall time from the start to the exit."""

    score: dict[str, Any]
    frames_sha256: str
    wall_s: float


class RunCommand:
    """``railhil run`` in lockstep, recording; a context manager.

    :param out: run folder, must not exist.
    :param flags: bus and other options of ``railhil run``; by default it starts its own hub.
    """

    def __init__(
        self, setting: Setting, arithmetic: str, out: Path, flags: Sequence[str] = ("-i", HUB_INTERFACE)
    ) -> None:
        self._out = out
        self._started_ns = time.perf_counter_ns()
        self.process = subprocess.Popen(
            command(
                "run", setting.scenario_name, "--arithmetic", arithmetic, *flags, "--out", out, "--json", "--quiet"
            ),
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

        :raises MeasurementError: the verdict is neither PASS nor FAIL.
        """
        out = _output(self.process, "railhil run", (PASS, FAIL))
        wall_s = (time.perf_counter_ns() - self._started_ns) / 1e9
        certificate = json.loads((self._out / "certificate.json").read_text(encoding="utf-8"))
        return Finished(json.loads(out), certificate["frames_sha256"], wall_s)


def learning_sequence(scenario: str, law: str, runs: int, out: Path) -> tuple[list[float], float]:
    """Record a sequence of runs in which a law learns, without reports.

    :param out: folder of the sequence, must not exist.
    :returns: speed factor of each run, in order, and wall time of the whole command in s.
    :raises MeasurementError: it was not recorded.
    """
    words = ("--controller", law, "--runs", str(runs), "--out", out, "--no-report", "--quiet", "--json")
    started_ns = time.perf_counter_ns()
    process = subprocess.Popen(
        command("sequence", "run", scenario, *words), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    with process:
        try:
            _output(process, "railhil sequence run", (PASS,))
        finally:
            end(process)
    wall_s = (time.perf_counter_ns() - started_ns) / 1e9
    scores = [json.loads(path.read_text(encoding="utf-8")) for path in sorted(out.glob("run*/score.json"))]
    return [float(score["run"]["speed_factor"]) for score in scores], wall_s


def attached_run(
    setting: Setting, out: Path, near: Sequence[str], far: Sequence[str], hub_pids: Sequence[int]
) -> Finished:
    """A run on an existing bus: plant and supervisor at its near end, the controller at the far end.

    The processes are bound as by ``railhil run``: in lockstep hub, plant and controller work one after the other, so
    they share a CPU, and the supervisor uses the others.

    :param near, far: command-line flags of the bus.
    :raises MeasurementError: the verdict is neither PASS nor FAIL.
    """
    cpus = os.sched_getaffinity(0)
    shared = {min(cpus)}
    nodes = {"railhil.plant_sim": (*near, *_SLOW_START), "railhil.controller_node": far}
    with ExitStack() as stack:
        pids = list(hub_pids)
        for module, flags in nodes.items():
            words = [sys.executable, "-m", module, setting.scenario_name, *flags]
            said = stack.enter_context((out.parent / f"{module}.txt").open("wb"))
            node = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=said, stderr=said)
            stack.callback(end, node)
            pids.append(node.pid)
        running = stack.enter_context(RunCommand(setting, "iq", out, [*near, *_SLOW_START, "--attach", "--no-report"]))
        for pid in pids:
            os.sched_setaffinity(pid, shared)
        os.sched_setaffinity(running.process.pid, cpus - shared or cpus)
        return running.finish()
