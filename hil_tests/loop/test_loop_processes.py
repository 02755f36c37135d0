"""The bench as it is used: three processes and a hub."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import can
import numpy as np
import psutil
import pytest

from hil_tests.support.cli import Started, node_of, railhil, wait_for
from hil_tests.support.short_runs import RUN_72M_TOML
from railhil.bench import local_run
from railhil.dbc import wire_contract
from railhil.record.framelog import read_log, sha256_of
from railhil.record.trace import trace_of
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec
from railhil.wire.ato import NotchCmd

pytestmark = pytest.mark.loop

#: How long the bench may take to end when a node was killed, on a busy machine.
#: Who does not see that it has gone waits for it for 60 s.
END_S = 20.0
_RUN_KEYS = {"sim_time_s", "wall_time_s", "speed_factor", "frames", "transport", "arithmetic", "controller", "seed"}


@pytest.fixture(scope="module")
def short(tmp_path_factory) -> Path:
    """A scenario of 24 s, 13 000 frames."""
    path = tmp_path_factory.mktemp("scenario") / "short.toml"
    path.write_text(RUN_72M_TOML)
    return path


@pytest.fixture(scope="module")
def hub_run(short, tmp_path_factory) -> Path:
    """Folder of one run with the default bus, seed 1. (The whole published run is made by the installed wheel.)"""
    folder = tmp_path_factory.mktemp("hub") / "run"
    done = railhil("run", short, "--seed", "1", "--out", folder, "--quiet", "--no-report", anew=True)
    assert done.exit_code in (0, 1), done.err
    return folder


@pytest.fixture(scope="module")
def short_sha256(short, tmp_path_factory) -> str:
    """SHA-256 of its frames, from a run without processes."""
    return local_run(load(short), tmp_path_factory.mktemp("local"), RunSpec(seed=1)).frames_sha256


def certificate(folder: Path) -> dict:
    return json.loads((folder / "certificate.json").read_text(encoding="utf-8"))


@pytest.mark.slow
def test_run_folder_is_complete(hub_run, short):
    names = {path.name for path in hub_run.iterdir()}
    documents = {"score.json", "certificate.json", "junit.xml", "telemetry.json"}
    assert {"frames.log", "frames.blf", "signals.csv"} | documents <= names
    assert certificate(hub_run)["frames_sha256"] == sha256_of(hub_run / "frames.log")
    document = json.loads((hub_run / "score.json").read_text(encoding="utf-8"))
    assert set(document["scores"]) == {"itae", "energy_kj", "punctuality_s", "stop_error_m", "comfort"}
    assert set(document["signed"]) == {"time_error_s", "stop_error_m"}
    assert set(document["run"]) >= _RUN_KEYS
    suite = ET.parse(hub_run / "junit.xml").getroot()
    cases = suite.findall("testcase")
    assert int(suite.get("tests", "0")) == len(cases) == 7
    assert (suite.get("failures"), suite.get("errors")) == (str(len(document["failures"])), "0")
    assert len(suite.findall(".//failure")) == len(document["failures"])
    assert {found.get("name"): found.get("value") for found in suite.findall("properties/property")} == {
        "scenario": str(short), "seed": "1", "controller": "ipfc", "arithmetic": "iq",
        "verdict": document["verdict"],
        "frames_sha256": certificate(hub_run)["frames_sha256"],
        "railhil": certificate(hub_run)["railhil"],
    }  # fmt: skip
    # The time of the cases is the time of the run.
    assert sum(float(case.get("time", "nan")) for case in cases) == float(suite.get("time", "0")) > 0


def test_bench_health(hub_run):
    """Nothing lost, rejected or out of order between the processes."""
    counters = json.loads((hub_run / "score.json").read_text(encoding="utf-8"))["run"]["counters"]
    assert {key: count for key, count in counters.items() if key not in ("sent", "received") and count} == {}
    trace = trace_of(read_log(hub_run / "frames.log"), wire_contract())
    for port, signal_name, modulus in (("TRN_SPEED", "SpeedLife", 16), ("NOTCH_CMD", "NotchLife", 16)):
        steps = np.diff(trace.raw(port, signal_name)) % modulus
        assert set(steps.tolist()) == {1}


def test_processes_give_the_bytes_of_the_bench_in_one_process(hub_run, short_sha256):
    assert certificate(hub_run)["frames_sha256"] == short_sha256
    assert certificate(hub_run)["transport"] in ("railhil:pipes", "socketcan:vcan0")


@pytest.mark.long
@pytest.mark.slow
def test_tcp_hub_gives_the_same_bytes(short, short_sha256, tmp_path):
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    channel = f"tcp://127.0.0.1:{port}"
    hub = subprocess.Popen([sys.executable, "-m", "railhil.bus.hub", "-c", channel], stderr=subprocess.DEVNULL)
    try:
        folder = tmp_path / "run"
        bus = ("-i", "railhil", "-c", channel, "--bus-kwargs", "connect_timeout=10")
        done = railhil("run", short, "--seed", "1", "--out", folder, "--quiet", "--no-report", *bus)
        assert done.exit_code in (0, 1), done.err
        assert certificate(folder)["frames_sha256"] == short_sha256
    finally:
        hub.terminate()
        assert hub.wait(5) == 0


@pytest.mark.slow
def test_score_of_the_log_is_the_live_score_to_the_last_digit(hub_run, short, tmp_path):
    live = json.loads((hub_run / "score.json").read_text(encoding="utf-8"))
    done = railhil("score", hub_run / "frames.log", "--json")
    for key in ("verdict", "scores", "signed", "overspeed_mps", "failures"):
        assert done.json[key] == live[key]
    # Without the certificate beside it, the scenario must be named.
    moved = tmp_path / "frames.log"
    moved.write_bytes((hub_run / "frames.log").read_bytes())
    assert railhil("score", moved, "--scenario", short, "--json").json == done.json
    assert railhil("score", moved).exit_code == 2


def test_blf_holds_the_same_frames(hub_run):
    with can.LogReader(hub_run / "frames.blf") as blf:
        # python-can truncates to whole nanoseconds, so the comparison is in microseconds.
        messages = [(round(message.timestamp * 1e6), message.arbitration_id, bytes(message.data)) for message in blf]
    frames = read_log(hub_run / "frames.log")
    assert messages == [(time_ns // 1000, frame.can_id, frame.data) for time_ns, frame in frames]


def test_candump_log_is_readable_by_python_can(hub_run):
    with can.LogReader(hub_run / "frames.log") as log:
        assert sum(1 for _ in log) == certificate(hub_run)["frames"]


def test_signals_table_matches_the_log(hub_run):
    table = np.genfromtxt(hub_run / "signals.csv", delimiter=",", names=True)
    trace = trace_of(read_log(hub_run / "frames.log"), wire_contract())
    assert np.allclose(table["true_speed_mps"], trace.values("SIM_TRUTH", "TrueSpeed"))
    assert table["time_s"][-1] == pytest.approx(trace.times_s("SIM_TRUTH")[-1])
    assert np.nanmax(table["notch_command"]) == pytest.approx(trace.values(NotchCmd.PORT, "NotchCmd").max())


@pytest.mark.slow
def test_command_of_the_certificate_makes_the_same_bytes(hub_run, tmp_path):
    words = certificate(hub_run)["command"].split()
    assert words[0] == "railhil"
    folder = tmp_path / "again"
    railhil(*words[1:], "--bus", "local", "--out", folder, "--quiet", "--no-report")
    assert certificate(folder)["frames_sha256"] == certificate(hub_run)["frames_sha256"]


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("role", ["plant", "controller", "hub"])
@pytest.mark.faults
def test_killed_node_ends_the_run_and_leaves_a_readable_log(tmp_path, role):
    folder = tmp_path / "run"
    run = Started("run", "--seed", "1", "--out", folder, "--quiet", "--no-report", "--pace", "realtime", "--rate", "20")
    log = folder / "frames.log"
    wait_for(lambda: log.stat().st_size > 200_000)
    others = psutil.Process(run.process.pid).children()
    run.child(role).send_signal(signal.SIGKILL)
    done, seconds = run.finish()
    assert seconds < END_S
    assert done.exit_code == 3
    assert "Traceback" not in done.out + done.err
    assert f"{role} lost at simulation time" in done.out
    assert "SIGKILL" in done.out
    assert not [child for child in others if child.is_running() and child.status() != psutil.STATUS_ZOMBIE]
    frames = list(read_log(log))
    assert len(frames) > 5000
    scored = railhil("score", folder)
    assert scored.exit_code == 3
    assert f"{role} lost at simulation time" in scored.out


@pytest.mark.long
@pytest.mark.faults
@pytest.mark.slow
@pytest.mark.parametrize("role", ["plant", "controller"])
def test_killed_node_ends_a_run_without_hub(tmp_path, role):
    folder = tmp_path / "run"
    run = Started("run", "--seed", "1", "--out", folder, "--quiet", "--no-report")
    log = folder / "frames.log"
    wait_for(lambda: log.exists() and log.stat().st_size > 200_000)
    others = psutil.Process(run.process.pid).children()
    assert len(others) == 2, "plant and controller alone"
    run.child(role).send_signal(signal.SIGKILL)
    done, seconds = run.finish()
    assert (done.exit_code, seconds < END_S) == (3, True)
    assert "lost at simulation time" in done.out
    assert "killed by SIGKILL" in done.out
    assert not [child for child in others if child.is_running() and child.status() != psutil.STATUS_ZOMBIE]
    assert json.loads((folder / "score.json").read_text(encoding="utf-8"))["run"]["transport"] == "railhil:pipes"


@pytest.mark.long
@pytest.mark.faults
@pytest.mark.slow
def test_train_stops_by_itself_when_the_controller_dies_in_lockstep(tmp_path):
    folder = tmp_path / "run"
    run = Started("run", "--seed", "1", "--out", folder, "--quiet", "--no-report")
    log = folder / "frames.log"
    wait_for(lambda: log.exists() and log.stat().st_size > 800_000)
    run.child("controller").send_signal(signal.SIGKILL)
    done, seconds = run.finish()
    assert (done.exit_code, seconds < END_S) == (3, True)
    trace = trace_of(read_log(log), wire_contract())
    assert trace.raw("RUN_EVENT", "RunEvent")[-1] == 7, "ended_controller_lost"
    assert trace.values("SIM_TRUTH", "TrueSpeed")[-1] == 0
    last_notch_s = trace.times_s(NotchCmd.PORT)[-1]
    after = trace.times_s("SIM_TRUTH") > last_notch_s + 0.1
    assert trace.values("SIM_TRUTH", "TractionForce")[after].max() == 0, "traction is cut within 100 ms"


#: Makes the hub's process late, or ends it before it is there: what only the hub loads is loaded so.
BUSY = """
import os, sys, time

class Busy:
    def find_spec(name, path, target=None):
        if name == "railhil.bus.hub.server" and os.environ["HUB"] == "late":
            time.sleep(6)
        elif name == "railhil.bus.hub.server":
            print("no memory for the hub", file=sys.stderr, flush=True)
            os._exit(1)

sys.meta_path.insert(0, Busy)
"""


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize(("hub", "codes"), [("late", (0, 1)), ("dead", (2,))])
def test_the_hub_is_waited_for_while_its_process_lives(short, tmp_path, monkeypatch, hub, codes):
    (tmp_path / "sitecustomize.py").write_text(BUSY)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("HUB", hub)
    done = railhil("run", short, "--out", tmp_path / "run", "--quiet", "--no-report", "-i", "railhil", anew=True)
    assert done.exit_code in codes, done.err
    if hub == "dead":
        assert done.one_line() == "railhil: no memory for the hub"


@pytest.mark.long
@pytest.mark.slow
def test_lockstep_waits_for_processes_that_stand_still(short, short_sha256, tmp_path):
    """On a loaded machine, longer than any of them would wait in realtime: the record is whole and the same."""
    runs, stopped = {}, []
    try:
        for starved in ("controller", "supervisor", "both"):
            folder = tmp_path / starved
            run = runs[starved] = Started("run", short, "--seed", "1", "--out", folder, "--quiet", "--no-report")
            wait_for(lambda log=folder / "frames.log": log.stat().st_size > 100_000)
            controller = run.child("controller")
            processes = {"controller": [controller], "supervisor": [run.process], "both": [controller, run.process]}
            for process in processes[starved]:
                stopped.append(process)
                process.send_signal(signal.SIGSTOP)
        time.sleep(5.0)
    finally:
        for process in stopped:
            process.send_signal(signal.SIGCONT)
    for starved, run in runs.items():
        done, _ = run.finish()
        assert done.exit_code in (0, 1), (starved, done.out)
        assert certificate(tmp_path / starved)["frames_sha256"] == short_sha256, starved


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.faults
@pytest.mark.parametrize("pace", [(), ("--pace", "realtime", "--rate", "20")])
def test_killed_supervisor_stops_the_nodes(tmp_path, pace):
    run = Started("run", "--seed", "1", "--out", tmp_path / "run", "--quiet", *pace)
    wait_for(lambda: (tmp_path / "run" / "frames.log").stat().st_size > 200_000)
    command = psutil.Process(run.process.pid)
    children, hub = command.children(), node_of(command, "hub")
    run.process.kill()
    run.process.wait()
    nodes = [child for child in children if child != hub]
    _, alive = psutil.wait_procs(nodes, timeout=END_S)
    for child in children:
        if child.is_running():
            child.kill()
    assert not alive
    assert list(read_log(tmp_path / "run" / "frames.log"))


@pytest.mark.long
@pytest.mark.slow
def test_other_tools_attach_to_the_hub(short, tmp_path, socket_folder):
    """python-can's logger, unmodified, sees what the supervisor records."""
    channel = str(socket_folder / "hub.sock")
    hub = subprocess.Popen([sys.executable, "-m", "railhil.bus.hub", "-c", channel], stderr=subprocess.DEVNULL)
    wait_for(lambda: Path(channel).exists())
    tool = subprocess.Popen(
        [sys.executable, "-m", "can.logger", "-i", "railhil", "-c", channel, "-f", str(tmp_path / "tool.log")],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        wait_for(lambda: (tmp_path / "tool.log").exists())
        bus = ("-i", "railhil", "-c", channel)
        done = railhil("run", short, "--seed", "1", "--out", tmp_path / "run", "--quiet", "--no-report", *bus)
        assert done.exit_code in (0, 1), done.err
    finally:
        tool.send_signal(signal.SIGINT)
        tool.wait(10)
        hub.terminate()
        hub.wait(10)
    ours = [(frame.can_id, frame.data) for _, frame in read_log(tmp_path / "run" / "frames.log")]
    with can.LogReader(tmp_path / "tool.log") as log:
        theirs = [(message.arbitration_id, bytes(message.data)) for message in log]
    # The tool also saw the device status scan before the record began.
    assert theirs[-len(ours) :] == ours
