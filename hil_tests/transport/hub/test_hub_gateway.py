"""The hub as gateway: buses as ports, and buses that are full, or go and come back."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import can
import pytest

from hil_tests.support.cli import wait_for
from hil_tests.support.hub import (
    PATIENCE_S,
    PLAIN,
    HubProcess,
    gateway,
    opened_port,
    taken,
    two_hubs_and_a_gateway,
)
from railhil.bus.errors import BusUnavailable
from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.hub import gateway_queues
from railhil.bus.hub.client import HubBus
from railhil.bus.hub.portspec import parse_port, parse_ports
from railhil.bus.packing import pack_frame
from railhil.machines.adapter.terminal import Terminal

# -- the command line ---------------------------------------------------------------------------------------------


def test_a_port_is_named_as_python_can_names_buses() -> None:
    spec = parse_port("slcan:/dev/ttyACM0,bitrate=500000,sleep-after-open=0.5,listen_only=true,app=x")
    assert spec.transport == "slcan:/dev/ttyACM0"
    settings = {"bitrate": 500_000, "sleep_after_open": 0.5, "listen_only": True, "app": "x"}
    assert spec.config == {"interface": "slcan", "channel": "/dev/ttyACM0", **settings}
    assert type(spec.config["bitrate"]) is int
    assert parse_port("railhil:tcp://127.0.0.1:5000").config["channel"] == "tcp://127.0.0.1:5000"


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (["socketcan"], "found 'socketcan', allowed: INTERFACE:CHANNEL"),
        ([":can0"], "allowed: INTERFACE:CHANNEL"),
        (["socketcan:"], "allowed: INTERFACE:CHANNEL"),
        (["socketcanny:can0"], "found interface 'socketcanny', allowed: canalystii, "),
        (["socketcan:can0,fd"], "found 'fd', allowed: key=value"),
        (["socketcan:can0,=1"], "allowed: key=value"),
        (["socketcan:can0,fd=true,fd=false"], "key 'fd'"),
        (["socketcan:can0,receive-own-messages=true"], "key 'receive-own-messages'"),
        (["socketcan:can0,interface=slcan"], "key 'interface'"),
        (["socketcan:can0", "slcan:can0", "socketcan:can0,fd=true"], "the same bus twice"),
        (["slcan:/dev/null@115200", "slcan:/dev/../dev/null"], "the same bus twice"),
        (["railhil:tcp://localhost:5000", "railhil:tcp://127.0.0.1:5000"], "the same bus twice"),
        (["railhil:./own.sock"], "found this hub itself"),
        (["railhil:tcp://192.0.2.1:5000"], "found host '192.0.2.1'"),
        (["socketcan:can0,fd=no"], "key 'fd': found 'no', allowed: true, false"),
        (["socketcan:can0,can_filters=1"], "key 'can_filters'"),
        (["slcan:/dev/ttyACM0,bitrate=500k"], "key 'bitrate': found '500k', allowed: bit/s"),
        (["railhil:a.sock,fdd=true"], "found key 'fdd', allowed for a hub: fd, name, connect_timeout, bitrate"),
        (["railhil:a.sock,connect_timeout=soon"], "key 'connect_timeout': found 'soon', allowed: seconds"),
    ],
)
def test_ports_that_cannot_be_are_one_line(texts: list[str], words: str) -> None:
    with pytest.raises(BusUnavailable) as caught:
        parse_ports(texts, "own.sock")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--port", "railhil:nowhere.sock,connect_timeout=0"), "no hub at nowhere.sock"),
        (("--port", "slcan:/dev/null/tty,sleep_after_open=0"), "bus slcan:/dev/null/tty cannot be opened"),
        (("--port", "kvaser:0"), "bus kvaser:0 cannot be opened"),
        (("--lossless",), "--lossless: found without --port"),
    ],
)
def test_a_gateway_that_cannot_start_says_one_line_and_leaves_nothing(
    socket_folder: Path, options: tuple[str, ...], words: str
) -> None:
    words_of_command = [sys.executable, "-m", "railhil.bus.hub", "-c", "hub.sock", *options]
    ended = subprocess.run(
        words_of_command, capture_output=True, text=True, timeout=PATIENCE_S, check=False, cwd=socket_folder
    )
    assert (ended.returncode, ended.stdout) == (2, "")
    assert words in ended.stderr
    # kvaser's driver, which is not there, also logs.
    assert sum(line.startswith("railhil bus hub: error: ") for line in ended.stderr.splitlines()) == 1
    assert "Traceback" not in ended.stderr
    assert not list(socket_folder.iterdir())


# -- frames -------------------------------------------------------------------------------------------------------


def test_frames_of_every_kind_cross_in_both_directions_and_everybody_sees_one_order() -> None:
    kinds = [
        PLAIN,
        Frame(0x1ABCDEF0, b"extended", EXTENDED),
        Frame(0x200, bytes(5), REMOTE),
        Frame(0x300, bytes(range(64)), FD | BRS),
        *(Frame(0x400 + k, k.to_bytes(2, "big")) for k in range(600)),
    ]
    with two_hubs_and_a_gateway(settings=",fd=true") as (a, b, between):
        assert between.ready_line.rstrip().endswith(f"gateway to railhil:{a.channel}, railhil:{b.channel}")
        with a.bus(fd=True) as left, b.bus(fd=True) as right, between.bus() as middle:
            assert middle.hub_properties["ports"] == [f"railhil:{a.channel}", f"railhil:{b.channel}"]
            for sender, receiver in ((left, right), (right, left)):
                sender.send_frames(kinds)
                for listener in (receiver, middle):
                    heard: list[Frame] = []
                    while len(heard) < len(kinds):
                        arrived = listener.recv_frames(PATIENCE_S)
                        assert arrived, f"silence after {len(heard)} frames"
                        heard += arrived
                    assert heard == kinds
            # Nobody has heard himself.
            assert left.recv_frames(0.0) == right.recv_frames(0.0) == []
            middle.send_frames([PLAIN])
            assert left.recv_frames(PATIENCE_S) == right.recv_frames(PATIENCE_S) == [PLAIN]
            between.process.send_signal(signal.SIGUSR1)
            between.wait_for_stderr(f"port railhil:{b.channel}: ")
        expected = [f"railhil hub: port {each}: 604 frames in, 605 out, 0 outages" for each in _transports(a, b)]
        assert between.end() == 0
        # A burst may meet a full socket for a moment.
        lines = [line.partition(", send_retries")[0] for line in between.stderr().splitlines()]
        assert lines == 2 * expected


def _transports(*hubs: HubProcess) -> list[str]:
    return [f"railhil:{hub.channel}" for hub in hubs]


def test_error_frames_stay_and_fd_frames_need_a_bus_with_fd() -> None:
    with two_hubs_and_a_gateway() as (a, b, between):
        with a.bus(fd=True) as left, b.bus() as right, between.bus(fd=True) as middle:
            left.send_frames([Frame(0x40, bytes(8), ERROR), Frame(0x300, bytes(64), FD), PLAIN])
            assert right.recv_frames(PATIENCE_S) == [PLAIN]
            # The gateway's own clients have no such limit.
            assert middle.recv_frames(PATIENCE_S) == [Frame(0x300, bytes(64), FD)]
            middle.send_frames([Frame(0x40, bytes(8), ERROR)] + 2 * [Frame(0x300, bytes(64), FD)] + [PLAIN])
            assert right.recv_frames(PATIENCE_S) == left.recv_frames(PATIENCE_S) == [PLAIN]
        assert between.end() == 0
        first, second = _transports(a, b)
        said = between.stderr()
        for transport in (first, second):
            words = "CAN FD frames are dropped, the bus was opened without fd=true (said once, all are counted)"
            assert said.count(f"port {transport}: {words}\n") == 1
        assert f"{first}: 3 frames in, 1 out, 0 outages, fd_dropped 2, local_error_frames 2\n" in said
        assert f"{second}: 0 frames in, 2 out, 0 outages, fd_dropped 3, local_error_frames 1\n" in said


def test_buses_contend_for_the_modelled_wire() -> None:
    options = ("--bitrate-model", "-b", "20000", "--arbitration")
    with two_hubs_and_a_gateway(options=options) as (a, b, between), a.bus() as left, b.bus() as right:
        with between.bus() as middle:
            # While the first frame is on the wire (5 ms), all others arrive.
            left.send_frames([Frame(0x700, bytes(8)) for _ in range(10)])
            right.send_frames([Frame(0x100, bytes(8)) for _ in range(5)])
            order: list[int] = []
            while len(order) < 15:
                order += [frame.can_id for frame in middle.recv_frames(PATIENCE_S)]
        assert sorted(order) == 5 * [0x100] + 10 * [0x700]
        assert order.index(0x100) < 9
        first = order.index(0x100)
        assert order[first : first + 5] == 5 * [0x100]


def test_a_bus_without_descriptor_is_read_by_a_thread() -> None:
    """python-can's virtual bus has none."""
    port, lines = opened_port("virtual:gateway-test")
    other = can.Bus(interface="virtual", channel="gateway-test")
    try:
        other.send(can.Message(arbitration_id=0x123, data=b"plain", is_extended_id=False))
        assert taken(port, bool) == [PLAIN]
        assert port.send(pack_frame(Frame(0x321, b"back"))) is False
        message = other.recv(PATIENCE_S)
        assert message is not None
        assert (message.arbitration_id, bytes(message.data)) == (0x321, b"back")
        # Its own frame did not come back.
        assert taken(port, lambda frames: True) == []
        assert lines == []
        assert port.statistics() == "port virtual:gateway-test: 1 frame in, 1 out, 0 outages"
    finally:
        port.close()
        other.shutdown()


def test_frames_that_nobody_takes_over_make_room_and_are_counted() -> None:
    """The thread reads on while the switch does not (a full bit rate model)."""
    port, lines = opened_port("virtual:gateway-full")
    other = can.Bus(interface="virtual", channel="gateway-full")
    try:
        for number in range(gateway_queues.LIMIT_FRAMES + 10):
            other.send(can.Message(arbitration_id=1, data=number.to_bytes(4, "big"), is_extended_id=False))
        wait_for(lambda: port.counters["rx_lost"] == 10, PATIENCE_S)
        numbers = [int.from_bytes(frame.data, "big") for frame in taken(port, lambda frames: True)]
        assert numbers == list(range(10, gateway_queues.LIMIT_FRAMES + 10))
        assert len(lines) == 1
        assert "frames are lost, the hub does not carry them in time" in lines[0]
        assert port.statistics().endswith("frames in, 0 out, 0 outages, rx_lost 10")
    finally:
        port.close()
        other.shutdown()


# -- full and missing buses ---------------------------------------------------------------------------------------


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("lossless", [True, False])
def test_a_bus_that_takes_nothing_stops_nobody(lossless: bool) -> None:
    """Hub B is stopped, so its socket fills; the others go on, and it gets what is still worth something."""
    count = 3000
    options = ("--lossless",) if lossless else ()
    with two_hubs_and_a_gateway(options=options) as (a, b, between), a.bus() as left, b.bus() as right:
        with between.bus() as middle:
            b.process.send_signal(signal.SIGSTOP)
            for number in range(count):
                left.send_frames([Frame(0x100, number.to_bytes(4, "big"))])
                assert middle.recv_frames(PATIENCE_S) == [Frame(0x100, number.to_bytes(4, "big"))]
            if not lossless:
                between.wait_for_stderr("frames are dropped, the bus does not take them in time")
            b.process.send_signal(signal.SIGCONT)
            numbers: list[int] = []

            def last_has_come() -> bool:
                if not lossless:
                    left.send_frames([Frame(0x7FF, b"")])
                while arrived := right.recv_frames(0.1):
                    numbers.extend(int.from_bytes(frame.data, "big") for frame in arrived if frame.can_id == 0x100)
                    if len(numbers) == count or arrived[-1].can_id == 0x7FF:
                        return True
                return False

            wait_for(last_has_come, PATIENCE_S)
        assert numbers == sorted(set(numbers))
        assert (len(numbers) == count) is lossless
        assert between.end() == 0
        assert ("dropped" in between.stderr()) is not lossless


def test_a_hub_that_dies_and_comes_back_is_a_port_again() -> None:
    with two_hubs_and_a_gateway() as (a, b, between), a.bus() as left, between.bus() as middle:
        b.end(signal.SIGKILL)
        between.wait_for_stderr(f"port railhil:{b.channel} is down (railhil hub at {b.channel}: ")
        # The others do not notice.
        left.send_frames([PLAIN])
        assert middle.recv_frames(PATIENCE_S) == [PLAIN]
        again = HubProcess(b.channel)
        try:
            between.wait_for_stderr(f"port railhil:{b.channel} is open again after ")
            with again.bus() as right:
                wait_for(lambda: _reaches(right, left), PATIENCE_S)
                left.send_frames([PLAIN])
                assert right.recv_frames(PATIENCE_S) == [PLAIN]
            assert between.end() == 0
        finally:
            again.close()
        assert between.stderr().splitlines()[-1].endswith("1 outage, dropped 1")


def _reaches(sender: HubBus, receiver: HubBus) -> bool:
    sender.send_frames([Frame(0x7FE, b"")])
    return bool(receiver.recv_frames(0.2))


def _asked(hub: HubProcess) -> str:
    """Last line of the hub's statistics."""
    hub.process.send_signal(signal.SIGUSR1)
    time.sleep(0.1)
    return hub.stderr().splitlines()[-1]


def test_frames_wait_for_a_hub_that_is_away_when_none_may_be_lost() -> None:
    with two_hubs_and_a_gateway(options=("--lossless",)) as (a, b, between), a.bus() as left:
        b.end(signal.SIGKILL)
        between.wait_for_stderr("is down")
        left.send_frames([PLAIN])
        wait_for(lambda: "waiting 1" in _asked(between))
        again = HubProcess(b.channel)
        try:
            between.wait_for_stderr("is open again")
            # It leaves within moments of the opening; a client could not be there in time.
            wait_for(lambda: _asked(between).endswith("0 frames in, 1 out, 1 outage"), PATIENCE_S)
        finally:
            again.close()
        assert "dropped" not in between.stderr()


def test_a_serial_adapter_is_unplugged_and_plugged_in_again(tmp_path: Path) -> None:
    """Opening takes its time (2 s with python-can's default); the switch does not wait for it."""
    terminal = Terminal(tmp_path / "tty")
    terminal.plug_in()
    spec = f"slcan:{terminal.link},bitrate=500000,sleep_after_open=0"
    with gateway(spec) as between, between.bus() as one, between.bus() as other:
        terminal.write(b"t1235706c61696e\r")
        assert one.recv_frames(PATIENCE_S)[0].can_id == 0x123
        assert other.recv_frames(PATIENCE_S)[0].can_id == 0x123
        terminal.pull_out()
        between.wait_for_stderr(f"railhil hub: slcan:{terminal.link} is down")
        one.send_frames([PLAIN])
        assert other.recv_frames(PATIENCE_S) == [PLAIN]
        terminal.plug_in()
        between.wait_for_stderr(f"railhil hub: slcan:{terminal.link} is back after")
        os.set_blocking(terminal.fileno(), True)
        one.send_frames([Frame(0x7A, b"\x01")])
        heard = b""

        def says_it() -> bool:
            nonlocal heard
            heard += terminal.read(4096)
            return b"t07A101\r" in heard

        wait_for(says_it, PATIENCE_S)
        assert between.end() == 0
        assert "1 outage, dropped 1" in between.stderr()
    terminal.pull_out()
