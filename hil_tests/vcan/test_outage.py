"""The interface is taken down during a run and comes back."""

from __future__ import annotations

import subprocess
from collections.abc import Callable

import pytest

from bus.exitcodes import INVALID
from hil_tests.vcan.bench import counters_of, run_on, socketcan
from hil_tests.vcan.dump import frames_of

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600), pytest.mark.usefixtures("can_utils")]

NODES = ("controller", "plant")


def down_at(time_s: float, for_s: float) -> tuple[Callable[[float], None], list[subprocess.Popen[bytes]]]:
    """What takes vcan0 down at this simulation time, and the process that does it."""
    started: list[subprocess.Popen[bytes]] = []

    def disturb(now_s: float) -> None:
        if now_s > time_s and not started:
            script = f"ip link set vcan0 down; sleep {for_s}; ip link set vcan0 up"
            started.append(subprocess.Popen(["sh", "-c", script]))

    return disturb, started


@pytest.fixture(autouse=True)
def up_again():
    """Whatever a test has left: the next one finds the interface up."""
    yield
    subprocess.run(["ip", "link", "set", "vcan0", "up"], check=True)


def test_lockstep_waits_for_the_bus_and_the_record_is_the_same(hop, hop_reference, folder):
    disturb, started = down_at(3.0, 1.0)
    result, exit_codes = run_on(socketcan(), hop, folder, on_progress=disturb)
    assert [process.wait(30) for process in started] == [0]
    assert (result.line, exit_codes, result.frames_sha256) == ("", [0, 0], hop_reference.frames_sha256)
    for role in NODES:
        assert counters_of(folder, role)["outages"] == 1
        said = (folder / f"{role}.txt").read_text().splitlines()
        assert [line.split(" (")[0].split(" after ")[0] for line in said[:2]] == [
            f"{role}: socketcan:vcan0 is down",
            f"{role}: socketcan:vcan0 is back",
        ]


def test_realtime_goes_on_and_says_that_the_record_has_a_hole(hop, folder):
    """Half speed and patient polls: the machine is slow."""
    disturb, started = down_at(3.0, 0.5)
    result, exit_codes = run_on(
        socketcan(), hop, folder, pace="realtime", rate=0.5, reply_ns=200_000_000, on_progress=disturb
    )
    assert [process.wait(30) for process in started] == [0]
    assert (exit_codes, result.exit_code) == ([0, 0], INVALID)
    assert result.line.startswith("record: the recorder was off the bus for ")
    assert result.score.ended in ("ended_complete", "ended_not_stopped")
    assert len(frames_of(folder / "frames.log")) == result.frames
    for role in NODES:
        assert counters_of(folder, role)["outages"] == 1
