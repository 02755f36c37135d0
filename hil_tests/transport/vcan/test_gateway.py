"""The hub as gateway between two kernel interfaces: plant and supervisor on vcan0, the controller on vcan1."""

from __future__ import annotations

import multiprocessing
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from hil_tests.support.cli import wait_for
from hil_tests.transport.vcan.bench import counters_of, run_on, socketcan
from railhil.bus.frame import ERROR, Frame
from railhil.bus.hub.client import HubBus
from railhil.bus.hub.portspec import parse_ports
from railhil.bus.hub.server import HubSpec, serve
from railhil.bus.link import Link, open_link
from railhil.testing.result import disturbed

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600)]

#: Long enough for any machine.
_PATIENCE_S = 60.0
_PLAIN = Frame(0x123, b"plain")


@dataclass
class Gateway:
    """A running gateway: where its own clients attach, and what it has said."""

    channel: str
    said: Path
    process: multiprocessing.process.BaseProcess

    def end(self) -> list[str]:
        """End it; the lines that it has said on standard error."""
        self.process.terminate()
        self.process.join(_PATIENCE_S)
        assert self.process.exitcode == 0
        return self.said.read_text().splitlines()


@pytest.fixture
def gateway() -> Iterator[Gateway]:
    """A hub with vcan0 and vcan1 as ports, forked as the nodes are."""
    with tempfile.TemporaryDirectory(prefix="railhil-") as folder:
        channel, said = f"{folder}/hub.sock", Path(folder) / "said.txt"

        def run() -> None:
            sys.stderr = said.open("w")
            ports = parse_ports(["socketcan:vcan0", "socketcan:vcan1"], channel)
            serve(channel, HubSpec(ports=ports, lossless=True))

        process = multiprocessing.get_context("fork").Process(target=run)
        process.start()
        try:
            HubBus(channel, connect_timeout=_PATIENCE_S).shutdown()
            yield Gateway(channel, said, process)
        finally:
            process.kill()
            process.join()
            print(said.read_text())


def test_run_through_the_gateway_gives_the_bytes_of_every_other_transport(gateway, hop, hop_reference, folder):
    result, exit_codes = run_on(socketcan("vcan0"), hop, folder, controller_config=socketcan("vcan1"))
    assert (result.line, exit_codes) == ("", [0, 0])
    assert [disturbed(counters_of(folder, role)) for role in ("controller", "plant")] == [{}, {}]
    assert result.frames_sha256 == hop_reference.frames_sha256
    first, second = gateway.end()
    assert first.startswith("railhil hub: port socketcan:vcan0: ")
    assert second.startswith("railhil hub: port socketcan:vcan1: ")
    # A full transmit queue costs a retry, never a frame.
    assert not [line for line in (first, second) if "dropped" in line or ", 0 outages" not in line]


def _heard(link: Link) -> list[Frame]:
    return wait_for(lambda: link.receive(0.2), _PATIENCE_S)


def test_an_interface_goes_down_and_up_and_error_frames_stay(gateway):
    left, right = open_link(socketcan("vcan0")), open_link(socketcan("vcan1"))
    watcher = HubBus(gateway.channel)
    try:
        left.send([Frame(0x20, bytes(8), ERROR), _PLAIN])
        assert _heard(right) == watcher.recv_frames(_PATIENCE_S) == [_PLAIN]
        subprocess.run(["ip", "link", "set", "vcan1", "down"], check=True)
        try:
            wait_for(lambda: "socketcan:vcan1 is down" in gateway.said.read_text(), _PATIENCE_S)
            # The others do not notice.
            left.send([Frame(0x200, b"waits")])
            assert watcher.recv_frames(_PATIENCE_S) == [Frame(0x200, b"waits")]
        finally:
            subprocess.run(["ip", "link", "set", "vcan1", "up"], check=True)
        wait_for(lambda: "socketcan:vcan1 is back after" in gateway.said.read_text(), _PATIENCE_S)
        assert _heard(right) == [Frame(0x200, b"waits")]
        right.send([_PLAIN])
        assert _heard(left) == watcher.recv_frames(_PATIENCE_S) == [_PLAIN]
    finally:
        left.close()
        right.close()
        watcher.shutdown()
    first, second = gateway.end()[-2:]
    assert "vcan0: 3 frames in, 1 out, 0 outages" in first
    assert "local_error_frames 1" in first
    assert "2 out, 1 outage" in second
    assert "dropped" not in first + second
