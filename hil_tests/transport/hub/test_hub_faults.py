"""Clients that misbehave: the hub disconnects them with one line and keeps carrying the others' frames."""

from __future__ import annotations

import contextlib
import resource
import socket
import threading
from pathlib import Path

import pytest

from hil_tests.support.hub import PATIENCE_S, running_hub
from railhil.bus.frame import Frame
from railhil.bus.hub import membership
from railhil.bus.hub.address import listen, parse_channel
from railhil.bus.hub.client import HubBus, HubUnavailable
from railhil.bus.hub.connection import HubLost
from railhil.bus.hub.membership import MAX_CLIENTS
from railhil.bus.hub.switch import Switch
from railhil.bus.packing import encode_hello, pack_frame


def _raw_client(channel: str, *packets: bytes) -> socket.socket:
    sock = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    # With a time-out it would not wait for a place in the queue of the listener.
    sock.connect(channel)
    sock.settimeout(PATIENCE_S)
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


@pytest.mark.slow
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


def test_silent_sockets_keep_nobody_out() -> None:
    with running_hub() as hub, hub.bus() as one:
        silent = [_raw_client(hub.channel) for _ in range(MAX_CLIENTS + 44)]
        with hub.bus() as other:
            one.send_frames([Frame(0x200, b"alive")])
            assert other.recv_frames(PATIENCE_S) == [Frame(0x200, b"alive")]
        for sock in silent:
            sock.close()
        refused = hub.stderr().count("no hello yet, and others want to connect")
        assert refused >= MAX_CLIENTS + 44 - membership.MAX_GUESTS


def test_a_client_without_hello_is_disconnected_in_time(socket_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(membership, "HELLO_S", 0.1)
    listener, address = listen(parse_channel(str(socket_folder / "hub.sock")))
    lines: list[str] = []
    switch = Switch(listener, queue_limit_bytes=1 << 20, properties={}, report=lines.append)
    thread = threading.Thread(target=switch.run)
    thread.start()
    try:
        with HubBus(str(address)), _raw_client(str(address)) as silent:
            # Nothing else happens on this hub: it must wake by itself.
            assert silent.recv(4096) == b""
        assert lines == ["client 2 is disconnected: no hello within 5 s"]
    finally:
        switch.stop()
        thread.join(PATIENCE_S)
        switch.close()
        listener.close()


def test_a_client_too_many_is_refused_with_the_number() -> None:
    with running_hub() as hub:
        members = [_raw_client(hub.channel, encode_hello(name=str(number))) for number in range(MAX_CLIENTS)]
        for member in members:
            assert member.recv(4096)
        with pytest.raises(HubUnavailable, match=f": {MAX_CLIENTS} clients are connected, no more are allowed$"):
            hub.bus()
        members[0].close()
        with hub.bus():
            pass
        for member in members[1:]:
            member.close()
