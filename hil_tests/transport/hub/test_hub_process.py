"""The hub as a process: start, refusal, end, and what clients see of it."""

from __future__ import annotations

import select
import signal
import socket
import stat
import subprocess
import sys
import time
from pathlib import Path
from typing import NoReturn

import can
import pytest

from hil_tests.support.hub import PATIENCE_S, HubProcess, running_hub, socket_folder
from railhil.bus.errors import BusLost, BusUnavailable
from railhil.bus.frame import Frame
from railhil.bus.hub import hello
from railhil.bus.hub.address import HUB_START_S
from railhil.bus.hub.client import HubBus, HubUnavailable
from railhil.bus.hub.connection import HubLost


def refused(channel: str) -> str:
    """The line of a hub that cannot start."""
    command = [sys.executable, "-m", "railhil.bus.hub", "-c", channel]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    assert ended.returncode == 2, ended
    assert ended.stderr.count("\n") == 1, ended.stderr
    assert ended.stdout == ""
    return ended.stderr


_ECHO = """
import sys
import time
from railhil.bus.frame import Frame
from railhil.bus.hub.client import HubBus
bus = HubBus(sys.argv[1], connect_timeout=20.0)
bus.send_frames([Frame(0x700, b"ready")])
while True:
    frames = bus.recv_frames(None)
    if frames[0].can_id == 0x7FF:
        break
    bus.send_frames([Frame(frame.can_id + 1, frame.data) for frame in frames])
bus.shutdown()
"""


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["path", "tcp"])
def test_round_trip_between_two_processes(scheme: str) -> None:
    channel = None if scheme == "path" else "tcp://127.0.0.1:0"
    with running_hub(channel=channel) as hub, hub.bus() as bus:
        echo = subprocess.Popen([sys.executable, "-c", _ECHO, hub.channel])
        assert bus.recv_frames(PATIENCE_S) == [Frame(0x700, b"ready")]
        for number in range(200):
            batch = [Frame(0x100 + 2 * k, number.to_bytes(2, "big")) for k in range(number % 5 + 1)]
            bus.send_frames(batch)
            assert bus.recv_frames(PATIENCE_S) == [Frame(f.can_id + 1, f.data) for f in batch]
        bus.send_frames([Frame(0x7FF, b"")])
        assert echo.wait(PATIENCE_S) == 0
        assert hub.stderr() == ""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_a_signal_ends_the_hub_cleanly(number: signal.Signals) -> None:
    with running_hub() as hub, hub.bus():
        path = Path(hub.channel)
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        assert hub.end(number) == 0
        assert not path.exists()
        assert hub.stderr() == ""


def test_with_once_the_hub_ends_with_its_last_client() -> None:
    with running_hub("--once") as hub:
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as visitor:
            # Somebody who only looks whether the hub lives does not count.
            visitor.connect(hub.channel)
        first, second = hub.bus(), hub.bus()
        first.shutdown()
        second.send_frames([Frame(1, b"")])
        third = hub.bus()
        second.shutdown()
        assert hub.process.poll() is None
        third.shutdown()
        assert hub.end(None) == 0
        assert not Path(hub.channel).exists()


def test_a_stale_socket_is_replaced_and_a_live_one_is_not() -> None:
    with running_hub() as dead:
        assert dead.end(signal.SIGKILL) == -signal.SIGKILL
        assert Path(dead.channel).exists()
        hub = HubProcess(dead.channel)
        try:
            assert "is in use by a running hub" in refused(dead.channel)
            with hub.bus() as one, hub.bus() as other:
                one.send_frames([Frame(5, b"alive")])
                assert other.recv_frames(PATIENCE_S) == [Frame(5, b"alive")]
        finally:
            hub.close()


@pytest.mark.slow
@pytest.mark.parametrize("words", ['"$@" >&-', '(sleep 0.1; exec "$@") | true'], ids=["closed", "no reader"])
def test_a_hub_whose_output_nobody_reads_serves(words: str) -> None:
    with socket_folder() as folder:
        channel = str(folder / "hub.sock")
        command = [sys.executable, "-m", "railhil.bus.hub", "-c", channel, "--once"]
        shell = ["bash", "-o", "pipefail", "-c", words, "bash", *command]
        with subprocess.Popen(shell, stderr=subprocess.PIPE, text=True) as hub:
            one = HubBus(channel, connect_timeout=PATIENCE_S)
            with HubBus(channel) as other, one:
                one.send_frames([Frame(5, b"alive")])
                assert other.recv_frames(PATIENCE_S) == [Frame(5, b"alive")]
            said = hub.communicate(timeout=PATIENCE_S)[1]
    assert (hub.returncode, said) == (0, "")


def test_a_tcp_port_in_use_is_refused() -> None:
    with running_hub(channel="tcp://127.0.0.1:0") as hub:
        assert "in use" in refused(hub.channel)


@pytest.mark.slow
def test_channels_that_cannot_be_had_give_one_line() -> None:
    with socket_folder() as folder:
        (folder / "file").write_text("not a socket")
        assert "not a socket" in refused(str(folder / "file"))
        assert (folder / "file").read_text() == "not a socket"
        assert "no such file or directory" in refused(str(folder / "missing" / "hub.sock"))
        assert "not a directory" in refused(str(folder / "file" / "hub.sock"))
        assert f"found a path of {len(str(folder)) + 101} bytes" in refused(f"{folder}/{'x' * 100}")
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as foreign:
            foreign.bind(str(folder / "foreign"))
            assert "another program" in refused(str(folder / "foreign"))
    # A folder in which nobody can create files, not even root.
    assert refused("/proc/hub.sock")
    assert "found host '192.0.2.1'" in refused("tcp://192.0.2.1:5000")
    assert "found host '0.0.0.0'" in refused("tcp://0.0.0.0:5000")
    assert "found port '70000'" in refused("tcp://127.0.0.1:70000")


def test_options_that_contradict_each_other_give_one_line() -> None:
    command = [sys.executable, "-m", "railhil.bus.hub", "-c", "unused.sock", "-b", "500000"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1
    assert "--bitrate-model" in ended.stderr


def test_a_killed_hub_is_an_exception_at_once_and_ever_after() -> None:
    with running_hub() as hub, hub.bus() as reader, hub.bus() as writer:
        writer.send_frames([Frame(9, b"last")])
        assert reader.recv_frames(PATIENCE_S) == [Frame(9, b"last")]
        assert hub.end(signal.SIGKILL) == -signal.SIGKILL
        for _ in range(3):
            with pytest.raises(HubLost, match="hub at") as caught:
                reader.recv_frames(None)
            assert isinstance(caught.value, BusLost)
            assert isinstance(caught.value, can.CanOperationError)
            with pytest.raises(HubLost):
                reader.recv(PATIENCE_S)
            with pytest.raises(HubLost):
                writer.send(can.Message(arbitration_id=1, is_extended_id=False))
            with pytest.raises(HubLost):
                writer.send_frames([Frame(1, b"")])
        assert reader.state is can.BusState.ERROR


def test_what_was_sent_before_the_hub_died_is_still_read() -> None:
    with running_hub() as hub, hub.bus() as reader, hub.bus() as writer:
        writer.send_frames([Frame(1, b"a")])
        assert select.select([reader.fileno()], [], [], PATIENCE_S)[0]
        # What the hub has not read when it dies turns the end of file into a connection reset at first.
        hub.process.send_signal(signal.SIGSTOP)
        reader.send_frames([Frame(2, b"b")])
        hub.end(signal.SIGKILL)
        assert reader.recv_frames(PATIENCE_S) == [Frame(1, b"a")]
        with pytest.raises(HubLost):
            reader.recv_frames(PATIENCE_S)


def test_no_hub_is_one_line_and_a_late_hub_is_waited_for() -> None:
    with socket_folder() as folder:
        path = str(folder / "hub.sock")
        with pytest.raises(BusUnavailable, match="no hub at") as caught:
            HubBus(path, connect_timeout=0)
        assert isinstance(caught.value, can.CanInitializationError)
        command = [sys.executable, "-m", "railhil.bus.hub", "-c", path, "--once"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        HubBus(path, connect_timeout=PATIENCE_S).shutdown()
        assert process.wait(PATIENCE_S) == 0


def test_a_hub_that_is_only_just_starting_is_waited_for_unless_told_otherwise(monkeypatch: pytest.MonkeyPatch) -> None:
    waited_s: list[float] = []

    def refuse(address: object, deadline_s: float, *_: object) -> NoReturn:
        waited_s.append(round(deadline_s - time.monotonic()))
        raise HubUnavailable(f"no hub at {address}")

    monkeypatch.setattr(hello, "connect_to_hub", refuse)
    for settings in ({}, {"connect_timeout": "0"}):
        with pytest.raises(HubUnavailable):
            can.Bus(interface="railhil", channel="hub.sock", **settings)
    # railhil bus hub & railhil run -i railhil: five seconds as in the C program, or what is asked for.
    assert waited_s == [HUB_START_S, 0.0]


def test_a_stopped_hub_first_hands_out_what_was_sent() -> None:
    with running_hub() as hub, hub.bus() as reader, hub.bus() as writer:
        # Stopped in the sense of SIGSTOP, so that everything is certainly unread when the end comes.
        hub.process.send_signal(signal.SIGSTOP)
        for number in range(50):
            writer.send_frames([Frame(number, b"x")])
        hub.process.send_signal(signal.SIGTERM)
        hub.process.send_signal(signal.SIGCONT)
        for number in range(50):
            assert reader.recv_frames(PATIENCE_S) == [Frame(number, b"x")]
        assert hub.end(None) == 0
        assert hub.stderr() == ""


def test_frames_that_wait_for_the_modelled_wire_at_the_stop_are_reported() -> None:
    with running_hub("--bitrate-model", "-b", "1000") as hub, hub.bus() as reader, hub.bus() as writer:
        writer.send_frames([Frame(number, b"x") for number in range(100)])
        assert reader.recv_frames(PATIENCE_S) == [Frame(0, b"x")]
        assert hub.end() == 0
        assert "frames were still waiting for the wire at the stop" in hub.stderr()
