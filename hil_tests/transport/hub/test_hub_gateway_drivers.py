"""Ports of the gateway whose bus takes frames slowly, in parts, or whose driver fails; and its start."""

from __future__ import annotations

import os
import signal
import struct
import subprocess
import sys
import time
import weakref
from contextlib import nullcontext
from pathlib import Path

import can
import pytest
from can.interfaces.virtual import VirtualBus

from hil_tests.support.cli import wait_for
from hil_tests.support.hub import PATIENCE_S, PLAIN, HubProcess, opened_port, running_hub, taken, two_hubs_and_a_gateway
from railhil.bus.errors import BusUnavailable
from railhil.bus.frame import Frame
from railhil.bus.hub import gateway, portspec
from railhil.bus.hub.client import HubBus
from railhil.bus.hub.gateway import SLOW_RETRY_NS, BusPort
from railhil.bus.hub.portspec import open_port_again, parse_port
from railhil.bus.hub.server import HubSpec, serve
from railhil.bus.link import open_link
from railhil.bus.packing import CLASSIC_SIZE, pack_frame
from railhil.machines.adapter.terminal import Terminal

PACKET = pack_frame(PLAIN)
#: More than any port or socket takes.
MANY = 20_000


@pytest.fixture
def terminal(tmp_path: Path):
    """A serial adapter that is plugged in."""
    terminal = Terminal(tmp_path / "tty")
    terminal.plug_in()
    yield terminal
    terminal.pull_out()


def _flushed_when_due(port: BusPort) -> None:
    if port.due_ns is not None and port.due_ns <= time.monotonic_ns():
        port.flush()


# -- full buses ---------------------------------------------------------------------------------------------------


def test_frames_that_keep_coming_do_not_put_off_the_next_attempt(terminal: Terminal) -> None:
    port, lines = opened_port(f"slcan:{terminal.link},sleep_after_open=0", lossless=True)
    try:
        assert any(port.send(PACKET) for _ in range(MANY)), "the port never fills"
        due_ns = port.due_ns
        assert port.send(PACKET) is False
        assert port.due_ns == due_ns
        for _ in range(MANY):
            terminal.read(65536)
            _flushed_when_due(port)
            if not port.has_backlog:
                break
            port.send(PACKET)
        assert not port.has_backlog, "it is never worked off while a client keeps sending"
        assert "dropped" not in port.statistics()
        assert lines == []
    finally:
        port.close()


@pytest.mark.parametrize("lossless", [True, False])
def test_the_rest_of_a_frame_that_was_taken_in_part_follows_without_another(terminal: Terminal, lossless: bool) -> None:
    long = pack_frame(Frame(0x123, bytes(8)))
    port, _ = opened_port(f"slcan:{terminal.link},sleep_after_open=0", lossless=lossless)
    try:
        wait_for(lambda: terminal.read(65536).endswith(b"O\r"), PATIENCE_S)
        sent = 0
        while not port.has_backlog:
            sent += 1
            port.send(long)
            assert sent < MANY
        assert port._link.has_rest, "the port of this system never takes a line in part"
        heard = b""

        def is_whole() -> bool:
            nonlocal heard
            heard += terminal.read(65536)
            _flushed_when_due(port)
            return port.due_ns is None and len(heard) >= len(expected)

        expected = b"t12380000000000000000\r" * sent
        wait_for(is_whole, PATIENCE_S)
        assert heard == expected
        assert not port.has_backlog
    finally:
        port.close()


def test_what_a_hub_that_does_not_read_still_gets_is_little_unless_nothing_may_be_lost() -> None:
    with running_hub() as hub:
        taken: dict[bool, int] = {}
        for lossless in (False, True):
            port, _ = opened_port(f"railhil:{hub.channel}", lossless=lossless)
            hub.process.send_signal(signal.SIGSTOP)
            taken[lossless] = next(number for number in range(MANY) if port.send(PACKET))
            hub.process.send_signal(signal.SIGCONT)
            port.close()
        assert taken[False] < 50 < taken[True]


def test_a_hub_that_takes_some_packets_of_several_is_not_offered_them_again() -> None:
    frames = [Frame(0x100, number.to_bytes(4, "big")) for number in range(3000)]
    with running_hub() as hub, hub.bus() as reader:
        link = open_link({"interface": "railhil", "channel": hub.channel, "send_buffer_bytes": 8192})
        hub.process.send_signal(signal.SIGSTOP)
        taken = link.offer(frames)
        hub.process.send_signal(signal.SIGCONT)
        assert 0 < taken < len(frames)
        assert taken % (4096 // CLASSIC_SIZE) == 0
        assert (link.counters["sent"], link.counters["send_retries"]) == (taken, 1)
        link.send([PLAIN])
        heard: list[Frame] = []
        while not heard or heard[-1] != PLAIN:
            arrived = reader.recv_frames(PATIENCE_S)
            assert arrived
            heard += arrived
        assert heard == [*frames[:taken], PLAIN]
        link.close()


def test_clients_that_read_in_bulk_get_their_frames_while_others_wait_for_a_bus() -> None:
    with (
        two_hubs_and_a_gateway(options=("--lossless",)) as (a, b, between),
        a.bus() as left,
        HubBus(between.channel, coalesce_frames=64) as bulk,
    ):
        b.end(signal.SIGKILL)
        between.wait_for_stderr("is down")
        left.send_frames([PLAIN])
        assert bulk.recv_frames(PATIENCE_S) == [PLAIN]


@pytest.mark.slow
def test_an_adapter_that_takes_nothing_does_not_hold_the_end(terminal: Terminal) -> None:
    port, _ = opened_port(f"slcan:{terminal.link},sleep_after_open=0", lossless=True)
    assert any(port.send(PACKET) for _ in range(MANY))
    port.close()


# -- drivers ------------------------------------------------------------------------------------------------------


def test_a_driver_that_fails_while_reading_is_opened_again(monkeypatch: pytest.MonkeyPatch) -> None:
    other = can.Bus(interface="virtual", channel="gateway-reading")
    with monkeypatch.context() as broken:
        broken.setattr(VirtualBus, "_recv_internal", _raising(RuntimeError("no such\nluck")))
        port, lines = opened_port("virtual:gateway-reading")
        wait_for(lambda: lines, PATIENCE_S)
    try:
        assert lines[0].endswith("is down (its driver has failed: no such luck); it is opened again when it is back")
        wait_for(lambda: "is open again after" in lines[-1], PATIENCE_S)
        other.send(can.Message(arbitration_id=PLAIN.can_id, is_extended_id=False, data=PLAIN.data))
        assert taken(port, bool) == [PLAIN]
    finally:
        port.close()
        other.shutdown()


def test_half_a_frame_costs_that_frame_and_stops_nobody(terminal: Terminal) -> None:
    """python-can's serial driver raises struct.error."""
    port, lines = opened_port(f"serial:{terminal.link}")
    try:
        terminal.write(b"\xaa\0\0\0\0\x01\x01")
        wait_for(lambda: "garbage 1" in port.statistics(), PATIENCE_S)
        terminal.write(b"\xaa" + struct.pack("<IBI", 0, 1, 0x321) + b"\x07\xbb")
        assert taken(port, bool) == [Frame(0x321, b"\x07")]
        assert lines == []
    finally:
        port.close()


def test_a_driver_that_fails_while_sending_is_opened_again(monkeypatch: pytest.MonkeyPatch) -> None:
    port, lines = opened_port("virtual:gateway-driver")
    other = can.Bus(interface="virtual", channel="gateway-driver")
    try:
        with monkeypatch.context() as broken:
            broken.setattr(VirtualBus, "send", _raising(RuntimeError("no such\nluck")))
            assert port.send(PACKET) is False
        assert lines[0].endswith("is down (its driver has failed: no such luck); it is opened again when it is back")
        wait_for(lambda: len(lines) == 2, PATIENCE_S)
        assert "is open again after" in lines[1]
        assert port.send(PACKET) is False
        message = other.recv(PATIENCE_S)
        assert message is not None
        assert message.arbitration_id == PLAIN.can_id
        assert port.statistics().endswith("0 frames in, 1 out, 1 outage, dropped 1")
    finally:
        port.close()
        other.shutdown()


def test_a_driver_that_may_wait_itself_is_asked_rarely(monkeypatch: pytest.MonkeyPatch) -> None:
    port, _ = opened_port("virtual:gateway-slow")
    try:
        monkeypatch.setattr(VirtualBus, "send", _raising(can.CanTimeoutError("full")))
        before_ns = time.monotonic_ns()
        assert port.send(PACKET) is True
        assert port.due_ns is not None
        assert port.due_ns >= before_ns + SLOW_RETRY_NS
        before_ns = time.monotonic_ns()
        port.flush()
        assert port.due_ns >= before_ns + SLOW_RETRY_NS
    finally:
        port.close()


def _raising(error: Exception):  # type: ignore[no-untyped-def]
    def fail(*_: object, **__: object) -> None:
        raise error

    return fail


def test_an_interface_that_is_there_but_not_up_is_not_opened_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Opened, it would be one more outage and one more line each time."""
    opened: list[object] = []
    monkeypatch.setattr(portspec, "open_link", lambda config, name: opened.append(config))
    assert open_port_again(parse_port("socketcan:gone0"), lossless=False) is None
    assert opened == []


# -- start --------------------------------------------------------------------------------------------------------


def _started(folder: Path, port: str) -> subprocess.Popen[str]:
    """A gateway whose channel is there; it waits for its port."""
    words = [sys.executable, "-m", "railhil.bus.hub", "-c", "gw.sock", "--port", port]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder)
    wait_for((folder / "gw.sock").exists, PATIENCE_S)
    return process


def test_a_gateway_waits_for_a_hub_that_starts_after_it(socket_folder: Path) -> None:
    process = _started(socket_folder, "railhil:late.sock,connect_timeout=60")
    hub = HubProcess(os.fspath(socket_folder / "late.sock"))
    try:
        assert process.stdout is not None
        assert process.stdout.readline().endswith("gateway to railhil:late.sock\n")
    finally:
        process.terminate()
        process.communicate(timeout=PATIENCE_S)
        hub.close()
    assert process.returncode == 0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_gateway_that_waits_for_a_hub_can_be_stopped(socket_folder: Path, number: signal.Signals) -> None:
    process = _started(socket_folder, "railhil:late.sock,connect_timeout=60")
    process.send_signal(signal.SIGUSR1)
    process.send_signal(number)
    assert process.communicate(timeout=PATIENCE_S) == ("", "")
    assert process.returncode == 0
    assert not list(socket_folder.iterdir())


@pytest.mark.parametrize("stopped", [True, False])
def test_a_driver_that_makes_an_error_of_a_stop_does_not_hold_it_back(
    socket_folder: Path, monkeypatch: pytest.MonkeyPatch, stopped: bool
) -> None:
    def opened(*_: object, **__: object) -> BusPort:
        try:
            if stopped:
                signal.raise_signal(signal.SIGTERM)
                time.sleep(PATIENCE_S)
        except BaseException as error:
            raise BusUnavailable("interrupted") from error
        raise BusUnavailable("interrupted")

    monkeypatch.setattr(gateway, "BusPort", opened)
    with nullcontext() if stopped else pytest.raises(BusUnavailable, match="interrupted"):
        serve(os.fspath(socket_folder / "gw.sock"), HubSpec(ports=[parse_port("railhil:late.sock")]))
    assert not list(socket_folder.iterdir())


def test_a_driver_that_catches_a_stop_is_stopped_again(socket_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    caught: list[BaseException] = []

    def opened(*_: object, **__: object) -> BusPort:
        for _ in range(2):
            try:
                signal.raise_signal(signal.SIGTERM)
                time.sleep(PATIENCE_S)
            except BaseException as error:  # as drivers do
                caught.append(error)
        time.sleep(PATIENCE_S)
        raise BusUnavailable("not interrupted")

    monkeypatch.setattr(gateway, "BusPort", opened)
    serve(os.fspath(socket_folder / "gw.sock"), HubSpec(ports=[parse_port("railhil:late.sock")]))
    assert len(caught) == 2
    assert not list(socket_folder.iterdir())


class _Reference:
    """Something with a callback when it goes."""


def test_a_stop_that_the_interpreter_loses_is_raised_again(
    socket_folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """As in the callback of a weak reference, of which importing a driver has many."""
    lost = []

    def opened(*_: object, **__: object) -> BusPort:
        def callback(_: object) -> None:
            lost.append(True)
            signal.raise_signal(signal.SIGTERM)
            time.sleep(PATIENCE_S)

        thing = _Reference()
        reference = weakref.ref(thing, callback)
        del thing
        assert reference() is None
        time.sleep(PATIENCE_S)
        raise BusUnavailable("not interrupted")

    monkeypatch.setattr(gateway, "BusPort", opened)
    hook = sys.unraisablehook
    serve(os.fspath(socket_folder / "gw.sock"), HubSpec(ports=[parse_port("railhil:late.sock")]))
    assert lost == [True]
    assert capfd.readouterr() == ("", "")
    assert sys.unraisablehook is hook
