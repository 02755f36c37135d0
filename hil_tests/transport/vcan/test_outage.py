"""The interface is taken down during a run and comes back.

It is taken down while all nodes wait for the supervisor. At another moment a frame may be lost unnoticed: the
kernel clears ``__LINK_STATE_START``, after which vcan drops what is sent, some milliseconds before ``IFF_UP``, after
which a send fails.
"""

from __future__ import annotations

import fcntl
import multiprocessing
import socket
import time
from collections.abc import Callable
from multiprocessing.process import BaseProcess
from struct import Struct

import pytest

from hil_tests.transport.vcan.bench import counters_of, run_on, socketcan
from hil_tests.transport.vcan.dump import frames_of
from railhil.common.exit_codes import INVALID

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600)]

NODES = ("controller", "plant")
_SIOCGIFFLAGS, _SIOCSIFFLAGS = 0x8913, 0x8914
_IFF_UP = 1
_IFREQ = Struct("16sH22x")


def switch(up: bool) -> None:
    """What ``ip link set vcan0 up`` and ``down`` do, without the time to start a process in a slow machine."""
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as control:
        name, flags = _IFREQ.unpack(fcntl.ioctl(control, _SIOCGIFFLAGS, _IFREQ.pack(b"vcan0", 0)))
        fcntl.ioctl(control, _SIOCSIFFLAGS, _IFREQ.pack(name, flags | _IFF_UP if up else flags & ~_IFF_UP))


def down_at(time_s: float, for_s: float) -> tuple[Callable[[float], None], list[BaseProcess]]:
    """What takes vcan0 down at this simulation time, and the process that takes it up again."""
    started: list[BaseProcess] = []

    def take_up() -> None:
        time.sleep(for_s)
        switch(up=True)

    def disturb(now_s: float) -> None:
        if now_s > time_s and not started:
            started.append(multiprocessing.get_context("fork").Process(target=take_up))
            switch(up=False)
            started[0].start()

    return disturb, started


@pytest.fixture(autouse=True)
def up_again():
    """Whatever a test has left: the next one finds the interface up."""
    yield
    switch(up=True)


@pytest.mark.faults
def test_lockstep_waits_for_the_bus_and_the_record_is_the_same(hop, hop_reference, folder):
    disturb, started = down_at(3.0, 1.0)
    result, exit_codes = run_on(socketcan(), hop, folder, on_progress=disturb)
    assert [process.exitcode for process in started] == [0]
    assert (result.line, exit_codes, result.frames_sha256) == ("", [0, 0], hop_reference.frames_sha256)
    for role in NODES:
        assert counters_of(folder, role)["outages"] == 1
        said = (folder / f"{role}.txt").read_text().splitlines()
        assert [line.split(" (")[0].split(" after ")[0] for line in said[:2]] == [
            f"{role}: socketcan:vcan0 is down",
            f"{role}: socketcan:vcan0 is back",
        ]


@pytest.mark.faults
def test_realtime_goes_on_and_says_that_the_record_has_a_hole(hop, folder):
    """With patient polls: the machine is slow."""
    disturb, started = down_at(3.0, 0.5)
    result, exit_codes = run_on(socketcan(), hop, folder, pace="realtime", reply_ns=200_000_000, on_progress=disturb)
    assert [process.exitcode for process in started] == [0]
    assert (exit_codes, result.exit_code) == ([0, 0], INVALID)
    assert result.line.startswith("record: the recorder was off the bus for ")
    assert result.score.ended in ("ended_complete", "ended_not_stopped")
    assert len(frames_of(folder / "frames.log")) == result.frames
    for role in NODES:
        assert counters_of(folder, role)["outages"] == 1
