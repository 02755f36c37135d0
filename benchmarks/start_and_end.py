"""Time of a command before its first frame and after its last one, and time of the score from the log alone."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

from benchmarks.figures import Figure, MeasurementError, Setting, median
from benchmarks.processes import RunCommand
from hil_tests.support.cli import command
from railhil.common.exit_codes import FAIL, PASS
from railhil.dbc import wire_contract
from railhil.record.framelog import read_log
from railhil.record.log_trace import trace_of_log
from railhil.record.trace import trace_of

TITLE = "start and end"
METHOD = (
    "`railhil run` in lockstep on the bus that it chooses by itself, five runs. First frame: from the start of the "
    "command. All files: from the last frame to the exit of the command, with the report. Score: `railhil score` of "
    "the run's folder, whole command. Record read back: the telegrams of its frame log, as a command reads them, and "
    "frame by frame, in turns in this process."
)


def _score_s(out: Path) -> float:
    """Wall time of ``railhil score``.

    :raises MeasurementError: it gives no verdict.
    """
    started_ns = time.perf_counter_ns()
    done = subprocess.run(command("score", out), capture_output=True, text=True, check=False)
    taken_s = (time.perf_counter_ns() - started_ns) / 1e9
    if done.returncode not in (PASS, FAIL):
        raise MeasurementError(f"railhil score ended with exit code {done.returncode}")
    return taken_s


def measure(setting: Setting) -> list[Figure]:
    """Medians (quick: of one run).

    :raises MeasurementError: a run failed, or its two readings differ.
    """
    names = ("first frame", "all files after the last frame", "railhil score", "record read back", "frame by frame")
    taken_s: dict[str, list[float]] = {name: [] for name in names}
    for number in range(setting.count(5, 1)):
        out = setting.folder / str(number)
        with RunCommand(setting, "iq", out, ()) as running:
            done = running.finish()
        run, log = done.score["run"], out / "frames.log"
        begun_s = time.perf_counter()
        trace = trace_of_log(log, wire_contract())
        middle_s = time.perf_counter()
        same = trace_of(read_log(log), wire_contract())
        ended_s = time.perf_counter()
        if (trace.polls, trace.end_ns) != (same.polls, same.end_ns):
            raise MeasurementError("the record is not the same as columns and frame by frame")
        first_s, files_s = run["first_frame_s"], done.wall_s - run["first_frame_s"] - run["wall_time_s"]
        for name, value in zip(
            names, (first_s, files_s, _score_s(out), middle_s - begun_s, ended_s - middle_s), strict=True
        ):
            taken_s[name].append(value)
    slow_s = median(taken_s["frame by frame"])
    figures = []
    for name, values in taken_s.items():
        ratio, against = (median(values) / slow_s, "to frame by frame") if name == "record read back" else (None, "")
        spread = {"min": min(values), "max": max(values)}
        figures.append(Figure(f"{name}, median", median(values), "s", ratio, against, spread))
    return figures
