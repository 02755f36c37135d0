"""Transports of python-can beside those of the bench, without its daemon, a kernel with CAN or a multicast group."""

from __future__ import annotations

import inspect
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import psutil
import pytest
from can.interfaces.udp_multicast import UdpMulticastBus

from benchmarks.__main__ import work
from benchmarks.buses import NO_VCAN, UNIX_HUB, Ends, Transport
from benchmarks.figures import Figure, MeasurementError, Missing, Setting
from benchmarks.foreign import SOCKETCAND, foreign_transports, multicast_to
from benchmarks.pairs import PYTHON, Pair
from benchmarks.peer import Near, echo, open_end
from benchmarks.processes import hub
from benchmarks.transports import _beside_the_hub, open_pairs
from railhil.bus.can_settings import HUB_INTERFACE
from railhil.bus.frame import Frame
from railhil.bus.link import Link
from railhil.common.errors import InputError

FIRST_ID = 0x110
GROUP = "239.74.163.2"
NO_C = Missing("the plain C loop", "not asked for")
#: Stands for the daemon: its protocol, with threads for its processes and a list of clients for vcan0.
DAEMON = """
import contextlib, pathlib, socketserver, sys, threading, time
words = sys.argv[1:]
pathlib.Path(__file__).with_name("words").write_text(" ".join(words))
clients, lock = set(), threading.Lock()
# A frame breaks each of the first handshakes.
early = [b"< frame 110 1.000000 00 >"] * 3
def has_read_all(client):
    # What was sent has arrived (queues of this end), and has been taken (queues of the other end).
    own, other = (f"0100007F:{name[1]:04X}" for name in (client.getsockname(), client.getpeername()))
    rows = [line.split() for line in open("/proc/net/tcp")]
    queues = {(row[1], row[2]): row[4].split(":") for row in rows}
    unsent, taken = queues.get((own, other)), queues.get((other, own))
    return (not unsent or int(unsent[0], 16) == 0) and (not taken or int(taken[1], 16) == 0)
class Client(socketserver.BaseRequestHandler):
    def handle(self):
        self.request.sendall(b"< hi >")
        text = ""
        while got := self.request.recv(4096).decode():
            *commands, text = (text + got).split(">")
            for command in map(str.split, commands):
                if command[1] == "send":
                    data = "".join(f"{int(byte, 16):02X}" for byte in command[4:])
                    self.passed_on(f"< frame {command[2]} 1.000000 {data} >".encode())
                    continue
                with lock:
                    broken = early.pop() if early and command[1] == "rawmode" else b""
                self.request.sendall(b"< ok >" + broken)
                if command[1] == "rawmode" and not broken:
                    while not has_read_all(self.request):
                        time.sleep(0.001)
                    with lock:
                        clients.add(self.request)
    def finish(self):
        with lock:
            clients.discard(self.request)
    def passed_on(self, frame):
        with lock:
            for other in clients - {self.request}:
                # Its own thread takes it from the clients.
                with contextlib.suppress(OSError):
                    other.sendall(frame)
socketserver.ThreadingTCPServer.daemon_threads = True
socketserver.ThreadingTCPServer(("127.0.0.1", int(words[words.index("-p") + 1])), Client).serve_forever()
"""


def daemon(folder: Path, monkeypatch: pytest.MonkeyPatch, source: str) -> Path:
    """A program in Python that is found as the daemon."""
    program = folder / "socketcand"
    program.write_text(f"#!{sys.executable}\n{source}")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(folder))
    return program


def settings(where: tuple[str, str]) -> dict[str, object]:
    """Keyword arguments of ``can.Bus`` of an end."""
    kind, address = where
    assert kind == "python-can"
    found: dict[str, object] = json.loads(address)
    return found


class Until:
    """A far end that ends with a frame of its own."""

    LAST_ID = 0x7FF

    def __init__(self, link: Link) -> None:
        self._link = link
        self.send = link.send

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """What has come; nothing at the end."""
        frames = self._link.receive(timeout_s)
        return [] if any(frame.can_id == self.LAST_ID for frame in frames) else frames


def test_an_end_is_opened_on_any_interface_of_python_can() -> None:
    """``virtual`` is in one process: the far end is a thread of it."""
    where = json.dumps({"interface": "virtual", "channel": "benchmarks"})
    near_end, far_end = (open_end("python-can", where, FIRST_ID) for _ in range(2))
    assert isinstance(near_end, Link)
    assert isinstance(far_end, Link)
    with closing(near_end), closing(far_end):
        echoing = threading.Thread(target=echo, args=(Until(far_end), FIRST_ID))
        echoing.start()
        try:
            near = Near(near_end, FIRST_ID)
            near.wait_for_echo()
            assert len(near.trips(5)) == 5
            assert len(near.stream(2)) == 1
        finally:
            near_end.send([Frame(Until.LAST_ID, b"")])
            echoing.join()


@pytest.mark.loop
def test_a_transport_of_python_can_has_no_end_in_c(socket_folder: Path) -> None:
    @contextmanager
    def opened(folder: Path) -> Iterator[Ends]:
        with hub(str(folder / "hub.sock")) as (channel, pid):
            where = ("python-can", json.dumps({"interface": HUB_INTERFACE, "channel": channel}))
            yield Ends(where, where, [pid])

    transport = Transport("our hub", "ours", opened, in_c=False)
    with open_pairs(transport, Path("/no/loop"), socket_folder) as (pair,):
        assert pair.language == PYTHON
        assert len(pair.ask("trips 5")) == 5
        assert len(pair.ask("stream 1")) == 1


@pytest.mark.slow
@pytest.mark.loop
def test_the_daemon_is_started_on_loopback_without_beacon_and_ended(tmp_path, monkeypatch) -> None:
    daemon(tmp_path, monkeypatch, DAEMON)
    folder = tmp_path / "pairs"
    folder.mkdir()
    with open_pairs(SOCKETCAND, NO_C, folder) as (pair,):
        pids = [*pair.pids, *pair.hub_pids]
        assert len(pair.ask("trips 5")) == 5
        assert len(pair.ask("stream 2")) == 1
    *words, port = (tmp_path / "words").read_text().split()
    assert words == ["-n", "-q", "-i", "vcan0", "-l", "lo", "-p"]
    assert int(port) > 1023
    assert not any(psutil.pid_exists(pid) for pid in pids)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.loop
def test_an_end_that_fails_says_why_though_a_library_complains_after_it(tmp_path, monkeypatch) -> None:
    """python-can warns of each bus whose handshake was broken."""
    daemon(tmp_path, monkeypatch, DAEMON.replace("] * 3", "] * 100"))
    said = "peer: bus socketcand:vcan0 cannot be opened: .*< frame 110 "
    with pytest.raises(MeasurementError, match=said), open_pairs(SOCKETCAND, NO_C, tmp_path):
        pass


def test_the_ends_are_clients_of_the_daemon(tmp_path, monkeypatch) -> None:
    daemon(tmp_path, monkeypatch, DAEMON)
    with SOCKETCAND.opened(tmp_path) as ends:
        found = settings(ends.near)
        assert ends.near == ends.far
        assert found.pop("port") == int((tmp_path / "words").read_text().split()[-1])
    assert found == {"interface": "socketcand", "channel": "vcan0", "host": "127.0.0.1", "tcp_tune": True}


def test_a_daemon_that_does_not_start_says_why(tmp_path, monkeypatch) -> None:
    daemon(tmp_path, monkeypatch, "print('bind: no'); raise SystemExit(1)")
    said = r"^socketcand at 127\.0\.0\.1:\d+ did not start: bind: no$"
    with pytest.raises(MeasurementError, match=said), SOCKETCAND.opened(tmp_path):
        pass


def test_what_a_daemon_starts_for_its_clients_is_between_the_ends(socket_folder: Path) -> None:
    shell = ["sh", "-c", "sleep 60 & echo $!; wait"]
    with (
        UNIX_HUB.opened(socket_folder) as ends,
        subprocess.Popen(shell, stdout=subprocess.PIPE, start_new_session=True) as forking,
    ):
        try:
            assert forking.stdout is not None
            child = int(forking.stdout.readline())
            with Pair(PYTHON, None, Ends(ends.near, ends.far, [*ends.hub_pids, forking.pid])) as pair:
                assert pair.hub_pids == [*ends.hub_pids, forking.pid, child]
        finally:
            os.killpg(forking.pid, signal.SIGKILL)


def test_multicast_is_not_sent_unless_a_group_is_named(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    ways, missing = foreign_transports("")
    assert ways == []
    why = {each.name: each.why for each in missing}
    assert "--multicast GROUP permits" in why["python-can udp_multicast"]
    assert "no socketcand on the PATH: github.com/linux-can/socketcand" in why[SOCKETCAND.name]


def test_a_daemon_is_used_where_the_kernel_has_can(tmp_path, monkeypatch) -> None:
    daemon(tmp_path, monkeypatch, DAEMON)
    ways, missing = foreign_transports(GROUP, vcan=True)
    assert [way.name for way in ways] == [SOCKETCAND.name, "python-can udp_multicast"]
    assert missing == []
    ways, (missing_daemon,) = foreign_transports(GROUP, vcan=False)
    assert [way.name for way in ways] == ["python-can udp_multicast"]
    assert missing_daemon == Missing(SOCKETCAND.name, NO_VCAN)


def test_multicast_ends_have_settings_that_python_can_takes(tmp_path) -> None:
    """Nothing is opened here: whoever measures it says so."""
    with multicast_to(GROUP).opened(tmp_path) as ends:
        assert ends.near == ends.far
        assert ends.hub_pids == []
    found = settings(ends.near)
    assert found.pop("interface") == "udp_multicast"
    taken = inspect.signature(UdpMulticastBus.__init__).bind(None, **found).arguments
    # No packet leaves the machine.
    assert (taken["channel"], taken["hop_limit"], "kwargs" in taken) == (GROUP, 0, False)


@pytest.mark.parametrize("group", ["127.0.0.1", "railhil", "ff15"])
def test_what_is_no_group_is_refused(group: str, monkeypatch) -> None:
    monkeypatch.setattr(sys, "argv", ["benchmarks", "--only", "transports", "--multicast", group])
    with pytest.raises(InputError, match=r"--multicast.*a multicast address"):
        work()


def test_the_group_comes_to_the_benchmark(tmp_path) -> None:
    assert Setting.make(True, tmp_path).multicast == ""
    assert Setting.make(True, tmp_path, GROUP).multicast == GROUP


def test_figures_of_python_can_are_compared_with_those_of_the_hub() -> None:
    trip, rate = "round trip, free, Python", "one way, Python"
    figures = [
        Figure(f"{UNIX_HUB.name}: {trip}", 50.0, "us", 2.0, "Python to C, free"),
        Figure(f"{UNIX_HUB.name}: {rate}", 1000.0, "frames/s"),
        Figure(f"{SOCKETCAND.name}: {trip}", 75.0, "us", None, "", {"min": 70.0}),
        Figure(f"{SOCKETCAND.name}: {rate}", 100.0, "frames/s"),
    ]
    beside = f"to {UNIX_HUB.name}"
    assert _beside_the_hub(SOCKETCAND, figures) == [
        Figure(f"{SOCKETCAND.name}: {trip}", 75.0, "us", 1.5, beside, {"min": 70.0}),
        Figure(f"{SOCKETCAND.name}: {rate}", 100.0, "frames/s", 0.1, beside),
    ]
