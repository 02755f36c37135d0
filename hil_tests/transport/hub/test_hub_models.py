"""Bit rate and arbitration as the clients of a hub process see them."""

from __future__ import annotations

import subprocess
import sys
import time

import can
import pytest

from hil_tests.support.hub import PATIENCE_S, running_hub
from railhil.bus.frame import Frame
from railhil.bus.hub.connection import SendTimeout
from railhil.bus.hub.wire_model import frame_bits

_SLOW_BITRATE_BPS = 10_000


def test_with_the_bit_rate_model_frames_take_their_time() -> None:
    frames = [Frame(0x155, bytes([k] * 8)) for k in range(40)]
    wire_time_s = sum(frame_bits(frame)[0] for frame in frames) / _SLOW_BITRATE_BPS
    with running_hub("--bitrate-model", "-b", str(_SLOW_BITRATE_BPS)) as hub, hub.bus() as one, hub.bus() as other:
        assert "10000 bit/s" in hub.ready_line
        assert one.hub_properties["bitrate_bps"] == _SLOW_BITRATE_BPS
        started_s = time.monotonic()
        one.send_frames(frames)
        received = [other.recv_frames(PATIENCE_S) for _ in frames]
        # A lower bound only: the model's clock is the one that is read here.
        assert time.monotonic() - started_s >= wire_time_s
        assert received == [[frame] for frame in frames]
        with pytest.raises(can.CanInitializationError, match="the hub models 10000"):
            hub.bus(bitrate=500_000)
        hub.bus(bitrate=_SLOW_BITRATE_BPS).shutdown()


def test_with_arbitration_urgent_frames_overtake_other_clients_but_not_their_own() -> None:
    options = ("--bitrate-model", "-b", str(_SLOW_BITRATE_BPS), "--arbitration")
    with running_hub(*options) as hub, hub.bus() as bulk, hub.bus() as urgent, hub.bus() as watcher:
        assert "arbitration by identifier" in hub.ready_line
        bulk.send_frames([Frame(0x400, bytes([k])) for k in range(80)])
        assert urgent.recv_frames(PATIENCE_S) == [Frame(0x400, b"\x00")]
        urgent.send_frames([Frame(0x300, b"first"), Frame(0x100, b"second")])
        order = [watcher.recv_frames(PATIENCE_S)[0] for _ in range(82)]
        assert [frame.data[0] for frame in order if frame.can_id == 0x400] == list(range(80))
        places = [order.index(Frame(0x300, b"first")), order.index(Frame(0x100, b"second"))]
        assert places[1] == places[0] + 1
        assert places[1] < 81


def test_the_model_takes_no_more_than_its_transmit_queue_holds() -> None:
    with running_hub("--bitrate-model", "-b", "1000") as hub, hub.bus() as bus:

        def flood() -> None:
            for _ in range(50_000):
                bus.send_frames([Frame(0x100, b"")], timeout_s=0.05)

        with pytest.raises(SendTimeout):
            flood()


@pytest.mark.slow
def test_back_pressure_of_the_model_loses_nothing() -> None:
    with running_hub("--bitrate-model", "-b", "1000000", "--arbitration") as hub, hub.bus() as other:
        script = (
            "import sys\nfrom railhil.bus.frame import Frame\nfrom railhil.bus.hub.client import HubBus\n"
            "with HubBus(sys.argv[1]) as bus:\n"
            "    for k in range(3000):\n"
            "        bus.send_frames([Frame(0x100, k.to_bytes(2, 'big'))])\n"
        )
        sender = subprocess.Popen([sys.executable, "-c", script, hub.channel])
        for number in range(3000):
            assert other.recv_frames(PATIENCE_S) == [Frame(0x100, number.to_bytes(2, "big"))]
        assert sender.wait(PATIENCE_S) == 0
        assert hub.stderr() == ""
