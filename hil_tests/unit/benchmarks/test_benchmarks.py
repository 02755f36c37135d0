"""Every benchmark runs and gives figures with units; speed is not asserted."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks import arithmetic
from benchmarks.__main__ import NAMES, run
from benchmarks.figures import MeasurementError, Setting
from benchmarks.machine import Machine
from benchmarks.memory import peak_of, share_mb
from benchmarks.processes import RunCommand
from railhil.controller_node.arithmetic import make

UNITS = {"us", "ns", "s", "frames/s", "sim s/s", "runs/s", "Mops/s", "%", "cycles", "MB", "km/h s2", "m", "m/s2/km"} | {
    "switches"
}


#: A figure that must be there.
EXPECTED = {
    "lockstep": "iq: command to first frame, median",
    "features": "learning sequence: speed factor, median",
    "start_and_end": "railhil score, median",
    "transports": "hub, gateway, hub: round trip, one CPU, Python",
    "jitter": "hub, TCP loopback: busy, normal, Python",
    "arithmetic": "rsmpy, 100,000 at once: apytypes",
    "controller_step": "float32: step of 1000 trains, per train, median",
    "plant": "direct run with iq, per core",
    "batch": "float64: runs of one core",
    "campaign": "processes: 2",
    "codec": "SIM_TRUTH (3 frames): receive, all checks and decode",
    "predictive_peer": "do-mpc: step, median",
    "training": "BP",
    "memory": "controller: peak proportional set",
    "index": "50 folders: nothing has changed",
}


def benchmarks(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """``python -m benchmarks`` to its end."""
    return subprocess.run(
        [sys.executable, "-m", "benchmarks", *arguments],
        capture_output=True,
        text=True,
        timeout=110,
        check=False,
        env={**os.environ, **environment},
    )


@pytest.mark.long
@pytest.mark.loop
@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_benchmark_gives_figures_with_units(name):
    before = os.sched_getaffinity(0)
    result = run(name, quick=True)
    figures = result["figures"]
    names = [figure["name"] for figure in figures]
    assert len(set(names)) == len(names)
    assert EXPECTED[name] in names
    for figure in figures:
        assert figure["unit"] in UNITS, figure
        assert math.isfinite(figure["value"]), figure
        # A difference of two times can be negative where the machine is busy.
        assert figure["value"] > 0 or "added" in figure["name"], figure
        assert (figure["ratio"] is None) == (figure["against"] == ""), figure
        assert figure["ratio"] is None or figure["ratio"] > 0, figure
        assert all(math.isfinite(value) for value in figure["spread"].values()), figure
    assert all(missing["name"] and missing["why"] for missing in result["missing"])
    assert result["title"]
    assert result["method"]
    assert os.sched_getaffinity(0) == before


@pytest.mark.slow
def test_json_holds_machine_and_figures():
    done = benchmarks("--json", "--quick", "--only", "codec")
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert list(document["benchmarks"]) == ["codec"]
    assert document["quick"] is True
    machine = document["machine"]
    assert machine["cores"] >= 1
    assert machine["libraries"]["python-can"].startswith("4.")
    assert machine["busy"] == bool(machine["warning"])


@pytest.mark.long
@pytest.mark.slow
def test_a_wrong_product_is_no_measurement(monkeypatch, tmp_path):
    class Floored(type(make("iq", batch=True))):
        def rmpy(self, a, b, q):
            return self.mpy(a, b, q)

    monkeypatch.setattr(arithmetic, "make", lambda name, batch=False: Floored() if batch else make(name))
    with pytest.raises(MeasurementError, match="rmpy does not give"):
        arithmetic.measure(Setting.make(True, tmp_path))


def test_operations_wrap_and_saturate_as_the_chip_does():
    wanted = {operation.name: operation.wanted(2**30, -(2**30) - 1) for operation in arithmetic.OPERATIONS}
    assert wanted == {"mpy": -64, "rmpy": -64, "rsmpy": -(2**31), "div": -(2**24), "add": -1}
    half = {operation.name: operation.wanted(-1, 1 << 23) for operation in arithmetic.OPERATIONS}
    assert half == {"mpy": -1, "rmpy": 0, "rsmpy": 0, "div": -2, "add": (1 << 23) - 1}


def test_unknown_benchmark_is_one_line():
    done = benchmarks("--only", "lokstep")
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.splitlines() == [
        f"benchmarks: command line: --only: found 'lokstep', allowed {', '.join(NAMES)}"
    ]


@pytest.mark.slow
def test_a_run_that_does_not_start_is_no_measurement(socket_folder):
    setting = Setting(True, str(socket_folder / "missing.toml"), socket_folder)
    running = RunCommand(setting, "iq", socket_folder / "out")
    with running, pytest.raises(MeasurementError, match=r"exit code 2: .*missing\.toml"):
        running.finish()
    assert running.process.returncode == 2


def machine(load_1min: float, cpu_used: float) -> Machine:
    return Machine("cpu", 2, 8.0, "Linux", "CPython", "PGO, LTO", "pure", {}, load_1min, cpu_used, 20.0)


@pytest.mark.parametrize(("load_1min", "cpu_used", "busy"), [(0.1, 0.05, False), (1.2, 0.05, True), (0.1, 0.6, True)])
def test_busy_machine_is_said(load_1min, cpu_used, busy):
    found = machine(load_1min, cpu_used)
    assert found.busy is busy
    assert bool(found.warning) is busy


def test_memory_of_two_processes_is_counted_once():
    block = bytearray(b"\1") * 60_000_000
    alone_mb = share_mb(os.getpid())
    assert alone_mb > 60
    reading, writing = os.pipe()
    if (child := os.fork()) == 0:
        os.close(writing)
        os.read(reading, 1)
        os._exit(0)
    try:
        assert 30 < share_mb(child) < alone_mb - 25
        assert share_mb(os.getpid()) < alone_mb - 25
    finally:
        os.close(writing)
        os.waitpid(child, 0)
        os.close(reading)
    assert len(block) == 60_000_000
    assert share_mb(2**31 - 2) == 0.0


#: Takes 40 MB, and has a child that takes 30 MB for as long as its standard input is open.
TOGETHER = """
import subprocess, sys, time
held = bytearray(b"\\1") * 40_000_000
child = 'import sys; held = bytearray(b"\\1") * 30_000_000; print(flush=True); sys.stdin.read()'
with subprocess.Popen([sys.executable, "-c", child], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
    process.stdout.readline()
    time.sleep(1)
"""


def test_the_peak_is_that_of_all_processes_at_one_time():
    with subprocess.Popen([sys.executable, "-c", TOGETHER]) as process:
        peak = peak_of(process, 60.0)
    assert process.returncode == 0
    assert 70 < peak.total_mb < 140
    (first, most_mb), (second, least_mb) = peak.parts
    assert first == second == Path(sys.executable).name
    assert most_mb > 40 > least_mb > 30
