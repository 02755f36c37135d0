"""A controller behind a serial adapter: the same bytes in lockstep; unplugged, bus-off and stuck in motion."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from hil_tests.support.adapter_rig import Rig, Timetable
from hil_tests.support.cli import command, railhil
from hil_tests.support.foreign import build_node, export_node, without_status
from hil_tests.support.warm import run_module
from hil_tests.transport.vcan.bench import counters_of, run_on
from railhil.bench import local_run
from railhil.bus.codes import Event, ends_run
from railhil.bus.link import Timeouts
from railhil.dbc import wire_contract
from railhil.judge.record_checks import UNCLEAR
from railhil.judge.result import Result
from railhil.record.framelog import read_log
from railhil.record.trace import Trace, trace_of
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec
from railhil.systems.ato.scenario.model import Scenario

pytestmark = [pytest.mark.loop, pytest.mark.timeout(300)]

_SEED = 1
#: A move of 17 s and 48 m: up to 17 km/h, coast, brake.
_MOVE = """\
extends = "lvshun_tieshan"
name = "short_move"
title = "17 s and 48 m"
[target]
nodes_s_mps2 = [[0.0, 0.0], [2.0, 0.8], [6.0, 0.8], [8.0, 0.0], [10.0, 0.0], [12.0, -0.8]]
[plan]
distance_m = 47.8667
running_time_s = 17
stop_error_max_m = 2.0
"""
#: Ladder of the published train, s: service brake and emergency without a command.
_SERVICE_BRAKE_S, _EMERGENCY_S = 0.256, 1.0
#: Simulated seconds per second of the runs in real time; what is done to the adapter lasts seconds of the machine.
_RATE = 2.0
#: A machine that stands still for so long (50 ms of the run) disturbs more than the adapter does.
_PAUSE_MS = 50.0 / _RATE
#: An order given at a poll of the supervisor (every 0.16 s), the loop of the adapter, one poll of the notch.
_LATER_S = 0.25


@pytest.fixture(scope="module")
def move_file(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("move") / "move.toml"
    path.write_text(_MOVE)
    return path


@pytest.fixture(scope="module")
def move(move_file) -> Scenario:
    return load(str(move_file))


@pytest.fixture
def rig(socket_folder) -> Iterator[Rig]:
    with Rig(socket_folder) as found:
        yield found


def realtime(
    socket_folder: Path, move: Scenario, move_file: Path, folder: Path, orders: dict[float, str]
) -> tuple[Result, Trace, list[str]]:
    """A run in real time with the adapter disturbed: result, record and the controller's lines. It must have been
    served to its end by the controller's process, and the record must be whole.

    A run in which the machine itself stood still says nothing about the adapter: it is made again, twice at most.
    """
    for attempt in range(3):
        out = folder / f"{attempt}"
        out.mkdir(parents=True)
        with Rig(socket_folder) as rig:
            timetable = Timetable(rig, orders)
            result, exit_codes = run_on(
                rig.hub, move, out, seed=_SEED, pace="realtime", rate=_RATE, on_progress=timetable,
                controller_command=rig.controller_command(move_file),
            )  # fmt: skip
            status = rig.status()
        assert result.timing is not None
        assert result.timing.jitter is not None
        if result.timing.jitter.max_ms < _PAUSE_MS:
            break
    assert_whole(result, out, move_file)
    assert exit_codes == [0, 0], (out / "controller.txt").read_text()
    assert status["plugged_in"]
    assert len(timetable.given_s) == len(orders), result.line
    lines = (out / "controller.txt").read_text().splitlines()
    return (
        result,
        trace_of(read_log(out / "frames.log"), wire_contract()),
        [line for line in lines if "slcan:" in line][1:],
    )


def assert_whole(result: Result, folder: Path, move_file: Path) -> None:
    """The record ends with the run, and the score comes out of it again."""
    trace = trace_of(read_log(folder / "frames.log"), wire_contract())
    assert ends_run(trace.raw("RUN_EVENT", "RunEvent")[-1])
    assert set((np.diff(trace.raw("TRN_SPEED", "SpeedLife")) % 16).tolist()) == {1}
    again = railhil("score", folder / "frames.log", "--scenario", move_file, "--json").json
    assert again["verdict"] == result.score.verdict
    assert again["scores"]["itae"] == result.score.values["itae"]


def assert_judged(result: Result, *verdicts: str) -> None:
    """A verdict of the scorer, not a failure of the bench: after an outage in real time the order of telegrams at the
    controller may not be known from the record, and the machine may have been late."""
    found = result.score
    if found.verdict in verdicts:
        assert result.exit_code in (0, 1) or "timing: " in result.line, result.line
    else:
        assert (found.verdict, found.failures[0].startswith(UNCLEAR)) == ("INVALID", True), found.failures


def events(trace: Trace) -> list[Event]:
    return [Event(number) for number in trace.raw("RUN_EVENT", "RunEvent")]


def braking_n(trace: Trace, from_s: float, to_s: float) -> float:
    """Greatest brake force in an interval."""
    times_s = trace.times_s("SIM_TRUTH")
    return float(trace.values("SIM_TRUTH", "BrakeForce")[(times_s >= from_s) & (times_s <= to_s)].max())


def silence_s(trace: Trace, order_s: float) -> tuple[float, float]:
    """Begin and length of the time without NOTCH_CMD that an order at ``order_s`` has caused."""
    times_s = trace.times_s("NOTCH_CMD")
    first = int(np.flatnonzero((np.diff(times_s) > 0.2) & (times_s[1:] > order_s + 0.1))[0])
    return float(times_s[first]), float(times_s[first + 1] - times_s[first])


# -- lockstep -----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_controller_behind_an_adapter_gives_the_same_bytes(rig, move, move_file, tmp_path):
    (tmp_path / "run").mkdir()
    (tmp_path / "local").mkdir()
    result, exit_codes = run_on(
        rig.hub, move, tmp_path / "run", seed=_SEED, controller_command=rig.controller_command(move_file)
    )
    assert (result.line, exit_codes) == ("", [0, 0])
    assert result.frames_sha256 == local_run(move, tmp_path / "local", RunSpec(seed=_SEED)).frames_sha256
    status = rig.status()
    # Opened twice by python-can (once with the bit rate), closed before that and at the end.
    found = {key: status[key] for key in ("open", "bit_rate", "refused_frames", "receive_overrun") if key in status}
    assert found == {"open": False, "bit_rate": 500_000}
    assert status["transmitted"] > 1000


@pytest.mark.slow
@pytest.mark.needs_compiler
def test_the_exported_program_behind_an_adapter_gives_the_same_frames(rig, move, tmp_path):
    for name in ("run", "local"):
        (tmp_path / name).mkdir()
    export_node(move, tmp_path / "export")
    program = build_node(tmp_path / "export")
    line = [str(program), "slcan", str(rig.port)]
    result, exit_codes = run_on(rig.hub, move, tmp_path / "run", seed=_SEED, controller_command=line)
    assert (result.line, exit_codes) == ("", [0, 0])
    local_run(move, tmp_path / "local", RunSpec(seed=_SEED))
    found, expected = (without_status(tmp_path / name / "frames.log") for name in ("run", "local"))
    assert found == expected
    assert rig.status()["bit_rate"] == 500_000


@pytest.mark.long
@pytest.mark.slow
def test_fd_frames_pass_the_adapter(socket_folder, move, move_file, tmp_path):
    """All by hand, the telegrams as CAN FD frames, on an adapter that can, and that answers nothing."""
    with Rig(socket_folder, "--fd", "--no-answers") as rig:
        hub = ("--fd", "-i", "railhil", "-c", rig.hub["channel"])
        plant = [*command("node", "plant", move_file, "--seed", str(_SEED)), *hub]
        nodes = [subprocess.Popen(line) for line in (plant, rig.controller_command(move_file, "--fd"))]
        try:
            done = railhil(
                "run", move_file, "--attach", "--seed", str(_SEED), "--out", tmp_path / "run", "--json", *hub
            )
            assert [node.wait(30) for node in nodes] == [0, 0]
        finally:
            for node in nodes:
                node.kill()
                node.wait()
    assert done.exit_code in (0, 1), done.err
    (tmp_path / "local").mkdir()
    local = local_run(move, tmp_path / "local", RunSpec(seed=_SEED), fd=True)
    assert (tmp_path / "run" / "frames.log").read_text() == local.log.read_text()


# -- real time, disturbed -----------------------------------------------------------------------------------------


@pytest.mark.faults
@pytest.mark.wall_clock
def test_unplugged_for_two_seconds_in_motion(socket_folder, move, move_file, tmp_path):
    result, trace, said = realtime(socket_folder, move, move_file, tmp_path / "run", {8.0: "unplug 1"})
    begin_s, length_s = silence_s(trace, 8.0)
    assert begin_s == pytest.approx(8.0, abs=_LATER_S)
    assert 1.9 < length_s < 3.0
    speeds_mps, times_s = trace.values("SIM_TRUTH", "TrueSpeed"), trace.times_s("SIM_TRUTH")
    # How soon the driver finds it again is the machine's affair; it may take until the train stands.
    assert speeds_mps[times_s > begin_s + 2][0] > 0, "plugged in again in motion"
    # The train's own watch: service brake, then emergency, which stays. The last answers may have come too late for it.
    emergency_s = trace.times_s("RUN_EVENT")[events(trace).index(Event.EMERGENCY)]
    assert _EMERGENCY_S - _LATER_S < emergency_s - begin_s < _EMERGENCY_S + 0.05
    full_n = braking_n(trace, emergency_s, emergency_s + 1)
    assert 0 < braking_n(trace, begin_s, emergency_s - 0.05) < 0.8 * full_n
    assert events(trace)[-1] is Event.ENDED_COMPLETE
    assert trace.values("SIM_TRUTH", "TrueSpeed")[-1] == 0
    # The controller commands again until the end, and its life sign goes on.
    after = trace.times_s("NOTCH_CMD") > begin_s + length_s
    assert after.sum() > 20
    assert set((np.diff(trace.raw("NOTCH_CMD", "NotchLife")[after]) % 16).tolist()) == {1}
    assert_judged(result, "FAIL")
    assert len(said) == 3, said
    assert "is down (" in said[0]
    assert "is back after 1." in said[1]
    assert "outages 1" in said[2]


@pytest.mark.faults
@pytest.mark.wall_clock
def test_short_disturbances_are_ridden_out(socket_folder, move, move_file, tmp_path):
    """Unplugged, bus-off and stuck, 0.3 s of the run each: service brake at most; the train still stops where it
    should."""
    orders = {3.0: "unplug 0.15", 6.5: "busoff 0.15", 9.5: "stall 0.15", 11.0: "garble 60"}
    result, trace, said = realtime(socket_folder, move, move_file, tmp_path / "run", orders)
    assert Event.EMERGENCY not in events(trace)
    assert events(trace)[-1] is Event.ENDED_COMPLETE
    assert_judged(result, "PASS", "FAIL")
    for order_s, order in orders.items():
        if order.endswith("0.15"):
            begin_s, length_s = silence_s(trace, order_s)
            assert begin_s == pytest.approx(order_s, abs=_LATER_S)
            assert 0.2 < length_s < _EMERGENCY_S
            if length_s > _SERVICE_BRAKE_S + 0.05:
                assert braking_n(trace, begin_s, begin_s + length_s + 0.3) > 0
    # Time that is lost is not made up for: the law by time stops the train where it then is, before the stopping point.
    assert trace.values("SIM_TRUTH", "TruePos")[-1] < move.plan.distance_m
    # What was on the way to the stuck adapter comes late, but it is no more than the commands of 30 ms on the wire.
    begin_s, _ = silence_s(trace, 9.5)
    times_s = trace.times_s("NOTCH_CMD")
    lives = trace.raw("NOTCH_CMD", "NotchLife")[times_s >= begin_s][:20]
    jump = np.flatnonzero(np.diff(lives) % 16 != 1)
    assert len(jump) == 1, lives
    assert jump[0] <= 3 * _RATE, lives
    assert "outages" in said[-1]


@pytest.mark.faults
@pytest.mark.wall_clock
def test_one_that_stays_unplugged_ends_the_controller(rig, move, tmp_path):
    """The train stops by itself, the record is whole; the controller gives up with one line and exit code 3."""
    folder = tmp_path / "run"
    folder.mkdir()
    result, exit_codes = run_on(
        rig.hub, move, folder, seed=_SEED, pace="realtime", rate=_RATE, controller_config=rig.adapter,
        on_progress=Timetable(rig, {5.0: "unplug"}), timeouts=Timeouts(give_up_s=3.0),
    )  # fmt: skip
    assert exit_codes == [3, 0]
    trace = trace_of(read_log(folder / "frames.log"), wire_contract())
    assert events(trace)[-1] is Event.ENDED_CONTROLLER_LOST
    assert trace.values("SIM_TRUTH", "TrueSpeed")[-1] == 0
    assert result.exit_code == 3
    said = (folder / "controller.txt").read_text().splitlines()
    assert len(said) == 3, said
    assert "is down (" in said[0]
    assert "not back within 3 s" in said[-1]
    assert counters_of(folder, "controller")["outages"] == 1


def test_program_says_in_one_line_what_it_cannot_do(tmp_path):
    (tmp_path / "file").write_text("")
    bus = ("-i", "railhil", "-c", str(tmp_path / "no.sock"), "--bus-kwargs", "connect_timeout=0")
    for options, text in (
        (("--link", str(tmp_path / "file"), *bus), "is no symbolic link"),
        (("--link", str(tmp_path / "tty"), *bus), "no hub at"),
        (("--link", str(tmp_path / "tty"), "--queue", "0", *bus), "--queue"),
    ):
        done = run_module("railhil.machines.adapter", options, environment=os.environ)
        assert (done.returncode, len(done.stderr.strip().splitlines())) == (2, 1), done.stderr
        assert text in done.stderr
