"""``python -m benchmarks.panel``: the cost of the live panel, with two pages in headless Chromium.

In real time (1x): the panel's share of a core, the bytes that it sends, its memory at the start and at the end, the
frames that the pages draw, and the lateness of the loop, beside a run of at most 120 s without the panel. In lockstep:
the speed factor with the panel and without, in turns, without pages (a browser would need the cores of the run).
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil

from benchmarks.figures import FULL_SCENARIO, MeasurementError, Setting, median
from benchmarks.processes import RunCommand, end
from hil_tests.support.browser import browser
from hil_tests.support.cli import command
from railhil.common.exit_codes import FAIL, INVALID, PASS, run_guarded
from railhil.common.extras import missing_library
from railhil.systems.ato.scenario.model import TargetCurve
from railhil.systems.ato.scenario.target import Target

PAGES = 2
#: The panel is measured from so long after its pages are connected.
_SETTLED_S = 2.0
_LOOK_S = 1.0
#: The run without the panel needs no longer for its 99th percentile.
_ALONE_S = 120.0
_PATIENCE_S = 60.0
#: Speed of the run, at which the line is long enough for half an hour.
_SPEED_MPS = 1.5
_ACCEL_MPS2 = 0.5
_RAMP_S = 0.2
_ADDRESS = re.compile(r"http://127\.0\.0\.1:\d+/")


@dataclass(frozen=True, slots=True)
class Sample:
    """The panel's process at one instant: wall time, processor time since its start, resident set."""

    time_s: float
    cpu_s: float
    rss_bytes: int


@dataclass(frozen=True, slots=True)
class Cost:
    """Cost of a panel between its first and its last sample. ``share``: of a core. Memory in MB (10^6 bytes): at the
    start, at half time (when it has all rows that it keeps), at the end, and at most."""

    seconds: float
    share: float
    rss_start_mb: float
    rss_half_mb: float
    rss_end_mb: float
    rss_most_mb: float


@dataclass(frozen=True, slots=True)
class Watched:
    """A run in real time with a panel and its pages; ``fps`` of each page, bytes that all pages have received."""

    p99_ms: float
    cost: Cost
    bytes_per_s: float
    fps: tuple[float, ...]


def cost_of(samples: Sequence[Sample]) -> Cost:
    """Reckon the cost of a panel.

    :raises MeasurementError: there are less than two samples.
    """
    if len(samples) < 2:
        raise MeasurementError("panel: the run was over before it could be measured: more --seconds")
    first, last = samples[0], samples[-1]
    seconds = last.time_s - first.time_s
    rss_mb = [sample.rss_bytes / 1e6 for sample in samples]
    return Cost(
        seconds, (last.cpu_s - first.cpu_s) / seconds, rss_mb[0], rss_mb[len(rss_mb) // 2], rss_mb[-1], max(rss_mb)
    )


def loss(pairs: Sequence[tuple[float, float]]) -> float:
    """Share of the speed that the panel takes: the median over pairs of factors without and with it."""
    return median([1.0 - beside / alone for alone, beside in pairs])


def scenario_toml(seconds: float) -> str:
    """A run of so many seconds at a walk, on the line of the published one.

    :param seconds: from 20.
    """
    ramp_s = _SPEED_MPS / _ACCEL_MPS2
    nodes = [
        (0.0, _ACCEL_MPS2),
        (ramp_s, _ACCEL_MPS2),
        (ramp_s + _RAMP_S, 0.0),
        (seconds - ramp_s - 2 * _RAMP_S, 0.0),
        (seconds - ramp_s - _RAMP_S, -_ACCEL_MPS2),
    ]
    target = Target(TargetCurve(tuple(nodes)))
    return (
        f'extends = "{FULL_SCENARIO}"\nname = "benchmark_panel"\ntitle = "a walk"\n'
        f"[target]\nnodes_s_mps2 = {[list(node) for node in nodes]}\n"
        f"[plan]\ndistance_m = {target.stop_position_m:.6f}\nrunning_time_s = {target.stop_time_s:.6f}\n"
        "overtime_max_s = 5\n"
    )


@contextmanager
def _realtime(scenario: Path, out: Path, *options: str) -> Iterator[subprocess.Popen[str]]:
    words = ("run", scenario, "--pace", "realtime", "--no-report", "--quiet", "--json", "--out", out, *options)
    with (out.parent / f"{out.name}.txt").open("wb") as said:
        process = subprocess.Popen(command(*words), stdout=subprocess.PIPE, stderr=said, text=True)
    assert process.stdout is not None
    try:
        with process.stdout:
            yield process
    finally:
        end(process)


def _p99_ms(process: subprocess.Popen[str], seconds: float = 0.0) -> float:
    """Lateness of the loop, at the end of a run that still lasts so long."""
    out, _ = process.communicate(timeout=seconds + _PATIENCE_S)
    # A busy machine makes a run INVALID by a single pause, which says nothing about the panel.
    if process.returncode not in (PASS, FAIL, INVALID):
        raise MeasurementError(f"railhil run ended with exit code {process.returncode}")
    return float(json.loads(out)["jitter"]["p99_ms"])


def _address(said: Path, process: subprocess.Popen[str]) -> str:
    until_s = time.monotonic() + _PATIENCE_S
    while time.monotonic() < until_s and process.poll() is None:
        if found := _ADDRESS.search(said.read_text()):
            return found[0]
        time.sleep(0.05)
    raise MeasurementError("railhil run --panel has printed no address")


def _panel_of(process: subprocess.Popen[str]) -> psutil.Process:
    for child in psutil.Process(process.pid).children(recursive=True):
        if "railhil.panel" in child.cmdline():
            return child
    raise MeasurementError("railhil run --panel has no process of the panel")


def _sample(panel: psutil.Process) -> Sample:
    with panel.oneshot():
        times = panel.cpu_times()
        return Sample(time.monotonic(), times.user + times.system, panel.memory_info().rss)


def watched_run(chromium: Any, folder: Path, scenario: Path, seconds: float) -> Watched:
    """A run in real time with pages.

    :param chromium: a browser of playwright.
    :raises MeasurementError: run or panel did not start, or ended too early.
    """
    received = [0]

    def count(payload: str | bytes) -> None:
        received[0] += len(payload)

    with _realtime(scenario, folder / "with", "--panel", "0") as process:
        began_s = time.monotonic()
        address = _address(folder / "with.txt", process)
        pages = [chromium.new_page() for _ in range(PAGES)]
        for page in pages:
            page.on("websocket", lambda socket: socket.on("framereceived", count))
            page.goto(address)
        panel = _panel_of(process)
        pages[0].wait_for_timeout(_SETTLED_S * 1e3)
        for page in pages:
            page.evaluate("stats()")
        samples, before = [_sample(panel)], received[0]
        # The panel ends with the run: the last sample comes before.
        while process.poll() is None and time.monotonic() < began_s + seconds - _LOOK_S:
            # The browser's events are only handled while playwright waits.
            pages[0].wait_for_timeout(_LOOK_S * 1e3)
            samples.append(_sample(panel))
        cost = cost_of(samples)
        bytes_per_s = (received[0] - before) / cost.seconds
        fps = tuple(float(page.evaluate("stats()")["fps"]) for page in pages)
        for page in pages:
            page.close()
        return Watched(_p99_ms(process), cost, bytes_per_s, fps)


def lockstep_pairs(folder: Path, pairs: int) -> list[tuple[float, float]]:
    """Speed factors of lockstep runs without and with the panel, in turns."""
    setting = Setting.make(False, folder)
    found = []
    for number in range(pairs):
        factors = []
        for name, flags in (("alone", ()), ("beside", ("--panel", "0"))):
            with RunCommand(setting, "iq", folder / f"{name}{number}", flags) as running:
                factors.append(float(running.finish().score["run"]["speed_factor"]))
        found.append((factors[0], factors[1]))
    return found


def work(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.panel", description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="of the run in real time, 20 to 1800 (default 60)")
    parser.add_argument("--pairs", type=int, default=5, help="runs in lockstep, each with and without the panel")
    options = parser.parse_args(arguments)
    if not 20.0 <= options.seconds <= 1800.0:
        parser.error(f"--seconds: found {options.seconds:g}, allowed 20 to 1800")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError as error:
        raise missing_library("benchmarks.panel", error, "dev") from None
    if (program := browser()) is None:
        raise MeasurementError("no Chromium on this machine")
    with tempfile.TemporaryDirectory(prefix="railhil-") as text:
        folder = Path(text)
        scenario, short = folder / "walk.toml", folder / "short_walk.toml"
        alone_s = min(options.seconds, _ALONE_S)
        scenario.write_text(scenario_toml(options.seconds), encoding="utf-8")
        short.write_text(scenario_toml(alone_s), encoding="utf-8")
        with _realtime(short, folder / "without") as process:
            alone_ms = _p99_ms(process, alone_s)
        with sync_playwright() as playwright:
            chromium = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
            found = watched_run(chromium, folder, scenario, options.seconds)
            chromium.close()
        pairs = lockstep_pairs(folder, options.pairs)
    cost = found.cost
    print(f"real time, {PAGES} pages, {cost.seconds:.0f} s")
    print(f"panel                   {100 * cost.share:.2f} % of a core")
    print(f"sent to all pages       {found.bytes_per_s:.0f} bytes/s")
    print(
        f"resident set            {cost.rss_start_mb:.1f} MB at the start, {cost.rss_half_mb:.1f} MB at half time, "
        f"{cost.rss_end_mb:.1f} MB at the end, at most {cost.rss_most_mb:.1f} MB"
    )
    print(f"pages draw              {', '.join(f'{fps:.1f}' for fps in found.fps)} frames/s")
    print(f"lateness of the loop    p99 {alone_ms:.3f} ms without the panel, {found.p99_ms:.3f} ms with it")
    if pairs:
        shown = ", ".join(f"{alone:.0f} and {beside:.0f}" for alone, beside in pairs)
        print(f"lockstep, without pages factor without the panel and with it: {shown}; {100 * loss(pairs):.1f} % lost")
    return PASS


if __name__ == "__main__":
    sys.exit(run_guarded("benchmarks.panel", work))
