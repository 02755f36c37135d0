"""Complete runs through the gateway: plant on one bus, controller on another, and buses that fail during the run."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from hil_tests.support.cli import TIMEOUT_S, command, railhil, wait_for
from hil_tests.support.hub import PATIENCE_S, gateway, node, running_hub, two_hubs_and_a_gateway
from hil_tests.support.short_runs import RUN_72M_TOML, RUN_297M_TOML
from railhil.bench import local_run
from railhil.bus.codes import Event
from railhil.dbc import wire_contract
from railhil.record.framelog import read_log, sha256_of
from railhil.record.trace import trace_of
from railhil.scenarios.load import load

pytestmark = pytest.mark.loop


@pytest.fixture
def short(tmp_path: Path) -> Path:
    """A scenario of 24 s."""
    path = tmp_path / "short.toml"
    path.write_text(RUN_72M_TOML)
    return path


def _recorded(scenario: str | Path, folder: Path, channel: str, *options: str) -> int:
    words = ("--attach", "-i", "railhil", "-c", channel, "--out", folder, "--quiet", "--no-report", *options)
    done = railhil("run", scenario, *words)
    assert "Traceback" not in done.err
    return done.exit_code


@pytest.mark.long
@pytest.mark.slow
def test_a_run_through_the_gateway_has_the_bytes_of_every_other_transport(tmp_path: Path) -> None:
    """Plant on one bus, controller on the other, supervisor at the gateway itself; a journey of 42 s."""
    scenario = tmp_path / "journey.toml"
    scenario.write_text(RUN_297M_TOML)
    reference = local_run(load(str(scenario)), tmp_path)
    with (
        two_hubs_and_a_gateway(options=("--lossless",)) as (a, b, between),
        node("controller", scenario, b.channel) as controller,
        node("plant", scenario, a.channel) as plant,
    ):
        assert _recorded(scenario, tmp_path / "run", between.channel) in (0, 1)
        assert [controller.wait(PATIENCE_S), plant.wait(PATIENCE_S)] == [0, 0]
        assert between.end() == 0
        assert "dropped" not in between.stderr()
    assert sha256_of(tmp_path / "run/frames.log") == reference.frames_sha256


@pytest.mark.slow
def test_the_supervisor_may_sit_at_the_controller_s_bus_and_telegrams_may_be_can_fd(
    tmp_path: Path, short: Path
) -> None:
    reference = local_run(load(str(short)), tmp_path, fd=True)
    with (
        two_hubs_and_a_gateway(options=("--lossless",), settings=",fd=true") as (a, b, _),
        node("controller", short, b.channel, "--fd") as controller,
        node("plant", short, a.channel, "--fd") as plant,
    ):
        assert _recorded(short, tmp_path / "run", b.channel, "--fd") in (0, 1)
        assert [controller.wait(PATIENCE_S), plant.wait(PATIENCE_S)] == [0, 0]
    assert sha256_of(tmp_path / "run/frames.log") == reference.frames_sha256


@pytest.mark.faults
@pytest.mark.wall_clock
def test_an_adapter_of_the_gateway_is_unplugged_in_motion(tmp_path: Path, short: Path, socket_folder: Path) -> None:
    """The controller hears nothing for a moment, the train reacts, and then they hear each other again."""
    port = socket_folder / "tty"
    with running_hub() as a:
        adapter = subprocess.Popen(
            [sys.executable, "-m", "railhil.machines.adapter", "--link", str(port), "-i", "railhil", "-c", a.channel],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        try:
            wait_for(port.exists)
            pace = ("--pace", "realtime", "--rate", "4")
            with (
                gateway(f"slcan:{port},bitrate=500000,sleep_after_open=0") as between,
                node("controller", short, between.channel) as controller,
                node("plant", short, a.channel, *pace) as plant,
            ):
                folder = tmp_path / "run"
                words = ("--attach", "-i", "railhil", "-c", a.channel, "--out", folder, "--quiet", "--no-report", *pace)
                run = subprocess.Popen(
                    command("run", short, *words), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
                )
                wait_for(lambda: (folder / "frames.log").stat().st_size > 150_000)
                assert adapter.stdin is not None
                adapter.stdin.write("unplug 0.1\n")
                adapter.stdin.flush()
                _, err = run.communicate(timeout=TIMEOUT_S)
                assert "Traceback" not in err
                assert [controller.wait(PATIENCE_S), plant.wait(PATIENCE_S)] == [0, 0]
                assert between.end() == 0
                said = between.stderr()
        finally:
            adapter.kill()
            adapter.communicate(timeout=PATIENCE_S)
    assert f"railhil hub: slcan:{port} is down" in said
    assert f"railhil hub: slcan:{port} is back after" in said
    assert ", 1 outage" in said.splitlines()[-1]
    trace = trace_of(read_log(folder / "frames.log"), wire_contract())
    assert trace.raw("RUN_EVENT", "RunEvent")[-1] in (Event.ENDED_COMPLETE, Event.ENDED_NOT_STOPPED)
    times_s = trace.times_s("NOTCH_CMD")
    gaps_s = times_s[1:] - times_s[:-1]
    start_s = times_s[gaps_s.argmax()]
    end_s = start_s + gaps_s.max()
    assert gaps_s.max() > 0.2
    assert end_s < times_s[-1] - 1.0, "it answers again"
    truth_s = trace.times_s("SIM_TRUTH")
    meanwhile = (truth_s > start_s + 0.15) & (truth_s < end_s)
    assert trace.values("SIM_TRUTH", "TractionForce")[meanwhile].max() == 0, "traction is cut within 0.15 s"


@pytest.mark.faults
@pytest.mark.slow
def test_when_the_controller_s_bus_dies_the_train_stops_by_itself(tmp_path: Path, short: Path) -> None:
    with (
        two_hubs_and_a_gateway(options=("--lossless",)) as (a, b, between),
        node("controller", short, b.channel) as controller,
        node("plant", short, a.channel, "--pace", "realtime", "--rate", "4"),
    ):
        folder = tmp_path / "run"
        words = ("--attach", "-i", "railhil", "-c", a.channel, "--out", folder, "--quiet", "--no-report")
        run = subprocess.Popen(
            command("run", short, *words, "--pace", "realtime", "--rate", "4"),
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        wait_for(lambda: (folder / "frames.log").stat().st_size > 200_000)
        b.end(signal.SIGKILL)
        out, err = run.communicate(timeout=TIMEOUT_S)
        assert (run.returncode, "Traceback" in out + err) == (3, False)
        assert controller.wait(PATIENCE_S) == 3
        assert controller.stderr is not None
        assert f"railhil hub at {b.channel}" in controller.stderr.read()
        assert f"port railhil:{b.channel} is down" in between.stderr()
    trace = trace_of(read_log(folder / "frames.log"), wire_contract())
    last_notch_s = trace.times_s("NOTCH_CMD")[-1]
    after = trace.times_s("SIM_TRUTH") > last_notch_s + 0.2
    assert after.any()
    assert trace.values("SIM_TRUTH", "TractionForce")[after].max() == 0, "traction is cut"
    assert trace.values("SIM_TRUTH", "TrueSpeed")[-1] == 0
