"""The hub as a process: start, refusal, end, and what clients see of it."""

from __future__ import annotations

import contextlib
import os
import resource
import signal
import socket
import stat
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import can
import pytest

from bus.errors import BusLost, BusUnavailable
from bus.frame import Frame
from bus.hub.client import HubBus
from bus.hub.link import HubLost
from bus.hub.wire import encode_hello, pack_frame

#: Long enough for any machine: reaching it is a failure, not a measurement.
PATIENCE_S = 20.0


class HubProcess:
    """A hub in a process of its own; its standard error goes to a file."""

    def __init__(self, channel: str, *options: str) -> None:
        self._stderr_file = tempfile.TemporaryFile("w+")  # noqa: SIM115 - closed with the process
        command = [sys.executable, "-m", "bus.hub", "-c", channel, *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self._stderr_file, text=True)
        assert self.process.stdout is not None
        self.ready_line = self.process.stdout.readline()
        #: The channel to connect to (TCP port 0 has become a real one).
        self.channel = channel
        if self.ready_line:
            self.channel = self.ready_line.removeprefix("railhil hub ready at ").split(": ")[0]

    def bus(self, **options: object) -> HubBus:
        """A new client."""
        return HubBus(self.channel, **options)  # type: ignore[arg-type]

    def end(self, number: int | None = signal.SIGTERM) -> int:
        """Send a signal (None: just wait) and return the exit code."""
        if number is not None and self.process.poll() is None:
            self.process.send_signal(number)
        return self.process.wait(PATIENCE_S)

    def stderr(self) -> str:
        """What the hub has complained about so far."""
        self._stderr_file.seek(0)
        return self._stderr_file.read()

    def wait_for_stderr(self, words: str) -> None:
        """Wait until the hub has complained with these words."""
        deadline_s = time.monotonic() + PATIENCE_S
        while words not in self.stderr():
            assert time.monotonic() < deadline_s, f"no {words!r} in {self.stderr()!r}"
            time.sleep(0.01)

    def close(self) -> None:
        """End the process and the files."""
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait(PATIENCE_S)
        assert self.process.stdout is not None
        self.process.stdout.close()
        self._stderr_file.close()


@contextlib.contextmanager
def socket_folder() -> Iterator[Path]:
    """A folder with a short path: pytest's own can be too long for a socket."""
    with tempfile.TemporaryDirectory(prefix="rh-") as folder:
        yield Path(folder)


@contextlib.contextmanager
def running_hub(*options: str, channel: str | None = None) -> Iterator[HubProcess]:
    """A hub that accepts clients."""
    with socket_folder() as folder:
        hub = HubProcess(channel or str(folder / "hub.sock"), *options)
        try:
            assert hub.ready_line, hub.stderr()
            yield hub
        finally:
            hub.close()


def refused(channel: str) -> str:
    """The line of a hub that cannot start."""
    command = [sys.executable, "-m", "bus.hub", "-c", channel]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    assert ended.returncode == 2, ended
    assert ended.stderr.count("\n") == 1, ended.stderr
    assert ended.stdout == ""
    return ended.stderr


_ECHO = """
import sys
from bus.frame import Frame
from bus.hub.client import HubBus
bus = HubBus(sys.argv[1], connect_timeout=20.0)
bus.send_frames([Frame(0x700, b"ready")])
while True:
    frames = bus.recv_frames(None)
    if frames[0].can_id == 0x7FF:
        break
    bus.send_frames([Frame(frame.can_id + 1, frame.data) for frame in frames])
bus.shutdown()
"""


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


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
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


def test_a_tcp_port_in_use_is_refused() -> None:
    with running_hub(channel="tcp://127.0.0.1:0") as hub:
        assert "in use" in refused(hub.channel)


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
    command = [sys.executable, "-m", "bus.hub", "-c", "unused.sock", "-b", "500000"]
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
        assert reader.recv_frames(PATIENCE_S) == [Frame(1, b"a")]
        # Unread input of the hub's peer turns its end of file into a connection reset first.
        reader.send_frames([Frame(2, b"b")])
        writer.send_frames([Frame(3, b"c")])
        assert writer.recv_frames(PATIENCE_S) == [Frame(2, b"b")]
        hub.end(signal.SIGTERM)
        assert reader.recv_frames(PATIENCE_S) == [Frame(3, b"c")]
        with pytest.raises(HubLost):
            reader.recv_frames(PATIENCE_S)


def test_no_hub_is_one_line_and_a_late_hub_is_waited_for() -> None:
    with socket_folder() as folder:
        path = str(folder / "hub.sock")
        with pytest.raises(BusUnavailable, match="no hub at") as caught:
            HubBus(path)
        assert isinstance(caught.value, can.CanInitializationError)
        command = [sys.executable, "-m", "bus.hub", "-c", path, "--once"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        HubBus(path, connect_timeout=PATIENCE_S).shutdown()
        assert process.wait(PATIENCE_S) == 0


def _raw_client(channel: str, *packets: bytes) -> socket.socket:
    sock = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    sock.settimeout(PATIENCE_S)
    sock.connect(channel)
    for packet in packets:
        sock.send(packet)
    return sock


_GOOD = pack_frame(Frame(0x100, b"12345678"))


@pytest.mark.parametrize(
    ("packets", "words"),
    [
        ((b"hello",), "no hello as first packet"),
        ((_GOOD,), "no hello as first packet"),
        ((b'{"railhil_hub": 7}',), "found 7, allowed: 1"),
        ((encode_hello(name="bad"), _GOOD[:15]), "'bad' is disconnected: malformed packet: packet of 15 bytes"),
        ((encode_hello(name="bad"), _GOOD * 257), "packet of more than 4096 bytes"),
        ((encode_hello(name="bad"), _GOOD, _GOOD[:4] + b"\x09" + _GOOD[5:]), "payload length 9"),
        ((encode_hello(name="bad"), _GOOD[:4] + b"\x0a" + bytes(67)), "payload length 10"),
        ((encode_hello(name="bad"), encode_hello(name="twice")), "malformed packet"),
    ],
)
def test_a_malformed_packet_costs_one_client_its_port_and_nobody_else(packets: tuple[bytes, ...], words: str) -> None:
    with running_hub() as hub, hub.bus() as one, hub.bus() as other:
        with _raw_client(hub.channel, *packets) as bad:
            answers = 0
            while bad.recv(4096):
                answers += 1
            # Either the hub's properties or the reason of the refusal, never silence.
            assert answers == 1
        one.send_frames([Frame(0x200, b"alive")])
        received = other.recv_frames(PATIENCE_S)
        assert received in ([Frame(0x200, b"alive")], [Frame(0x100, b"12345678")])
        assert words in hub.stderr()
        assert hub.stderr().count("\n") == 1


def test_a_foreign_protocol_on_the_tcp_port_is_cut_off() -> None:
    with running_hub(channel="tcp://127.0.0.1:0") as hub, hub.bus() as one, hub.bus() as other:
        port = int(hub.channel.rpartition(":")[2])
        with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) as web:
            web.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
            with contextlib.suppress(ConnectionResetError):
                while web.recv(4096):
                    continue
        one.send_frames([Frame(0x200, b"alive")])
        assert other.recv_frames(PATIENCE_S) == [Frame(0x200, b"alive")]
        assert hub.stderr().count("disconnected") == 1
        assert "found b'GET / HTTP/1.1" in hub.stderr()


def test_a_hub_out_of_descriptors_says_so_once_and_recovers() -> None:
    with running_hub() as hub:
        resource.prlimit(hub.process.pid, resource.RLIMIT_NOFILE, (16, 16))
        crowd = [_raw_client(hub.channel, encode_hello(name=str(number))) for number in range(20)]
        first_answer = crowd[0].recv(4096)
        assert b"bitrate_model" in first_answer
        hub.wait_for_stderr("too many open files")
        for guest in crowd[:15]:
            guest.close()
        # The last of the crowd was waiting outside and is let in now.
        assert crowd[-1].recv(4096) == first_answer
        for guest in crowd[15:]:
            guest.close()
        with hub.bus() as one, hub.bus() as other:
            one.send_frames([Frame(1, b"")])
            assert other.recv_frames(PATIENCE_S) == [Frame(1, b"")]
        assert hub.stderr().count("too many open files") == hub.stderr().count("\n")
        assert 1 <= hub.stderr().count("\n") <= 20


def test_a_client_far_behind_is_cut_off_with_one_line_and_nobody_waits_for_it() -> None:
    with running_hub("--queue-limit", "200000") as hub, hub.bus(name="sleeper") as sleeper:
        with hub.bus() as writer, hub.bus() as reader:
            sent = 0
            while "disconnected" not in hub.stderr():
                assert sent < 1_000_000, "the hub lets a client fall behind without bound"
                batch = [Frame(0x300, (sent + k).to_bytes(4, "big")) for k in range(250)]
                writer.send_frames(batch)
                assert reader.recv_frames(PATIENCE_S) == batch
                sent += 250
        line = hub.stderr()
        assert line.count("\n") == 1
        assert "'sleeper' is disconnected: it has fallen behind by more than 200000 bytes" in line
        received: list[Frame] = []

        def read_to_the_end() -> None:
            while frames := sleeper.recv_frames(PATIENCE_S):
                received.extend(frames)

        with pytest.raises(HubLost):
            read_to_the_end()
        assert 0 < len(received) < sent
        assert [int.from_bytes(frame.data, "big") for frame in received] == list(range(len(received)))


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
