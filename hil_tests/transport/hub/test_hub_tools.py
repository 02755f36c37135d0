"""Unmodified python-can tools on the hub."""

from __future__ import annotations

import os
import subprocess
import sys

import can
import pytest

from hil_tests.support.hub import PATIENCE_S, running_hub, socket_folder
from railhil.bus.frame import Frame
from railhil.bus.hub.client import HubBus


@pytest.mark.slow
def test_unmodified_can_logger_records_what_was_sent_and_ends_with_the_hub() -> None:
    with running_hub() as hub, socket_folder() as folder:
        log = folder / "record.log"
        command = [sys.executable, "-u", "-m", "can.logger", "-i", "railhil", "-c", hub.channel, "-f", str(log)]
        logger = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert logger.stdout is not None
        assert "Connected to HubBus" in logger.stdout.readline()
        frames = [Frame(k % 0x800, k.to_bytes(2, "big") * (k % 5)) for k in range(2000)]
        with hub.bus() as bus:
            bus.send_frames(frames)
            bus.send(can.Message(arbitration_id=0x1BADCAFE, is_remote_frame=True, dlc=3))
        hub.end()
        _, stderr = logger.communicate(timeout=PATIENCE_S)
        assert "connection closed by the hub" in stderr.splitlines()[-1]
        with can.LogReader(log) as reader:
            recorded = list(reader)
        assert [(m.arbitration_id, bytes(m.data)) for m in recorded[:-1]] == [f[:2] for f in frames]
        assert recorded[-1].is_remote_frame
        assert recorded[-1].arbitration_id == 0x1BADCAFE


@pytest.mark.slow
def test_unmodified_can_player_is_a_sender() -> None:
    with running_hub() as hub, hub.bus() as bus, socket_folder() as folder:
        log = folder / "play.log"
        log.write_text("".join(f"({k * 1e-4:.6f}) can0 {k:03X}#{k:04X}\n" for k in range(50)))
        command = [sys.executable, "-m", "can.player", "-i", "railhil", "-c", hub.channel, str(log)]
        subprocess.run(command, check=True, timeout=PATIENCE_S, stdout=subprocess.DEVNULL)
        for k in range(50):
            assert bus.recv_frames(PATIENCE_S) == [Frame(k, k.to_bytes(2, "big"))]
        assert bus.recv_frames(0.0) == []


def test_the_default_channel_is_the_users_own(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket_folder() as folder:
        monkeypatch.setenv("XDG_RUNTIME_DIR", str(folder))
        channel = str(folder / f"railhil-{os.getuid()}.sock")
        with running_hub(channel=channel), can.Bus(interface="railhil") as bus:
            assert isinstance(bus, HubBus)
            assert channel in str(bus)
