"""Bulk reading from the hub: order and content are preserved, and the reader is woken when necessary."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil_tests.support.clock import SetClock
from railhil.bus.frame import FD, Frame
from railhil.bus.hub.client import HubBus
from railhil.bus.hub.ports import HOLD_S, Coalescer, coalescer_of
from railhil.bus.mvb import master_frame
from railhil.bus.packing import CLASSIC_SIZE, FD_SIZE, MAX_PACKET_SIZE, pack_frame

POLL = master_frame(2, 0x108)


@given(st.lists(st.integers(1, 40), max_size=60), st.integers(1, 256))
def test_nothing_is_lost_or_reordered(sizes, limit):
    coalescer = Coalescer(limit, frozenset())
    sent = [pack_frame(Frame(k % 0x7FF, bytes([k & 0xFF]))) * size for k, size in enumerate(sizes)]
    handed = [packet for item in sent for packet in coalescer.take(item)] + coalescer.flush()
    assert b"".join(handed) == b"".join(sent)
    assert all(0 < len(packet) <= MAX_PACKET_SIZE for packet in handed)
    assert coalescer.flush() == []


def test_packet_that_ends_with_a_named_frame_is_handed_over_at_once():
    coalescer = Coalescer(64, frozenset((pack_frame(POLL),)))
    other = pack_frame(Frame(0x118, bytes(8)))
    assert coalescer.take(other) == []
    assert coalescer.take(other + pack_frame(POLL)) == [other * 2 + pack_frame(POLL)]
    assert coalescer.take(pack_frame(POLL) + other) == []


@pytest.mark.parametrize(("frames", "handed"), [(63, 0), (64, 1), (65, 1)])
def test_limit(frames, handed):
    coalescer = Coalescer(64, frozenset())
    packet = pack_frame(Frame(1, b""))
    assert sum(len(coalescer.take(packet)) for _ in range(frames)) == handed


def test_can_fd_frame_stands_alone_behind_what_came_before():
    coalescer = Coalescer(64, frozenset())
    first, fd = pack_frame(Frame(1, b"")), pack_frame(Frame(2, b"", FD))
    assert coalescer.take(first) == []
    assert coalescer.take(fd) == [first, fd]
    assert len(fd) == FD_SIZE


def test_held_packets_do_not_wait_for_ever_in_steady_traffic():
    wall = SetClock()
    coalescer = Coalescer(256, frozenset(), wall)
    packet = pack_frame(Frame(1, b""))
    assert coalescer.take(packet) == []
    wall.sleep(HOLD_S * 1.01)
    assert coalescer.take(packet) == [packet * 2]


@pytest.mark.parametrize(
    "hello",
    [
        {"coalesce_frames": -1},
        {"coalesce_frames": 257},
        {"coalesce_frames": "many"},
        {"coalesce_frames": 8, "wake_on": ["zz"]},
        {"coalesce_frames": 8, "wake_on": ["00"]},
        {"coalesce_frames": 8, "wake_on": 7},
        {"coalesce_frames": 8, "wake_on": [f"{k:032x}" for k in range(65)]},
    ],
)
def test_senseless_wishes_are_refused_in_one_line(hello):
    with pytest.raises(ValueError, match=r"hello: key '(coalesce_frames|wake_on)': found .*, allowed: ") as error:
        coalescer_of(hello)
    assert "\n" not in str(error.value)


def test_no_wish_no_coalescer():
    assert coalescer_of({}) is None
    assert len(pack_frame(POLL)) == CLASSIC_SIZE


@pytest.fixture
def channel(socket_folder) -> Iterator[str]:
    path = str(socket_folder / "hub.sock")
    hub = subprocess.Popen([sys.executable, "-m", "railhil.bus.hub", "-c", path], stderr=subprocess.DEVNULL)
    yield path
    hub.terminate()
    assert hub.wait(10) == 0


def test_bulk_reader_gets_everything_when_the_bus_falls_silent(channel):
    with (
        HubBus(channel, connect_timeout=10, coalesce_frames=64, wake_on=[POLL]) as reader,
        HubBus(channel, connect_timeout=10) as writer,
    ):
        frames = [Frame(k, bytes([k])) for k in range(10)]
        for frame in frames:
            writer.send_frames([frame])
        seen: list[Frame] = []
        deadline_s = time.monotonic() + 10
        while len(seen) < len(frames) and time.monotonic() < deadline_s:
            seen += reader.recv_frames(1.0)
        assert seen == frames
        writer.send(can.Message(arbitration_id=POLL.can_id, data=POLL.data, is_extended_id=False))
        assert reader.recv_frames(10.0) == [POLL]


def test_refused_wish_names_key_and_allowed(channel):
    with pytest.raises(can.CanInitializationError, match=r"coalesce_frames.*allowed: 0\.\.256"):
        HubBus(channel, connect_timeout=10, coalesce_frames=1000)
