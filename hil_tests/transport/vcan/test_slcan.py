"""A serial adapter under the kernel's own slcan driver: slcand makes slcan0 of the emulated adapter's port.

The adapter's bus is vcan0, the node under test uses slcan0.
"""

from __future__ import annotations

import dataclasses
import fcntl
import multiprocessing
import os
import pty
import struct
import subprocess
import termios
import time
import tty
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from hil_tests.transport.vcan.bench import counters_of, run_on, socketcan
from railhil.bench import local_run
from railhil.bus.frame import Frame
from railhil.bus.link import Link, open_link
from railhil.bus.mvb import TelegramSource
from railhil.machines.adapter.device import Build
from railhil.machines.adapter.emulator import Emulator
from railhil.machines.adapter.terminal import Terminal
from railhil.scenarios.run_spec import RunSpec
from railhil.systems.ato.scenario.model import Scenario, TargetCurve
from railhil.systems.ato.scenario.target import Target
from railhil.testing.result import disturbed
from railhil.wire.ato import NotchCmd

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600)]

_WAIT_S = 30.0
_HOP = TargetCurve(((0.0, 0.5), (1.9, 0.5), (2.1, -0.5), (4.0, -0.5)))
#: More lines than all buffers between the kernel and the adapter hold.
_FILLING_FRAMES = 3000
#: Number of the slcan line discipline.
_N_SLCAN = struct.pack("i", 17)
_SIOCGIFNAME = 0x8910


class KernelAdapter:
    """The emulated adapter on vcan0, in a process of its own, and slcand on its port."""

    def __init__(self, folder: Path) -> None:
        self._port = folder / "ttyEMU"
        commands, self._commands = os.pipe()
        self._said = folder / "adapter.txt"

        def adapter() -> None:
            with self._said.open("w", buffering=1) as said:
                link = open_link(socketcan("vcan0"), "adapter")
                say: Callable[[str], object] = lambda line: print(line, file=said)  # noqa: E731
                Emulator(Terminal(self._port), Build(), link, commands_fd=commands, say=say).run()

        self._process = multiprocessing.get_context("fork").Process(target=adapter)
        self._process.start()
        self._daemon: subprocess.Popen[bytes] | None = None

    def order(self, command: str) -> None:
        """Give the adapter a command and wait until it is done."""
        before = self._answers()
        os.write(self._commands, f"{command}\n".encode())
        until(lambda: self._answers() > before)

    def _answers(self) -> int:
        return len(self._said.read_text().splitlines()) if self._said.exists() else 0

    def attach(self) -> None:
        """Let slcand make slcan0 of the port, at 500 kbit/s, and take it up."""
        until(self._port.exists)
        line = ["slcand", "-F", "-o", "-c", "-s6", str(self._port.resolve()), "slcan0"]
        self._daemon = subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        until(lambda: Path("/sys/class/net/slcan0").exists())
        subprocess.run(["ip", "link", "set", "slcan0", "txqueuelen", "1000", "up"], check=True)

    def detach(self) -> None:
        """End slcand, which does not notice that its port is gone."""
        if self._daemon is not None:
            self._daemon.terminate()
            self._daemon.wait(_WAIT_S)
            self._daemon = None

    def close(self) -> None:
        """Leave nothing behind."""
        self.detach()
        self._process.terminate()
        self._process.join(_WAIT_S)
        os.close(self._commands)


def until(condition: Callable[[], object]) -> None:
    """Wait until true."""
    deadline_s = time.monotonic() + _WAIT_S
    while not condition():
        assert time.monotonic() < deadline_s
        time.sleep(0.01)


@pytest.fixture
def adapter(tmp_path) -> Iterator[KernelAdapter]:
    """The adapter as slcan0."""
    found = KernelAdapter(tmp_path)
    try:
        found.attach()
        yield found
    finally:
        found.close()


@pytest.fixture
def links(adapter) -> Iterator[tuple[Link, Link]]:
    """A node's link on slcan0, and one on vcan0 that sees what the adapter sends."""
    node, other = open_link(socketcan("slcan0"), "node"), open_link(socketcan("vcan0"), "other")
    yield node, other
    node.close()
    other.close()


def notches(*lives: int) -> list[Frame]:
    """NOTCH_CMD frames that differ in their life sign."""
    return [TelegramSource(NotchCmd.port()).frames(NotchCmd(256, life=life).encode())[0] for life in lives]


@pytest.fixture
def hop(lvshun: Scenario) -> Scenario:
    """4 s and 2 m: each frame of the run passes five processes here."""
    target = Target(_HOP)
    plan = dataclasses.replace(
        lvshun.plan, distance_m=target.stop_position_m, running_time_s=target.stop_time_s, overtime_max_s=1.0
    )
    return dataclasses.replace(lvshun, target=_HOP, plan=plan)


def test_run_with_the_controller_on_slcan0_gives_the_same_bytes(adapter, hop, folder, tmp_path):
    result, exit_codes = run_on(socketcan(), hop, folder, controller_config=socketcan("slcan0"))
    assert exit_codes == [0, 0], result.line
    (tmp_path / "local").mkdir()
    local = local_run(hop, tmp_path / "local", RunSpec(seed=1))
    assert result.frames_sha256 == local.frames_sha256
    assert result.frames > 2000
    assert disturbed(counters_of(folder, "controller")) == {}


def test_a_stuck_adapter_fills_the_queue_and_the_newest_frame_goes_on(adapter, links, capfd):
    """ENOBUFS of a real driver: bounded retry, counted, alive; after the pause the newest command comes last."""
    node, other = links
    subprocess.run(["ip", "link", "set", "slcan0", "txqueuelen", "1"], check=True)
    adapter.order("stall")
    sent = 0
    while not node.counters["send_dropped"] and sent < _FILLING_FRAMES:
        node.send(notches(sent % 16))
        sent += 1
    assert node.counters["send_dropped"] == 1, "the queue is full"
    assert 1 <= node.counters["send_retries"] < 400
    start_s = time.monotonic()
    node.send(notches(*range(5)))
    assert time.monotonic() - start_s < _WAIT_S / 3
    assert node.counters["send_dropped"] == 6
    assert not node.is_down
    adapter.order("resume")
    backlog: list[Frame] = []
    until(lambda: len(backlog.__iadd__(other.receive(0.5))) >= sent - 1)
    node.send(notches(9))
    newest = other.receive(5.0)
    assert newest == notches(9)
    assert node.counters["outages"] == 0
    # What the driver and the port had taken before comes out: it is out of our reach. What was dropped does not.
    assert len(backlog) == sent - 1


def test_unplugged_and_attached_again(adapter, links, capfd):
    node, other = links
    node.send(notches(1))
    assert other.receive(5.0) == notches(1)
    adapter.order("unplug")
    until(lambda: not Path("/sys/class/net/slcan0").exists())
    until(lambda: node.receive(0.05) == [] and node.is_down)
    node.send(notches(2))
    adapter.detach()
    adapter.order("replug")
    adapter.attach()
    until(lambda: node.receive(0.1) == [] and not node.is_down)
    node.send(notches(3))
    assert other.receive(5.0) == notches(3), "the old command is not sent late"
    other.send(notches(4))
    assert node.receive(5.0) == notches(4)
    said = [line for line in capfd.readouterr().err.splitlines() if line.startswith("node: ")]
    assert len(said) == 2, said
    assert "socketcan:slcan0 is down (" in said[0]
    assert "socketcan:slcan0 is back after " in said[1]


@pytest.fixture
def held_interface() -> Iterator[str]:
    """An interface of the kernel's slcan driver whose serial line takes nothing."""
    master, port = pty.openpty()
    tty.setraw(port)
    # Before the driver has it: under the driver it can no longer be told.
    termios.tcflow(port, termios.TCOOFF)
    fcntl.ioctl(port, termios.TIOCSETD, _N_SLCAN)
    interface = fcntl.ioctl(port, _SIOCGIFNAME, bytes(16)).rstrip(b"\0").decode()
    subprocess.run(["ip", "link", "set", interface, "txqueuelen", "1000", "up"], check=True)
    yield interface
    os.close(port)
    os.close(master)
    until(lambda: not Path(f"/sys/class/net/{interface}").exists())


def test_a_bus_that_takes_nothing_is_given_no_backlog(held_interface):
    """Nobody acknowledges: what the kernel keeps, and sends when somebody does, is a few ticks of a plant."""
    node = open_link(socketcan(held_interface), "node")
    tried = 0
    while not node.counters["send_dropped"] and tried < _FILLING_FRAMES:
        node.send(notches(tried % 16))
        tried += 1
    node.close()
    assert node.counters["send_dropped"] == 1
    assert 8 <= tried - 1 <= 40
