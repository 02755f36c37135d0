"""Real-time runs in processes: the scheduling granted to each, and one of them stopped for a while (fault K2)."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest

from benchmarks.figures import QUICK_TOML
from hil_tests.support.cli import Done, Started, railhil, wait_for
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bus.codes import Event, ends_run
from railhil.common.scheduling import HUB_PRIORITY, NODE_PRIORITY, RECORDER_PRIORITY, permitted_priority
from railhil.dbc import wire_contract
from railhil.judge.jitter import LATE_SHARE_MAX, PAUSE_MS
from railhil.record.framelog import read_log
from railhil.record.trace import trace_of
from railhil.wire.ato import NotchCmd, SimTruth

pytestmark = [pytest.mark.loop, pytest.mark.slow]

#: 12.5 m in 10 s: still under traction when the first 64 KiB of the log are written, after 3 s.
LONG_TOML = """\
extends = "lvshun_tieshan"
name = "long"
[target]
nodes_s_mps2 = [[0, 0.5], [4.9, 0.5], [5.1, -0.5], [10, -0.5]]
[plan]
distance_m = 12.4983
running_time_s = 10
overtime_max_s = 1
"""
#: How long a process is stopped, s of wall time.
STOPPED_S = 0.3
ROLES = ("hub", "plant", "controller", "supervisor")
PERMITTED = permitted_priority()[0] == NODE_PRIORITY


@pytest.fixture(scope="module")
def scenarios(tmp_path_factory) -> Path:
    """Folder with scenarios of 8, 4 and 10 s."""
    folder = tmp_path_factory.mktemp("scenarios")
    (folder / "quick.toml").write_text(QUICK_TOML, encoding="utf-8")
    (folder / "short.toml").write_text(RUN_2M_TOML, encoding="utf-8")
    (folder / "long.toml").write_text(LONG_TOML, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def with_fifo(scenarios: Path) -> Path:
    """Run folder at ten times real time."""
    return finished(scenarios, "fifo", "--rate", "10")


def finished(folder: Path, name: str, *options: str) -> Path:
    out = folder / name
    words = ("--pace", "realtime", "--quiet", "--json", "--out", out, *options)
    done = railhil("run", folder / "quick.toml", *words, anew=True)
    assert done.exit_code in (0, 1, 3), done.err
    assert done.json == score(out)
    return out


def score(folder: Path) -> dict:
    return json.loads((folder / "score.json").read_text(encoding="utf-8"))


def permits_no_verdict(document: dict) -> bool:
    """Whether a run in real time is INVALID: by the plant's own lateness, or by a gap of the record, which then is said
    before it (:func:`railhil.run.conclusion.late_reason`)."""
    lateness = document["run"]["timing"]["lateness"]
    is_late = lateness["late_share"] > LATE_SHARE_MAX or lateness["max_ms"] >= PAUSE_MS
    assert is_late is ("timing: " in document["line"])
    return is_late or document["line"].startswith("record: ")


def stopped_in_motion(scenario: Path, out: Path, rate: str, role: str | None) -> tuple[Done, dict]:
    """A realtime run of which one process (None: the supervisor) is stopped for a while in the middle."""
    run = Started("run", scenario, "--pace", "realtime", "--rate", rate, "--quiet", "--no-report", "--out", out)
    process = run.process if role is None else run.child(role)
    wait_for(lambda: (out / "frames.log").stat().st_size > 60_000)
    process.send_signal(signal.SIGSTOP)
    time.sleep(STOPPED_S)
    process.send_signal(signal.SIGCONT)
    done, _ = run.finish()
    assert "Traceback" not in done.out + done.err
    return done, score(out)


def test_each_process_says_what_it_was_granted(with_fifo: Path) -> None:
    timing = score(with_fifo)["run"]["timing"]
    assert set(timing["scheduling"]) == set(ROLES)
    priorities = (HUB_PRIORITY, NODE_PRIORITY, NODE_PRIORITY, RECORDER_PRIORITY)
    for role, priority in zip(ROLES, priorities, strict=True):
        sentence = timing["scheduling"][role]
        assert re.match(rf"SCHED_FIFO {priority}, " if PERMITTED else "not permitted", sentence), sentence
        if role != "supervisor":
            assert f"{role}: scheduling: {sentence}\n" in (with_fifo / f"{role}.txt").read_text()


def test_the_plant_has_measured_every_cycle_and_every_poll(with_fifo: Path) -> None:
    document = score(with_fifo)
    timing = document["run"]["timing"]
    assert timing["source"] == "plant"
    trace = trace_of(read_log(with_fifo / "frames.log"), wire_contract())
    ticks = round(document["run"]["sim_time_s"] * 100) + 1
    assert timing["lateness"]["cycles"] == sum(timing["histogram"]["counts"]) == ticks
    assert {item["port"] for item in timing["answers"]} == {"SUP_CMD", "NOTCH_CMD", "CTL_STAT"}
    # The record also has the polls of the handshake and the last one of the run.
    assert trace.polls - 5 <= timing["polls"] <= trace.polls
    assert document["jitter"] == timing["lateness"]
    assert (document["verdict"] == "INVALID") is permits_no_verdict(document), document["line"]
    assert {"timing.csv", "wall.csv"} <= {path.name for path in with_fifo.iterdir()}


def test_the_report_can_be_made_again(with_fifo: Path) -> None:
    before = (with_fifo / "report.html").read_text(encoding="utf-8")
    assert railhil("report", with_fifo).exit_code == 0
    assert (with_fifo / "report.html").read_text(encoding="utf-8") == before
    assert before.count('<figure id="lateness">') == 1


def test_realtime_scheduling_can_be_left_out(scenarios: Path) -> None:
    out = finished(scenarios, "normal", "--rate", "20", "--no-rt", "--no-report")
    assert score(out)["run"]["timing"]["scheduling"] == dict.fromkeys(ROLES, "normal scheduling")
    assert "--no-rt" in json.loads((out / "certificate.json").read_text(encoding="utf-8"))["command"]


@pytest.mark.wall_clock
def test_a_pause_of_the_plant_is_flagged(scenarios: Path, tmp_path: Path) -> None:
    """K2. Simulation time stands still with the plant, so no telegram ages: what is left to do is to say so."""
    done, document = stopped_in_motion(scenarios / "quick.toml", tmp_path / "run", "4", "plant")
    timing = document["run"]["timing"]
    assert timing["source"] == "plant"
    assert timing["lateness"]["max_ms"] > STOPPED_S * 1e3 * 0.9
    assert (done.exit_code, document["verdict"]) == (3, "INVALID")
    assert permits_no_verdict(document)


@pytest.mark.wall_clock
def test_a_pause_of_the_supervisor_is_not(scenarios: Path, tmp_path: Path) -> None:
    done, document = stopped_in_motion(scenarios / "short.toml", tmp_path / "run", "2", None)
    timing = document["run"]["timing"]
    assert timing["arrivals"]["max_ms"] > STOPPED_S * 1e3 * 0.9
    sup = next(item for item in timing["answers"] if item["port"] == "SUP_CMD")
    assert sup["missed"] >= 1, "the plant has polled while nobody answered"
    # Whatever else this machine did meanwhile: the verdict is that of the plant's own lateness.
    assert (done.exit_code == 3) is permits_no_verdict(document), document["line"]
    # Nothing is missing in the record.
    trace = trace_of(read_log(tmp_path / "run" / "frames.log"), wire_contract())
    assert set(np.diff(trace.raw("TRN_SPEED", "SpeedLife")) % 16) == {1}


@pytest.mark.wall_clock
def test_a_pause_of_the_controller_is_missed_polls_and_the_trains_ladder(scenarios: Path, tmp_path: Path) -> None:
    """The train's watch cuts traction after 64 ms and brakes after 256 ms; late answers are not taken for new ones."""
    done, document = stopped_in_motion(scenarios / "long.toml", tmp_path / "run", "2", "controller")
    assert (done.exit_code == 3) is permits_no_verdict(document), document["line"]
    notch = next(item for item in document["run"]["timing"]["answers"] if item["port"] == "NOTCH_CMD")
    assert notch["missed"] >= STOPPED_S / 0.02 - 3
    trace = trace_of(read_log(tmp_path / "run" / "frames.log"), wire_contract())
    times_s, truth_s = trace.times_s(NotchCmd.PORT), trace.times_s(SimTruth.PORT)
    widest = int(np.argmax(np.diff(times_s)))
    silent = (truth_s > times_s[widest] + 0.12) & (truth_s < times_s[widest + 1])
    traction_n = trace.values(SimTruth.PORT, "TractionForce")
    assert traction_n[truth_s <= times_s[widest]][-1] > 0.0
    assert silent.any()
    assert traction_n[silent].max() == 0.0
    braked = (truth_s > times_s[widest] + 0.29) & (truth_s < times_s[widest] + 0.6)
    assert trace.values(SimTruth.PORT, "BrakeForce")[braked].max() > 0.0
    assert np.diff(trace.times_s("TRN_SPEED")).max() == pytest.approx(0.01), "time goes on without the controller"


@pytest.mark.wall_clock
@pytest.mark.faults
def test_a_hub_that_stands_still_across_the_end_delivers_the_last_second(scenarios: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    options = ("--pace", "realtime", "--rate", "8", "--quiet", "--no-report", "--out", out)
    run = Started("run", scenarios / "long.toml", *options)
    hub, plant = run.child("hub"), run.child("plant")
    wait_for(lambda: (out / "frames.log").stat().st_size > 150_000)
    hub.send_signal(signal.SIGSTOP)
    wait_for(lambda: not plant.is_running() or plant.status() == psutil.STATUS_ZOMBIE)
    hub.send_signal(signal.SIGCONT)
    done, _ = run.finish()
    assert done.exit_code in (0, 1, 3)
    assert "lost at simulation time" not in done.out
    trace = trace_of(read_log(out / "frames.log"), wire_contract())
    # Without the hub the train has had no commands; how the plant sees that depends on how long it was.
    assert ends_run(trace.raw("RUN_EVENT", "RunEvent")[-1])
    assert np.diff(trace.times_s("TRN_SPEED")).max() == pytest.approx(0.01), "nothing is missing in the record"


@pytest.mark.wall_clock
@pytest.mark.faults
def test_a_controller_suspended_for_good_is_named(scenarios: Path, tmp_path: Path) -> None:
    """The train stops by its own watch; nobody waits for the end of a process that cannot end."""
    out = tmp_path / "run"
    options = ("--pace", "realtime", "--rate", "20", "--quiet", "--no-report", "--out", out)
    run = Started("run", scenarios / "long.toml", *options)
    wait_for(lambda: (out / "frames.log").stat().st_size > 60_000)
    controller = run.child("controller")
    controller.send_signal(signal.SIGSTOP)
    done, _ = run.finish()
    assert done.exit_code == 3
    assert "INVALID: controller lost at simulation time" in done.out
    assert "suspended by a signal (SIGSTOP)" in done.out
    assert not controller.is_running()
    trace = trace_of(read_log(out / "frames.log"), wire_contract())
    assert trace.raw("RUN_EVENT", "RunEvent")[-1] == Event.ENDED_CONTROLLER_LOST
    assert trace.values("SIM_TRUTH", "TrueSpeed")[-1] == 0


def test_a_plant_that_is_elsewhere_is_judged_by_its_arrivals(scenarios: Path, tmp_path: Path, socket_folder) -> None:
    channel = str(socket_folder / "hub.sock")
    bus = ("-i", "railhil", "-c", channel, "--bus-kwargs", "connect_timeout=10")
    scenario = str(scenarios / "quick.toml")
    pace = ("--pace", "realtime", "--rate", "10")
    nodes = [
        subprocess.Popen([sys.executable, "-m", *words], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        for words in (
            ("railhil.bus.hub", "-c", channel),
            ("railhil.plant_sim", scenario, *pace, *bus),
            ("railhil.controller_node", scenario, *bus),
        )
    ]
    try:
        out = tmp_path / "run"
        # Without the plant's rate: that stands in TIME_SYNC.
        done = railhil("run", scenario, "--attach", *pace[:2], "--quiet", "--out", out, *bus, anew=True)
        assert done.exit_code in (0, 1, 3), done.err
    finally:
        for node in nodes:
            node.terminate()
        codes = [node.wait(20) for node in nodes]
    assert codes[0] == 0
    timing = score(out)["run"]["timing"]
    assert (timing["source"], timing["answers"], list(timing["scheduling"])) == ("supervisor", [], ["supervisor"])
    assert timing["lateness"] == timing["arrivals"]
    assert timing["pace"] == "pace of the plant: 10 as TIME_SYNC says in tenths, not 1 (--rate)"
    assert timing["pace"] in done.out
    assert "(measured by the supervisor)" in done.out
    assert "plant and controller were started elsewhere" in done.out
