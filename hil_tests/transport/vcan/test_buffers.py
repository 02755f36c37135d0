"""Receive buffers that are too small: the kernel counts what it drops (SO_RXQ_OVFL), and the run says so."""

from __future__ import annotations

import socket

import pytest

from hil_tests.transport.vcan.bench import run_on, socketcan
from hil_tests.transport.vcan.dump import frames_of
from railhil.bus.frame import Frame
from railhil.bus.link import Link, open_link
from railhil.common.exit_codes import INVALID

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600)]

#: Below what the buffers of plant and controller hold, which hear the flood as well.
_FLOOD = 300
_FOREIGN = 0x7A0
_LARGE_BYTES, _SMALL_BYTES = 4 << 20, 50_000


def buffered(link: Link, buffer_bytes: int) -> Link:
    """The link with another receive buffer."""
    link.bus.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer_bytes)
    return link


def flood(link: Link) -> None:
    link.send([Frame(_FOREIGN, number.to_bytes(4, "big")) for number in range(_FLOOD)])


def test_sleeping_reader_knows_exactly_how_much_it_has_lost():
    """The smallest buffer that there is; the count comes with the next frame."""
    sender, reader = open_link(socketcan()), buffered(open_link(socketcan()), 0)
    try:
        flood(sender)
        heard = []
        while frames := reader.receive(0.2):
            heard += frames
        sender.send([Frame(_FOREIGN, b"after")])
        assert reader.receive(5.0) == [Frame(_FOREIGN, b"after")]
    finally:
        sender.close()
        reader.close()
    assert 0 < len(heard) < _FLOOD
    assert reader.counters["rx_lost"] == _FLOOD - len(heard)
    assert [int.from_bytes(frame.data, "big") for frame in heard] == list(range(len(heard)))


def test_recorder_that_sleeps_through_a_flood_says_how_much_the_record_has_lost(hop, hop_reference, folder):
    """The bench waits for the recorder, and its buffer is large again by then: what is lost is the flood's alone."""
    opened: list[Link] = []

    def remember(config: dict[str, object], name: str) -> Link:
        opened.append(open_link(config, name))
        return opened[-1]

    def disturb(time_s: float) -> None:
        if time_s > 3.0 and len(opened) == 1:
            opened.append(open_link(socketcan()))
            buffered(opened[0], _SMALL_BYTES)
            flood(opened[1])
            buffered(opened[0], _LARGE_BYTES)

    result, _ = run_on(socketcan(), hop, folder, on_progress=disturb, open_recorder=remember)
    opened[1].close()
    frames = frames_of(folder / "frames.log")
    recorded = len([frame for frame in frames if frame.can_id == _FOREIGN])
    assert 0 < recorded < _FLOOD
    assert result.recorder_counters["rx_lost"] == _FLOOD - recorded
    assert result.exit_code == INVALID
    assert result.line == f"record: {_FLOOD - recorded} frames lost in the recorder's receive buffer (SO_RXQ_OVFL)"
    assert [frame for frame in frames if frame.can_id != _FOREIGN] == frames_of(hop_reference.log)
